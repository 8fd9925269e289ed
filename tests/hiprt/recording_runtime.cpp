#include "recording_runtime.h"

#include <algorithm>
#include <cstring>
#include <utility>

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

template <class T>
T argument_of(const std::vector<std::byte>& bytes) {
    T argument;
    std::memcpy(static_cast<void*>(&argument), bytes.data(), sizeof argument);
    return argument;
}

using Ranges = std::vector<Range>;

template <class T>
void add(Ranges& list, const T* from, std::size_t count) {
    if (from) list.push_back({number_of(from), count * sizeof *from});
}

// Each takes the outputs out of a kernel's argument. @return what is left
kernels::LaunchParams inputs_of(kernels::LaunchParams params, Ranges& writes) {
    const auto width = static_cast<std::size_t>(params.scene.settings.width);
    const std::size_t first = static_cast<std::size_t>(params.y0) * width,
                      count = static_cast<std::size_t>(params.y1 - params.y0) * width;
    const kernels::FilmView film = std::exchange(params.film, {});
    const auto add_rows = [&](const auto* sums) { add(writes, sums ? sums + first : nullptr, count); };
    add_rows(film.beauty);
    add_rows(film.samples);
    add_rows(film.weights);
    add_rows(film.albedo);
    add_rows(film.normal);
    add_rows(film.depth);
    add_rows(film.hits);
    add_rows(film.motion);
    add(writes, std::exchange(params.counters, nullptr), 1);
    return params;
}
kernels::ProbeParams inputs_of(kernels::ProbeParams params, Ranges& writes) {
    add(writes, std::exchange(params.hits, nullptr), params.count);
    add(writes, std::exchange(params.occluded, nullptr), params.count);
    return params;
}
kernels::BendParams inputs_of(kernels::BendParams params, Ranges& writes) {
    const std::size_t count = std::size_t{params.rest.vertex_count} * params.poses.key_count;
    add(writes, std::exchange(params.vertices, nullptr), count);
    add(writes, std::exchange(params.tangents, nullptr), count);
    return params;
}
kernels::BoxParams inputs_of(kernels::BoxParams params, Ranges& writes) {
    add(writes, std::exchange(params.boxes, nullptr), params.geometry.triangle_count);
    return params;
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
    const auto locked = lock();
    return static_cast<std::size_t>(std::count(calls.begin(), calls.end(), call));
}

bool RecordingRuntime::begin_call(const std::string& name) {
    const auto locked = lock();
    calls.push_back(name);
    return static_cast<int>(calls.size()) - 1 == failing_call;
}

void RecordingRuntime::expect_current(const std::string& call) {
    const auto locked = lock();
    if (current_.count(std::this_thread::get_id()) == 0) fault(call + ": this thread never called make_current");
}

const RecordingRuntime::Block* RecordingRuntime::find(const Blocks& blocks, const Range& range) {
    auto at = blocks.upper_bound(range.begin);
    if (at == blocks.begin()) return nullptr;
    --at;
    return range.begin + range.bytes <= at->first + at->second.bytes ? &at->second : nullptr;
}

bool RecordingRuntime::expect_device(const Range& range, const std::string& what) {
    const auto locked = lock();
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
    const auto overlap = [&](const std::vector<Range>& uses) {
        return std::any_of(uses.begin(), uses.end(), [&](const Range& used) { return used.overlaps(range); });
    };
    return std::any_of(recent_.begin(), recent_.end(), [&](const auto& work) {
        if (has_waited_for(*work)) return false;
        return overlap(work->reads) || overlap(work->writes) || overlap(work->may_use);
    });
}

bool RecordingRuntime::is_idle() const {
    return std::all_of(streams_.begin(), streams_.end(),
                       [](const auto& stream) { return stream.second->work.empty(); });
}

void RecordingRuntime::join(Order& order, const Order& other) {
    for (const auto& [stream, number] : other) order[stream] = std::max(order[stream], number);
}

bool RecordingRuntime::has_waited_for(const Work& work) const {
    const auto waited = host_.find(work.stream);
    return waited != host_.end() && waited->second >= work.number;
}

/// Later work comes after it, on whatever stream.
void RecordingRuntime::host_waited(const Order& order) {
    join(host_, order);
    // What a launch uses is known when it runs: until then what it may race with is remembered.
    const bool unknown = std::any_of(recent_.begin(), recent_.end(), [](const auto& work) { return !work->may_use.empty(); });
    if (!unknown) std::erase_if(recent_, [&](const auto& work) { return has_waited_for(*work); });
}

