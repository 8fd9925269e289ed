#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

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
    /// The same, unless it holds these values already: compared by a copy that is kept on the host.
    void set_changed(GpuMemory& memory, UploadQueue& uploads, std::span<const std::type_identity_t<T>> values) {
        const auto bytes = std::as_bytes(values);
        if (std::equal(bytes.begin(), bytes.end(), copy_.begin(), copy_.end())) return;
        copy_.clear();  // whatever fails below, it is sent again
        set(memory, uploads, values);
        copy_.assign(bytes.begin(), bytes.end());
    }
    const T* data() const { return buffer_.data(); }  ///< an address of the GPU; null: it never held anything
    void* pointer() const { return buffer_.pointer(); }

private:
    DeviceBuffer<T> buffer_;
    MemoryUse use_;
    std::vector<std::byte> copy_;  ///< of set_changed alone
};

}  // namespace kadr
