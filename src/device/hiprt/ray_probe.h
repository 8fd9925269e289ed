#pragma once

#include <functional>
#include <vector>

#include "device/hiprt/device_table.h"
#include "device/hiprt/hiprt_abi.h"
#include "device/probe.h"
#include "kernels/gpu/probe.h"

namespace kadr {

/// Single rays on the GPU, in batches: each is a launch of its own, short enough for displays and watchdogs.
class RayProbe final : public Probe {
public:
    static constexpr std::size_t kBatch = std::size_t{1} << 16;  ///< rays a launch

    /// The frame at hand, and the kernel compiled for its geometry.
    struct Frame {
        kernels::LaunchParams params;
        hiprt::Function kernel = nullptr;
    };
    /// @param frame  called for every question; makes the GPU current
    RayProbe(GpuMemory& memory, UploadQueue& uploads, const GpuStream& stream, std::function<Frame()> frame)
        : memory_(memory), uploads_(uploads), stream_(stream), frame_(std::move(frame)) {}

    std::vector<SurfaceHit> look(std::span<const kernels::Vec2f> film_px, double time) override;
    std::vector<char> occluded(std::span<const SurfaceRay> rays, double time) override;

private:
    void launch(const Frame& frame, const kernels::ProbeParams& params);
    /// Waits for the answers of a launch. @return them, in pinned memory
    template <class T>
    const T* read_back(const DeviceBuffer<T>& answers, std::size_t count);

    GpuMemory& memory_;
    UploadQueue& uploads_;
    const GpuStream& stream_;
    std::function<Frame()> frame_;
    DeviceTable<kernels::Vec2f> film_px_;
    DeviceTable<kernels::ProbeShadow> shadows_;
    DeviceBuffer<kernels::ProbeHit> hits_;
    DeviceBuffer<unsigned char> occluded_;
    PinnedMemory pinned_;
};

}  // namespace kadr
