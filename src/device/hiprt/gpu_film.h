#pragma once

#include "device/hiprt/download_queue.h"
#include "device/hiprt/gpu_resources.h"
#include "device/hiprt/upload_queue.h"
#include "film/film.h"
#include "kernels/gpu/launch_params.h"

namespace kadr {

/// The sums of a film on the GPU: of all of it, until they are asked for; where memory is short, of some rows of one
/// half, which come from the host before every pass and go back after it.
///
/// Sums always go on from those before, wherever these are, so they are added up in the order of the samples: the film
/// is the same to the last bit however much of it fits, and whenever it is read.
class GpuFilm {
public:
    GpuFilm(GpuMemory& memory, UploadQueue& uploads, DownloadQueue& downloads, const GpuStream& stream)
        : memory_(memory), uploads_(uploads), downloads_(downloads), stream_(stream) {}

    /// The film was cleared; what is on the GPU of another is forgotten.
    void begin(Film& film);
    /// Makes rows [first, end) of a half ready to be added to, as many as there is room for. @return end
    /// @throws GpuOutOfMemory  not even one row fits
    int take_rows(Film& film, int half, int first);
    /// For the kernels: addressed by pixels of the whole image.
    kernels::FilmView view(int half) const;
    /// What take_rows made ready has been added to: it goes home unless all of the film stays.
    void rows_done();
    /// Brings home what is not there yet.
    void read();
    /// Brings home what is not there yet and frees all. @return whether there was anything to free
    bool give_back();

private:
    struct Half {
        DeviceBuffer<kernels::FilmBeauty> beauty;
        DeviceBuffer<unsigned> samples;
        DeviceBuffer<double> weights;
    };
    void look_at(Film& film);
    void allocate(int first, int end, bool both);
    void fill(int half, bool with_surface);
    void copy_home(int half, bool with_surface);
    template <class T>
    void reserve(DeviceBuffer<T>& buffer, bool wanted);
    template <class T, class HostAt>
    void send(const DeviceBuffer<T>& buffer, bool wanted, const HostAt& host_at);
    template <class T, class HostAt>
    void bring(const DeviceBuffer<T>& buffer, bool wanted, const HostAt& host_at);
    template <class Visit>
    void visit_surface(const Visit& visit);
    void free_all();
    bool keeps_hits() const { return layers_.depth || layers_.motion; }
    int slot(int half) const { return whole_ ? half : 0; }

    GpuMemory& memory_;
    UploadQueue& uploads_;
    DownloadQueue& downloads_;
    const GpuStream& stream_;
    Film* film_ = nullptr;        ///< whose sums these are; null: of none
    bool host_is_clear_ = false;  ///< it has no sums yet, and nothing has to be copied from there
    bool whole_ = false;          ///< all of it is here
    bool unread_ = false;         ///< what is here is not at home yet
    int half_ = 0, y0_ = 0, y1_ = 0;
    bool weighted_ = false;
    FilmLayers layers_;
    Half halves_[Film::kHalves];  ///< the first alone where not all of the film is here
    DeviceBuffer<kernels::FilmVector> albedo_, normal_;
    DeviceBuffer<double> depth_, hits_;
    DeviceBuffer<kernels::FilmMotion> motion_;
    bool whole_fits_ = true;  ///< learned when memory runs out, like the next
    int most_rows_ = 1 << 30;
};

}  // namespace kadr
