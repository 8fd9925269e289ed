#pragma once

#include <cstddef>

#include "device/hiprt/gpu_resources.h"

namespace kadr {

/// Copies data of the GPU to the host through two blocks of pinned memory: while one is on its way the other is
/// emptied, so that pinned memory stays small whatever is read.
class DownloadQueue {
public:
    static constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

    DownloadQueue(GpuRuntime& runtime, const GpuStream& stream);

    /// After what is on the stream. @param to  is written by the time of finish()
    void add(void* to, DeviceAddress from, std::size_t bytes);
    /// Waits until all that was added has arrived.
    void finish();

private:
    struct Block {
        explicit Block(GpuRuntime& runtime) : memory(runtime, kBlockBytes), arrived(runtime) {}
        PinnedMemory memory;
        GpuEvent arrived;
        void* to = nullptr;
        std::size_t bytes = 0;  ///< on their way; 0: none
    };
    static void empty(Block& block);

    GpuRuntime& runtime_;
    const GpuStream& stream_;
    Block blocks_[2];
    int current_ = 0;
};

}  // namespace kadr
