#include "device/hiprt/launch_queue.h"

namespace kadr {
namespace {

bool is_set(const std::atomic<bool>* cancel) { return cancel && cancel->load(std::memory_order_relaxed); }

unsigned blocks(int pixels, int block) { return static_cast<unsigned>((pixels + block - 1) / block); }

}  // namespace

bool LaunchQueue::run(GpuFunctionHandle function, kernels::LaunchParams params, const LaunchPiece& pass,
                      const std::atomic<bool>* cancel, const std::function<void(double)>& progress,
                      const std::function<void()>& idle) {
    LaunchPlanner planner(pass);
    for (int turn = 0;; turn = 1 - turn) {
        if (idle && slots_[turn].pixel_samples > 0) idle();
        wait_for(slots_[turn]);
        if (is_set(cancel)) break;
        const std::optional<LaunchPiece> piece = planner.next(budget_);
        if (!piece) break;
        launch(function, params, *piece, slots_[turn]);
        if (progress) progress(planner.done());
    }
    if (idle) idle();
    for (Slot& slot : slots_) wait_for(slot);
    return !is_set(cancel);
}

void LaunchQueue::launch(GpuFunctionHandle function, kernels::LaunchParams& params, const LaunchPiece& piece,
                         Slot& slot) {
    params.x0 = piece.x0;
    params.y0 = piece.y0;
    params.x1 = piece.x1;
    params.y1 = piece.y1;
    params.first_sample = piece.first_sample;
    params.sample_count = piece.sample_count;
    const LaunchSize size{blocks(piece.x1 - piece.x0, kernels::kBlockWidth),
                          blocks(piece.y1 - piece.y0, kernels::kBlockHeight), kernels::kBlockWidth,
                          kernels::kBlockHeight};
    void* const arguments[] = {&params};
    slot.begin.record(stream_);
    check(runtime_.launch(function, size, arguments, stream_.handle()), "start a kernel on the GPU");
    slot.end.record(stream_);
    slot.pixel_samples = piece.pixel_samples();
}

void LaunchQueue::wait_for(Slot& slot) {
    if (slot.pixel_samples == 0) return;
    slot.end.wait("render on the GPU");
    budget_.measured(slot.pixel_samples, slot.end.seconds_since(slot.begin));
    slot.pixel_samples = 0;
}

}  // namespace kadr