bool RecordingRuntime::is_ordered(const Work& before, const Work& after) const {
    const auto seen = after.after.find(before.stream);
    return seen != after.after.end() && seen->second >= before.number;
}

void RecordingRuntime::find_races(const Work& work) {
    const auto overlap = [](const std::vector<Range>& a, const std::vector<Range>& b) {
        for (const Range& one : a)
            for (const Range& other : b)
                if (one.overlaps(other)) return true;
        return false;
    };
    for (const auto& other : recent_) {
        if (other->stream == work.stream || is_ordered(*other, work) || is_ordered(work, *other)) continue;
        if (overlap(work.writes, other->writes) || overlap(work.writes, other->reads) || overlap(work.reads, other->writes))
            fault(fmt::format("{} and {} use the same memory on two streams, and neither waits for the other", work.name, other->name));
    }
}

std::shared_ptr<RecordingRuntime::Work> RecordingRuntime::add_work(Stream& stream, const std::string& name,
                                                                   std::function<void(Work&)> run) {
    auto work = std::make_shared<Work>();
    work->name = name;
    work->stream = &stream;
    work->number = ++stream.count;
    join(stream.order, host_);
    work->after = stream.order;
    stream.order[&stream] = work->number;
    work->run = std::move(run);
    stream.work.push_back(work);
    recent_.push_back(work);
    return work;
}

void RecordingRuntime::enqueue(GpuStreamHandle handle, const std::string& name, std::vector<Range> reads,
                               std::vector<Range> writes, std::function<void()> run) {
    Stream* stream = stream_of(handle, "work");
    if (!stream) return;
    const auto work = add_work(*stream, name, [run = std::move(run)](Work&) { run(); });
    work->reads = std::move(reads);
    work->writes = std::move(writes);
    find_races(*work);
}

void RecordingRuntime::run_one(Stream& stream) {
    const std::shared_ptr<Work> work = stream.work.front();
    stream.work.pop_front();
    work->run(*work);
}

void RecordingRuntime::run_until(const Mark& mark) {
    while (!mark.past && !mark.stream->work.empty()) run_one(*mark.stream);
}

void RecordingRuntime::run_all(GpuStreamHandle handle) {
    Stream* stream = stream_of(handle, "synchronize");
    if (!stream) return;
    while (!stream->work.empty()) run_one(*stream);
    join(stream->order, {{stream, stream->count}});
    host_waited(stream->order);
}

/// The allocations that addresses among the words lie in, and those that these lead to.
void RecordingRuntime::reach(const std::byte* words, std::size_t bytes, std::set<std::uintptr_t>& seen,
                             std::vector<Range>& reads) const {
    for (std::size_t at = 0; at + sizeof(std::uintptr_t) <= bytes; at += sizeof(std::uintptr_t)) {
        std::uintptr_t word = 0;
        std::memcpy(&word, words + at, sizeof word);
        auto block = device_.upper_bound(word);
        if (block == device_.begin()) continue;
        --block;
        if (word >= block->first + block->second.bytes || block->second.freed || !seen.insert(block->first).second) continue;
        reads.push_back({block->first, block->second.bytes});
        reach(block->second.memory.get(), block->second.bytes, seen, reads);
    }
}

void RecordingRuntime::note_what_a_launch_uses(Work& work, const std::string& kernel, const std::vector<std::byte>& argument) {
    using namespace kernels;
    std::set<std::uintptr_t> seen;
    // What is left of an argument after its outputs were taken out is read.
    const auto note_reads = [&](const auto& inputs) { reach(reinterpret_cast<const std::byte*>(&inputs), sizeof inputs, seen, work.reads); };
    if (kernel == entry_point(Kernel::bend).name)
        note_reads(inputs_of(argument_of<BendParams>(argument), work.writes));
    else if (kernel == entry_point(Kernel::boxes).name)
        note_reads(inputs_of(argument_of<BoxParams>(argument), work.writes));
    else if (kernel == entry_point(Kernel::probe).name)
        note_reads(inputs_of(argument_of<ProbeParams>(argument), work.writes));
    else
        note_reads(inputs_of(argument_of<LaunchParams>(argument), work.writes));
    work.may_use.clear();
    find_races(work);
}

