#pragma once

#include <span>
#include <type_traits>

#include "device/hiprt/gpu_resources.h"
#include "device/hiprt/upload_queue.h"

namespace kadr {

/// A table of the host and its copy on the GPU, which grows as it has to.
template <class T>
class DeviceTable {
public:
    explicit DeviceTable(MemoryUse use = MemoryUse::tables) : use_(use) {}
    void set(GpuMemory& memory, UploadQueue& uploads, std::span<const std::type_identity_t<T>> values) {
        buffer_.reserve(memory, values.size(), use_);
        uploads.add(buffer_, values);
    }
    const T* data() const { return buffer_.data(); }  ///< an address of the GPU; null: it never held anything
    void* pointer() const { return buffer_.pointer(); }

private:
    DeviceBuffer<T> buffer_;
    MemoryUse use_;
};

}  // namespace kadr
