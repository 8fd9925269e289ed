#include "device/hiprt/gpu_resources.h"

#include <cstdio>

#include <fmt/format.h>

namespace kadr {

void report(const GpuResult& result, const char* action) noexcept {
    if (result.kind == GpuResult::Kind::success) return;
    fmt::print(stderr, "kadr: cannot {}: the GPU runtime reports {}\n", action, result.text);
}

PinnedMemory::PinnedMemory(GpuRuntime& runtime, std::size_t bytes) : runtime_(&runtime), bytes_(bytes) {
    void* memory = nullptr;
    check(runtime.allocate_pinned(bytes, memory), fmt::format("allocate {} of pinned host memory", bytes_text(bytes)));
    data_ = static_cast<std::byte*>(memory);
}

PinnedMemory& PinnedMemory::operator=(PinnedMemory&& other) noexcept {
    std::swap(runtime_, other.runtime_);
    std::swap(data_, other.data_);
    std::swap(bytes_, other.bytes_);
    return *this;
}

PinnedMemory::~PinnedMemory() {
    if (!data_) return;
    report(runtime_->synchronize_all(), "wait for the GPU before pinned memory is freed");
    report(runtime_->release_pinned(data_), "free pinned host memory");
}

GpuStream::GpuStream(GpuRuntime& runtime) : runtime_(runtime) {
    check(runtime.create_stream(handle_), "create a stream on the GPU");
}

GpuStream::~GpuStream() {
    report(runtime_.synchronize(handle_), "wait for the GPU");
    report(runtime_.destroy_stream(handle_), "destroy a stream of the GPU");
}

void GpuStream::synchronize(const char* action) const { check(runtime_.synchronize(handle_), action); }

void GpuStream::wait_for(const GpuEvent& event) const {
    check(runtime_.make_wait(handle_, event.handle()), "let a stream of the GPU wait for another");
}

GpuEvent::GpuEvent(GpuRuntime& runtime) : runtime_(runtime) {
    check(runtime.create_event(handle_), "create an event on the GPU");
}

GpuEvent::~GpuEvent() { report(runtime_.destroy_event(handle_), "destroy an event of the GPU"); }

void GpuEvent::record(const GpuStream& stream) const {
    check(runtime_.record(handle_, stream.handle()), "mark the time on the GPU");
}

void GpuEvent::wait(const char* action) const { check(runtime_.wait_for(handle_), action); }

double GpuEvent::seconds_since(const GpuEvent& begin) const {
    double seconds = 0;
    check(runtime_.elapsed(begin.handle(), handle_, seconds), "measure time on the GPU");
    return seconds;
}

}  // namespace kadr
