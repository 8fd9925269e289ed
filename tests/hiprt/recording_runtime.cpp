#include "recording_runtime.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "kernels/gpu/entry_points.h"

namespace kadr::test {
namespace {

std::uintptr_t number_of(const void* pointer) { return reinterpret_cast<std::uintptr_t>(pointer); }

/// Of a kernel's one argument; a test's own kernels take that of the integrators.
std::size_t argument_bytes_of(const std::string& kernel) {
    for (const kernels::EntryPoint& entry : kernels::kEntryPoints)
        if (kernel == entry.name) return entry.argument_bytes;
    return sizeof(kernels::LaunchParams);
}

}  // namespace

RecordingRuntime::~RecordingRuntime() = default;

std::vector<std::string> RecordingRuntime::leaks() const {
    std::vector<std::string> found;
    for (const auto& [address, block] : device_)
        if (!block.freed) found.push_back(fmt::format("{} bytes of device memory", block.bytes));
    for (const auto& [address, block] : pinned_)
        if (!block.freed) found.push_back(fmt::format("{} bytes of pinned memory", block.bytes));
    for (std::size_t i = 0; i < streams_.size(); ++i) found.push_back("a stream");
    for (std::size_t i = 0; i < events_.size(); ++i) found.push_back("an event");
    return found;
}

std::size_t RecordingRuntime::count(const std::string& call) const {
    return static_cast<std::size_t>(std::count(calls.begin(), calls.end(), call));
}

bool RecordingRuntime::begin_call(const std::string& name) {
    calls.push_back(name);
    return static_cast<int>(calls.size()) - 1 == failing_call;
}

void RecordingRuntime::expect_current(const std::string& call) {
    if (current_.count(std::this_thread::get_id()) == 0) fault(call + ": this thread never called make_current");
}

const RecordingRuntime::Block* RecordingRuntime::find(const Blocks& blocks, const Range& range) {
    auto at = blocks.upper_bound(range.begin);
    if (at == blocks.begin()) return nullptr;
    --at;
    return range.begin + range.bytes <= at->first + at->second.bytes ? &at->second : nullptr;
}

bool RecordingRuntime::expect_device(const Range& range, const std::string& what) {
    if (range.bytes == 0) return true;
    const Block* block = find(device_, range);
    if (!block) fault(fmt::format("{}: {} bytes are not inside one allocation of device memory", what, range.bytes));
    if (block && block->freed) fault(fmt::format("{}: device memory is used after it was freed", what));
    return block && !block->freed;
}

bool RecordingRuntime::expect_pinned(const Range& range, const std::string& what) {
    const Block* block = find(pinned_, range);
    if (!block) fault(fmt::format("{}: {} bytes are not inside pinned memory", what, range.bytes));
    if (block && block->freed) fault(fmt::format("{}: pinned memory is used after it was freed", what));
    return block && !block->freed;
}

bool RecordingRuntime::is_pending(const Range& range) const {
    for (const auto& [handle, stream] : streams_)
        for (const Work& work : stream->work)
            for (const Range& used : work.uses)
                if (used.overlaps(range)) return true;
    return false;
}

bool RecordingRuntime::is_idle() const {
    return std::all_of(streams_.begin(), streams_.end(),
                       [](const auto& stream) { return stream.second->work.empty(); });
}

void RecordingRuntime::enqueue(GpuStreamHandle handle, std::vector<Range> uses, std::function<void()> run) {
    Stream* stream = stream_of(handle, "work");
    if (stream) stream->work.push_back({std::move(uses), std::move(run)});
}

void RecordingRuntime::run_one(Stream& stream) {
    const Work work = std::move(stream.work.front());
    stream.work.pop_front();
    work.run();
}

void RecordingRuntime::run_all(GpuStreamHandle handle) {
    Stream* stream = stream_of(handle, "synchronize");
    while (stream && !stream->work.empty()) run_one(*stream);
}

GpuFunctionHandle RecordingRuntime::make_function(const std::string& name) {
    auto function = std::make_unique<Function>(Function{name});
    void* handle = function.get();
    functions_[handle] = std::move(function);
    return handle;
}

RecordingRuntime::Stream* RecordingRuntime::stream_of(GpuStreamHandle stream, const char* call) {
    const auto found = streams_.find(stream);
    if (found == streams_.end()) fault(fmt::format("{}: no such stream", call));
    return found == streams_.end() ? nullptr : found->second.get();
}

RecordingRuntime::Event* RecordingRuntime::event_of(GpuEventHandle event, const char* call) {
    const auto found = events_.find(event);
    if (found == events_.end()) fault(fmt::format("{}: no such event", call));
    return found == events_.end() ? nullptr : found->second.get();
}

GpuResult RecordingRuntime::make_current() {
    if (begin_call("make_current")) return failed();
    current_.insert(std::this_thread::get_id());
    return {};
}

GpuResult RecordingRuntime::memory(std::size_t& free_bytes, std::size_t& total_bytes) {
    if (begin_call("memory")) return failed();
    expect_current("memory");
    free_bytes = capacity - in_use_;
    total_bytes = capacity;
    return {};
}

GpuResult RecordingRuntime::allocate(std::size_t bytes, DeviceAddress& address) {
    if (begin_call("allocate")) return failed();
    expect_current("allocate");
    if (bytes == 0) fault("allocate: nothing is asked for");
    if (in_use_ + bytes > capacity) return {GpuResult::Kind::out_of_memory, "out of memory"};
    Block block{std::make_unique<std::byte[]>(bytes + 1), bytes, false};  // one more: no two begin at one address
    std::memset(block.memory.get(), 0xCD, bytes);                         // nobody may count on zeros
    address = number_of(block.memory.get());
    device_[address] = std::move(block);
    in_use_ += bytes;
    most_in_use_ = std::max(most_in_use_, in_use_);
    return {};
}

/// Freed memory stays and is filled with rubbish, so that its use is noticed.
GpuResult RecordingRuntime::release_from(Blocks& blocks, std::uintptr_t address, const char* what) {
    const auto found = blocks.find(address);
    if (found == blocks.end() || found->second.freed) {
        fault(fmt::format("{}: no such memory, or freed before", what));
        return {GpuResult::Kind::failure, "an invalid pointer"};
    }
    Block& block = found->second;
    if (is_pending({address, block.bytes})) fault(fmt::format("{}: freed while work on it is pending", what));
    std::memset(block.memory.get(), 0xDD, block.bytes);
    block.freed = true;
    if (&blocks == &device_) in_use_ -= block.bytes;
    return {};
}

GpuResult RecordingRuntime::release(DeviceAddress address) {
    const bool fails = begin_call("release");
    expect_current("release");
    const GpuResult result = release_from(device_, address, "release");
    return fails ? failed() : result;  // it is gone all the same: nobody can try again in a destructor
}

GpuResult RecordingRuntime::allocate_pinned(std::size_t bytes, void*& memory) {
    if (begin_call("allocate_pinned")) return failed();
    expect_current("allocate_pinned");
    Block block{std::make_unique<std::byte[]>(bytes + 1), bytes, false};
    memory = block.memory.get();
    pinned_[number_of(memory)] = std::move(block);
    return {};
}

GpuResult RecordingRuntime::release_pinned(void* memory) {
    const bool fails = begin_call("release_pinned");
    expect_current("release_pinned");
    const GpuResult result = release_from(pinned_, number_of(memory), "release_pinned");
    return fails ? failed() : result;
}

GpuResult RecordingRuntime::create_stream(GpuStreamHandle& stream) {
    if (begin_call("create_stream")) return failed();
    expect_current("create_stream");
    auto created = std::make_unique<Stream>();
    stream = created.get();
    streams_[stream] = std::move(created);
    return {};
}

GpuResult RecordingRuntime::destroy_stream(GpuStreamHandle handle) {
    const bool fails = begin_call("destroy_stream");
    expect_current("destroy_stream");
    const Stream* stream = stream_of(handle, "destroy_stream");
    if (stream && !stream->work.empty()) fault("destroy_stream: work on it is pending");
    streams_.erase(handle);
    return fails ? failed() : GpuResult{};
}

GpuResult RecordingRuntime::synchronize(GpuStreamHandle stream) {
    const bool fails = begin_call("synchronize");
    expect_current("synchronize");
    run_all(stream);
    return fails ? failed() : GpuResult{};
}

GpuResult RecordingRuntime::synchronize_all() {
    const bool fails = begin_call("synchronize_all");
    expect_current("synchronize_all");
    for (const auto& [handle, stream] : streams_)
        while (!stream->work.empty()) run_one(*stream);
    return fails ? failed() : GpuResult{};
}

GpuResult RecordingRuntime::upload(DeviceAddress to, const void* from, std::size_t bytes, GpuStreamHandle stream) {
    if (begin_call("upload")) return failed();
    expect_current("upload");
    const Range target{to, bytes}, source{number_of(from), bytes};
    if (!expect_device(target, "upload") || !expect_pinned(source, "upload")) return {};
    enqueue(stream, {target, source}, [=] { std::memcpy(reinterpret_cast<void*>(to), from, bytes); });
    return {};
}

GpuResult RecordingRuntime::download(void* to, DeviceAddress from, std::size_t bytes, GpuStreamHandle stream) {
    if (begin_call("download")) return failed();
    expect_current("download");
    const Range target{number_of(to), bytes}, source{from, bytes};
    if (!expect_pinned(target, "download") || !expect_device(source, "download")) return {};
    enqueue(stream, {target, source}, [=] { std::memcpy(to, reinterpret_cast<const void*>(from), bytes); });
    return {};
}

GpuResult RecordingRuntime::fill(DeviceAddress to, std::uint8_t value, std::size_t bytes, GpuStreamHandle stream) {
    if (begin_call("fill")) return failed();
    expect_current("fill");
    if (!expect_device({to, bytes}, "fill")) return {};
    enqueue(stream, {{to, bytes}}, [=] { std::memset(reinterpret_cast<void*>(to), value, bytes); });
    return {};
}

GpuResult RecordingRuntime::create_event(GpuEventHandle& event) {
    if (begin_call("create_event")) return failed();
    expect_current("create_event");
    auto created = std::make_unique<Event>();
    event = created.get();
    events_[event] = std::move(created);
    return {};
}

GpuResult RecordingRuntime::destroy_event(GpuEventHandle handle) {
    const bool fails = begin_call("destroy_event");
    expect_current("destroy_event");
    const Event* event = event_of(handle, "destroy_event");
    if (event && event->stream && !event->past)
        while (!event->past && !event->stream->work.empty()) run_one(*event->stream);
    events_.erase(handle);
    return fails ? failed() : GpuResult{};
}

GpuResult RecordingRuntime::record(GpuEventHandle handle, GpuStreamHandle stream) {
    if (begin_call("record")) return failed();
    expect_current("record");
    Event* event = event_of(handle, "record");
    if (!event) return {};
    event->stream = stream_of(stream, "record");
    event->past = false;
    enqueue(stream, {}, [this, event] {
        event->past = true;
        event->at_s = clock_s_;
    });
    return {};
}

GpuResult RecordingRuntime::wait_for(GpuEventHandle handle) {
    const bool fails = begin_call("wait_for");
    expect_current("wait_for");
    Event* event = event_of(handle, "wait_for");
    if (event && !event->stream) fault("wait_for: the event was never recorded");
    while (event && event->stream && !event->past && !event->stream->work.empty()) run_one(*event->stream);
    return fails ? failed() : GpuResult{};
}

/// Each question lets one piece of work happen, as if time had passed.
GpuResult RecordingRuntime::query(GpuEventHandle handle) {
    if (begin_call("query")) return failed();
    expect_current("query");
    Event* event = event_of(handle, "query");
    if (!event || !event->stream) return {GpuResult::Kind::failure, "never recorded"};
    if (!event->past && !event->stream->work.empty()) run_one(*event->stream);
    return event->past ? GpuResult{} : GpuResult{GpuResult::Kind::not_ready, "not ready"};
}

GpuResult RecordingRuntime::elapsed(GpuEventHandle begin, GpuEventHandle end, double& seconds) {
    if (begin_call("elapsed")) return failed();
    expect_current("elapsed");
    const Event *a = event_of(begin, "elapsed"), *b = event_of(end, "elapsed");
    if (!a || !b || !a->past || !b->past) {
        fault("elapsed: an event is not past");
        return {GpuResult::Kind::failure, "not ready"};
    }
    seconds = b->at_s - a->at_s;
    return {};
}

GpuResult RecordingRuntime::launch(GpuFunctionHandle handle, const LaunchSize& size, std::span<void* const> arguments,
                                   GpuStreamHandle stream) {
    if (begin_call("launch")) return failed();
    expect_current("launch");
    const auto function = functions_.find(handle);
    if (function == functions_.end()) fault("launch: no such function");
    if (size.grid_x == 0 || size.grid_y == 0 || size.block_x * size.block_y == 0 || size.block_x * size.block_y > 1024)
        fault("launch: a size that no GPU takes");
    if (arguments.size() != 1) fault("launch: kernels take one argument");
    if (function == functions_.end() || arguments.size() != 1) return {};
    const std::byte* argument = static_cast<const std::byte*>(arguments[0]);
    const std::vector<std::byte> copy(argument, argument + argument_bytes_of(function->second->name));
    // A kernel may read and write all that there is.
    std::vector<Range> uses;
    for (const auto& [address, block] : device_)
        if (!block.freed) uses.push_back({address, block.bytes});
    enqueue(stream, std::move(uses), [this, copy, name = function->second->name] {
        const double seconds = on_launch ? on_launch(name, copy.data()) : 0;
        launch_s.push_back(seconds);
        clock_s_ += seconds;
    });
    return {};
}

}  // namespace kadr::test
