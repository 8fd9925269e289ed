#pragma once

// What a GPU lends us, one move-only class a handle: who creates it says how it is released. Destructors report on
// standard error and never throw.

#include <cstddef>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "device/hiprt/gpu_memory.h"
#include "device/hiprt/gpu_runtime.h"

namespace kadr {

/// Reports what a destructor ran into; nothing on success.
void report(const GpuResult& result, const char* action) noexcept;

/// An array in the memory of the GPU. Its destructor waits for all work that could still use it.
template <class T>
class DeviceBuffer {
    static_assert(std::is_trivially_copyable_v<T>, "copied byte by byte");

public:
    DeviceBuffer() = default;
    /// Of nothing no memory is taken. @throws GpuOutOfMemory
    DeviceBuffer(GpuMemory& memory, std::size_t count, MemoryUse use) : memory_(&memory), count_(count), use_(use) {
        if (count > 0) address_ = memory.allocate(bytes(), use);
    }
    DeviceBuffer(DeviceBuffer&& other) noexcept { *this = std::move(other); }
    DeviceBuffer& operator=(DeviceBuffer&& other) noexcept {
        std::swap(memory_, other.memory_);
        std::swap(address_, other.address_);
        std::swap(count_, other.count_);
        std::swap(use_, other.use_);
        return *this;
    }
    ~DeviceBuffer() {
        if (address_ != 0) memory_->release(address_, bytes(), use_);
    }

    /// Makes it hold at least `count`; what it held is lost when it has to grow, which it does by half more than asked.
    void reserve(GpuMemory& memory, std::size_t count, MemoryUse use) {
        if (count <= count_) return;
        const std::size_t grown = count_ == 0 ? count : count + count / 2;
        *this = DeviceBuffer();
        *this = DeviceBuffer(memory, grown, use);
    }

    DeviceAddress address() const { return address_; }
    void* pointer() const { return reinterpret_cast<void*>(address_); }
    const T* data() const { return reinterpret_cast<const T*>(address_); }  ///< for the kernels; not for the host
    std::size_t count() const { return count_; }
    std::size_t bytes() const { return count_ * sizeof(T); }

private:
    GpuMemory* memory_ = nullptr;
    DeviceAddress address_ = 0;
    std::size_t count_ = 0;
    MemoryUse use_ = MemoryUse::scratch;
};

/// Host memory that the GPU reads and writes without a copy in between. Its destructor waits for all work.
class PinnedMemory {
public:
    PinnedMemory() = default;
    PinnedMemory(GpuRuntime& runtime, std::size_t bytes);
    PinnedMemory(PinnedMemory&& other) noexcept { *this = std::move(other); }
    PinnedMemory& operator=(PinnedMemory&& other) noexcept;
    ~PinnedMemory();

    std::byte* data() const { return data_; }
    std::size_t bytes() const { return bytes_; }

private:
    GpuRuntime* runtime_ = nullptr;
    std::byte* data_ = nullptr;
    std::size_t bytes_ = 0;
};

class GpuEvent;

/// A queue of work. Its destructor waits for what is on it.
class GpuStream {
public:
    explicit GpuStream(GpuRuntime& runtime);
    GpuStream(const GpuStream&) = delete;
    GpuStream& operator=(const GpuStream&) = delete;
    ~GpuStream();

    GpuStreamHandle handle() const { return handle_; }
    void synchronize(const char* action) const;  ///< @throws RenderError  "cannot ACTION: ..."
    /// What comes on it from now on begins when the event is past. @pre it was recorded
    void wait_for(const GpuEvent& event) const;

private:
    GpuRuntime& runtime_;
    GpuStreamHandle handle_ = nullptr;
};

/// A mark on a stream.
class GpuEvent {
public:
    explicit GpuEvent(GpuRuntime& runtime);
    GpuEvent(const GpuEvent&) = delete;
    GpuEvent& operator=(const GpuEvent&) = delete;
    ~GpuEvent();

    GpuEventHandle handle() const { return handle_; }
    void record(const GpuStream& stream) const;
    void wait(const char* action) const;                ///< until the work before it is done
    double seconds_since(const GpuEvent& begin) const;  ///< @pre both are past

private:
    GpuRuntime& runtime_;
    GpuEventHandle handle_ = nullptr;
};

}  // namespace kadr
