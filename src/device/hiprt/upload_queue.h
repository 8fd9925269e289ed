#pragma once

#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "device/hiprt/gpu_resources.h"

namespace kadr {

/// Copies host data to the GPU through two blocks of pinned memory: while one is on its way the other is filled, and
/// many small pieces go as one stream of work without waiting for each.
class UploadQueue {
public:
    static constexpr std::size_t kBlockBytes = std::size_t{8} << 20;

    /// @param block_bytes  of each block
    UploadQueue(GpuRuntime& runtime, const GpuStream& stream, std::size_t block_bytes = kBlockBytes);

    /// Copies now into pinned memory, later (on the stream) to the GPU; `from` is free again on return.
    void add(DeviceAddress to, const void* from, std::size_t bytes);
    template <class T>
    void add(const DeviceBuffer<T>& to, std::span<const std::type_identity_t<T>> from) {
        add(to.address(), from.data(), from.size_bytes());
    }

private:
    struct Block {
        Block(GpuRuntime& runtime, std::size_t bytes) : memory(runtime, bytes), sent(runtime) {}
        PinnedMemory memory;
        GpuEvent sent;
        std::size_t used = 0;
        bool in_flight = false;  ///< something of it may still be on its way
    };
    void next_block();

    GpuRuntime& runtime_;
    const GpuStream& stream_;
    Block blocks_[2];
    int current_ = 0;
};

}  // namespace kadr