GpuFunctionHandle RecordingRuntime::make_function(const std::string& name) {
    const auto locked = lock();
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
    const auto locked = lock();
    if (begin_call("make_current")) return failed();
    current_.insert(std::this_thread::get_id());
    return {};
}

GpuResult RecordingRuntime::memory(std::size_t& free_bytes, std::size_t& total_bytes) {
    const auto locked = lock();
    if (begin_call("memory")) return failed();
    expect_current("memory");
    free_bytes = capacity - in_use_;
    total_bytes = capacity;
    return {};
}

GpuResult RecordingRuntime::allocate(std::size_t bytes, DeviceAddress& address) {
    const auto locked = lock();
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
    const auto locked = lock();
    const bool fails = begin_call("release");
    expect_current("release");
    const GpuResult result = release_from(device_, address, "release");
    return fails ? failed() : result;  // it is gone all the same: nobody can try again in a destructor
}

GpuResult RecordingRuntime::allocate_pinned(std::size_t bytes, void*& memory) {
    const auto locked = lock();
    if (begin_call("allocate_pinned")) return failed();
    expect_current("allocate_pinned");
    Block block{std::make_unique<std::byte[]>(bytes + 1), bytes, false};
    memory = block.memory.get();
    pinned_[number_of(memory)] = std::move(block);
    return {};
}

GpuResult RecordingRuntime::release_pinned(void* memory) {
    const auto locked = lock();
    const bool fails = begin_call("release_pinned");
    expect_current("release_pinned");
    const GpuResult result = release_from(pinned_, number_of(memory), "release_pinned");
    return fails ? failed() : result;
}

GpuResult RecordingRuntime::create_stream(GpuStreamHandle& stream) {
    const auto locked = lock();
    if (begin_call("create_stream")) return failed();
    expect_current("create_stream");
    auto created = std::make_unique<Stream>();
    stream = created.get();
    streams_[stream] = std::move(created);
    return {};
}

GpuResult RecordingRuntime::destroy_stream(GpuStreamHandle handle) {
    const auto locked = lock();
    const bool fails = begin_call("destroy_stream");
    expect_current("destroy_stream");
    const Stream* stream = stream_of(handle, "destroy_stream");
    if (stream && !stream->work.empty()) fault("destroy_stream: work on it is pending");
    host_.erase(stream);
    streams_.erase(handle);
    return fails ? failed() : GpuResult{};
}

GpuResult RecordingRuntime::synchronize(GpuStreamHandle stream) {
    const auto locked = lock();
    const bool fails = begin_call("synchronize");
    expect_current("synchronize");
    run_all(stream);
    return fails ? failed() : GpuResult{};
}

GpuResult RecordingRuntime::synchronize_all() {
    const auto locked = lock();
    const bool fails = begin_call("synchronize_all");
    expect_current("synchronize_all");
    for (const auto& [handle, stream] : streams_) run_all(handle);
    return fails ? failed() : GpuResult{};
}

GpuResult RecordingRuntime::upload(DeviceAddress to, const void* from, std::size_t bytes, GpuStreamHandle stream) {
    const auto locked = lock();
    if (begin_call("upload")) return failed();
    expect_current("upload");
    const Range target{to, bytes}, source{number_of(from), bytes};
    if (!expect_device(target, "upload") || !expect_pinned(source, "upload")) return {};
    enqueue(stream, "upload", {source}, {target}, [=] { std::memcpy(reinterpret_cast<void*>(to), from, bytes); });
    return {};
}

GpuResult RecordingRuntime::download(void* to, DeviceAddress from, std::size_t bytes, GpuStreamHandle stream) {
    const auto locked = lock();
    if (begin_call("download")) return failed();
    expect_current("download");
    const Range target{number_of(to), bytes}, source{from, bytes};
    if (!expect_pinned(target, "download") || !expect_device(source, "download")) return {};
    enqueue(stream, "download", {source}, {target}, [=] { std::memcpy(to, reinterpret_cast<const void*>(from), bytes); });
    return {};
}

GpuResult RecordingRuntime::fill(DeviceAddress to, std::uint8_t value, std::size_t bytes, GpuStreamHandle stream) {
    const auto locked = lock();
    if (begin_call("fill")) return failed();
    expect_current("fill");
    if (!expect_device({to, bytes}, "fill")) return {};
    enqueue(stream, "fill", {}, {{to, bytes}}, [=] { std::memset(reinterpret_cast<void*>(to), value, bytes); });
    return {};
}

