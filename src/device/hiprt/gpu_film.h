#pragma once

#include <optional>

#include "device/hiprt/gpu_resources.h"
#include "film/film.h"
#include "kernels/gpu/launch_params.h"

namespace kadr {

/// The sums of some rows of one half of a film, on the GPU until they are added to the host's.
class GpuFilm {
public:
    GpuFilm(GpuMemory& memory, const GpuStream& stream) : memory_(memory), stream_(stream) {}

    /// Takes memory for rows [y0, y1) and clears it. @throws GpuOutOfMemory
    void begin(const Film& film, int y0, int y1);
    /// For the kernels: addressed by pixels of the whole image.
    kernels::FilmView view() const;
    /// Waits for the GPU, and adds the sums to a half of the film.
    void add_to(Film& film, int half);
    /// Frees what it holds. @return whether it held anything
    bool give_back();

private:
    template <class T>
    void take(DeviceBuffer<T>& buffer, bool wanted);
    template <class T>
    const T* read_back(const DeviceBuffer<T>& buffer, bool wanted, std::size_t& offset);
    bool keeps_hits() const { return layers_.depth || layers_.motion; }

    GpuMemory& memory_;
    const GpuStream& stream_;
    int width_ = 0, y0_ = 0, y1_ = 0;
    bool weighted_ = false;
    FilmLayers layers_;
    DeviceBuffer<kernels::FilmBeauty> beauty_;
    DeviceBuffer<unsigned> samples_;
    DeviceBuffer<double> weights_;
    DeviceBuffer<kernels::FilmVector> albedo_, normal_;
    DeviceBuffer<double> depth_, hits_;
    DeviceBuffer<kernels::FilmMotion> motion_;
    PinnedMemory pinned_;
};

}  // namespace kadr
