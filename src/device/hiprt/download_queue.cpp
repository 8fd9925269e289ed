#include "device/hiprt/download_queue.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace kadr {

DownloadQueue::DownloadQueue(GpuRuntime& runtime, const GpuStream& stream)
    : runtime_(runtime), stream_(stream), blocks_{Block(runtime), Block(runtime)} {}

void DownloadQueue::add(void* to, DeviceAddress from, std::size_t bytes) {
    auto* target = static_cast<std::byte*>(to);
    while (bytes > 0) {
        Block& block = blocks_[current_];
        empty(block);
        const std::size_t piece = std::min(bytes, kBlockBytes);
        check(runtime_.download(block.memory.data(), from, piece, stream_.handle()), "read data back from the GPU");
        block.arrived.record(stream_);
        block.to = target;
        block.bytes = piece;
        target += piece;
        from += piece;
        bytes -= piece;
        current_ = 1 - current_;
    }
}

void DownloadQueue::finish() {
    for (int i = 0; i < 2; ++i) {
        empty(blocks_[current_]);  // the older one
        current_ = 1 - current_;
    }
}

void DownloadQueue::empty(Block& block) {
    const std::size_t bytes = std::exchange(block.bytes, 0);  // if waiting fails, nothing of it is of use
    if (bytes == 0) return;
    block.arrived.wait("wait for data from the GPU");
    std::memcpy(block.to, block.memory.data(), bytes);
}

}  // namespace kadr