GpuResult RecordingRuntime::create_event(GpuEventHandle& event) {
    const auto locked = lock();
    if (begin_call("create_event")) return failed();
    expect_current("create_event");
    auto created = std::make_unique<Event>();
    event = created.get();
    events_[event] = std::move(created);
    return {};
}

GpuResult RecordingRuntime::destroy_event(GpuEventHandle handle) {
    const auto locked = lock();
    const bool fails = begin_call("destroy_event");
    expect_current("destroy_event");
    event_of(handle, "destroy_event");  // what waits for its mark may still do so
    events_.erase(handle);
    return fails ? failed() : GpuResult{};
}

GpuResult RecordingRuntime::record(GpuEventHandle handle, GpuStreamHandle stream) {
    const auto locked = lock();
    if (begin_call("record")) return failed();
    expect_current("record");
    Event* event = event_of(handle, "record");
    Stream* on = stream_of(stream, "record");
    if (!event || !on) return {};
    const auto mark = std::make_shared<Mark>();
    mark->stream = on;
    const auto work = add_work(*on, "record", [this, mark](Work&) {
        mark->past = true;
        mark->at_s = clock_s_;
    });
    mark->order = on->order;
    event->mark = mark;
    return {};
}

GpuResult RecordingRuntime::wait_for(GpuEventHandle handle) {
    const auto locked = lock();
    const bool fails = begin_call("wait_for");
    expect_current("wait_for");
    const Event* event = event_of(handle, "wait_for");
    if (event && !event->mark) fault("wait_for: the event was never recorded");
    if (event && event->mark) {
        run_until(*event->mark);
        host_waited(event->mark->order);
    }
    return fails ? failed() : GpuResult{};
}

GpuResult RecordingRuntime::make_wait(GpuStreamHandle handle, GpuEventHandle event_handle) {
    const auto locked = lock();
    if (begin_call("make_wait")) return failed();
    expect_current("make_wait");
    const Event* event = event_of(event_handle, "make_wait");
    Stream* stream = stream_of(handle, "make_wait");
    if (event && !event->mark) fault("make_wait: the event was never recorded");
    if (!event || !event->mark || !stream) return {};
    join(stream->order, event->mark->order);
    add_work(*stream, "make_wait", [mark = event->mark](Work&) { run_until(*mark); });
    return {};
}

/// Each question lets one piece of work happen, as if time had passed.
GpuResult RecordingRuntime::query(GpuEventHandle handle) {
    const auto locked = lock();
    if (begin_call("query")) return failed();
    expect_current("query");
    const Event* event = event_of(handle, "query");
    if (!event || !event->mark) return {GpuResult::Kind::failure, "never recorded"};
    if (!event->mark->past && !event->mark->stream->work.empty()) run_one(*event->mark->stream);
    if (!event->mark->past) return {GpuResult::Kind::not_ready, "not ready"};
    host_waited(event->mark->order);
    return {};
}

GpuResult RecordingRuntime::elapsed(GpuEventHandle begin, GpuEventHandle end, double& seconds) {
    const auto locked = lock();
    if (begin_call("elapsed")) return failed();
    expect_current("elapsed");
    const Event *a = event_of(begin, "elapsed"), *b = event_of(end, "elapsed");
    if (!a || !b || !a->mark || !b->mark || !a->mark->past || !b->mark->past) {
        fault("elapsed: an event is not past");
        return {GpuResult::Kind::failure, "not ready"};
    }
    seconds = b->mark->at_s - a->mark->at_s;
    return {};
}

GpuResult RecordingRuntime::launch(GpuFunctionHandle handle, const LaunchSize& size, std::span<void* const> arguments,
                                   GpuStreamHandle stream) {
    const auto locked = lock();
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
    Stream* on = stream_of(stream, "launch");
    if (!on) return {};
    const auto work = add_work(*on, "launch", [this, copy, name = function->second->name](Work& launch) {
        note_what_a_launch_uses(launch, name, copy);
        const double seconds = on_launch ? on_launch(name, copy.data()) : 0;
        launch_s.push_back(seconds);
        clock_s_ += seconds;
    });
    // Until what it reads is known it may be anything.
    for (const auto& [address, block] : device_)
        if (!block.freed) work->may_use.push_back({address, block.bytes});
    return {};
}

}  // namespace kadr::test
