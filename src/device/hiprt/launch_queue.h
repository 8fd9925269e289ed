#pragma once

#include <atomic>
#include <functional>

#include "device/hiprt/gpu_resources.h"
#include "device/hiprt/launch_planner.h"
#include "kernels/gpu/launch_params.h"

namespace kadr {

/// Sends the work of passes to the GPU in launches of bounded length: one runs while the next waits, so that the GPU is
/// never idle and whoever cancels waits for two launches at most.
class LaunchQueue {
public:
    LaunchQueue(GpuRuntime& runtime, const GpuStream& stream)
        : runtime_(runtime), stream_(stream), slots_{Slot(runtime), Slot(runtime)} {}

    /// @param params    of all launches; their rectangles and samples are filled in
    /// @param progress  called with 0..1 now and then; may be empty
    /// @param idle      called before it waits for a launch, while others are on their way; may be empty
    /// @return false  when it was cancelled; nothing is running any more
    bool run(GpuFunctionHandle function, kernels::LaunchParams params, const LaunchPiece& pass,
             const std::atomic<bool>* cancel, const std::function<void(double)>& progress,
             const std::function<void()>& idle = {});

    const LaunchBudget& budget() const { return budget_; }

private:
    struct Slot {
        explicit Slot(GpuRuntime& runtime) : begin(runtime), end(runtime) {}
        GpuEvent begin, end;
        std::int64_t pixel_samples = 0;  ///< of the launch that is on its way; 0: none
    };
    void launch(GpuFunctionHandle function, kernels::LaunchParams& params, const LaunchPiece& piece, Slot& slot);
    void wait_for(Slot& slot);

    GpuRuntime& runtime_;
    const GpuStream& stream_;
    Slot slots_[2];
    LaunchBudget budget_;
};

}  // namespace kadr
