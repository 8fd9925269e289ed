#include "device/hiprt/upload_queue.h"

#include <algorithm>
#include <cstring>

namespace kadr {

UploadQueue::UploadQueue(GpuRuntime& runtime, const GpuStream& stream, std::size_t block_bytes)
    : runtime_(runtime), stream_(stream), blocks_{Block(runtime, block_bytes), Block(runtime, block_bytes)} {}

void UploadQueue::add(DeviceAddress to, const void* from, std::size_t bytes) {
    const std::byte* source = static_cast<const std::byte*>(from);
    while (bytes > 0) {
        if (blocks_[current_].used == blocks_[current_].memory.bytes()) next_block();
        Block& block = blocks_[current_];
        const std::size_t piece = std::min(bytes, block.memory.bytes() - block.used);
        std::memcpy(block.memory.data() + block.used, source, piece);
        check(runtime_.upload(to, block.memory.data() + block.used, piece, stream_.handle()), "copy data to the GPU");
        block.used += piece;
        to += piece;
        source += piece;
        bytes -= piece;
    }
}

/// Marks the full block as sent and takes the other one, once it has arrived.
void UploadQueue::next_block() {
    blocks_[current_].sent.record(stream_);
    blocks_[current_].in_flight = true;
    current_ = 1 - current_;
    Block& block = blocks_[current_];
    if (block.in_flight) block.sent.wait("wait for data on its way to the GPU");
    block.in_flight = false;
    block.used = 0;
}

}  // namespace kadr
