#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "device/hiprt/gpu_runtime.h"

namespace kadr::test {

/// A stretch of memory.
struct Range {
    std::uintptr_t begin = 0;
    std::size_t bytes = 0;
    bool overlaps(const Range& other) const { return begin < other.begin + other.bytes && other.begin < begin + bytes; }
};

/// A GPU that has none: its memory is the host's, work on streams waits until somebody waits for it, and every call is
/// checked for what a real one would punish with a crash or a wrong image: memory that is not there, is too small or
/// was freed, frees while work is pending, threads that have no context, leaks. What is wrong is listed in `faults`.
///
/// Streams run side by side: of two pieces of work on different streams that touch the same memory, one of them to
/// write, one has to come after the other by an event or because the host waited; else it is a fault, in whichever order
/// they happened to run here. A launch reads what its argument points to, and what is pointed to from there.
///
/// Calls may come from several threads; on_launch is called by one of them at a time.
///
/// Any call can be made to fail, those of the fake HIPRT (fake_hiprt.h) among them: they are counted together.
class RecordingRuntime final : public GpuRuntime {
public:
    ~RecordingRuntime() override;

    // What a test sets.
    int failing_call = -1;  ///< number of the call that fails, from 0
    GpuResult::Kind failure = GpuResult::Kind::failure;
    std::size_t capacity = std::size_t{1} << 30;  ///< bytes of device memory
    GpuVendor vendor = GpuVendor::nvidia;
    int compute = 90;
    /// Runs a kernel. `argument`: a copy of the launch's one argument. @return seconds that it took
    std::function<double(const std::string& function, const std::byte* argument)> on_launch;

    // What a test reads.
    std::vector<std::string> calls;   ///< all, in order
    std::vector<std::string> faults;  ///< empty: everything was right
    std::vector<double> launch_s;     ///< how long each launch took
    std::size_t in_use() const { return in_use_; }
    std::size_t most_in_use() const { return most_in_use_; }
    std::vector<std::string> leaks() const;  ///< what is still there
    std::size_t count(const std::string& call) const;

    // For the fake HIPRT.
    /// Notes a call. @return whether it is to fail
    bool begin_call(const std::string& name);
    void fault(const std::string& text) {
        const auto locked = lock();
        faults.push_back(text);
    }
    /// Whether a range lies in live device memory; a fault otherwise.
    bool expect_device(const Range& range, const std::string& what);
    /// @param name  for faults
    void enqueue(GpuStreamHandle stream, const std::string& name, std::vector<Range> reads, std::vector<Range> writes,
                 std::function<void()> run);
    /// Whether work that the host has not waited for uses the range.
    bool is_pending(const Range& range) const;
    bool is_idle() const;  ///< nothing is left to run
    /// Runs what is on the stream; the host has waited for it then.
    void run_all(GpuStreamHandle stream);
    /// One call at a time: held while a call looks at what is recorded.
    [[nodiscard]] std::unique_lock<std::recursive_mutex> lock() const {
        return std::unique_lock<std::recursive_mutex>(mutex_);
    }
    GpuFunctionHandle make_function(const std::string& name);
    void expect_current(const std::string& call);

    GpuProperties properties() const override { return {"a recording", "fake_1", vendor, capacity, compute}; }
    GpuResult make_current() override;
    GpuResult memory(std::size_t& free_bytes, std::size_t& total_bytes) override;
    void* native_context() const override { return const_cast<RecordingRuntime*>(this); }
    int native_device() const override { return 0; }
    GpuResult allocate(std::size_t bytes, DeviceAddress& address) override;
    GpuResult release(DeviceAddress address) override;
    GpuResult allocate_pinned(std::size_t bytes, void*& memory) override;
    GpuResult release_pinned(void* memory) override;
    GpuResult create_stream(GpuStreamHandle& stream) override;
    GpuResult destroy_stream(GpuStreamHandle stream) override;
    GpuResult synchronize(GpuStreamHandle stream) override;
    GpuResult synchronize_all() override;
    GpuResult upload(DeviceAddress to, const void* from, std::size_t bytes, GpuStreamHandle stream) override;
    GpuResult download(void* to, DeviceAddress from, std::size_t bytes, GpuStreamHandle stream) override;
    GpuResult fill(DeviceAddress to, std::uint8_t value, std::size_t bytes, GpuStreamHandle stream) override;
    GpuResult create_event(GpuEventHandle& event) override;
    GpuResult destroy_event(GpuEventHandle event) override;
    GpuResult record(GpuEventHandle event, GpuStreamHandle stream) override;
    GpuResult wait_for(GpuEventHandle event) override;
    GpuResult make_wait(GpuStreamHandle stream, GpuEventHandle event) override;
    GpuResult query(GpuEventHandle event) override;
    GpuResult elapsed(GpuEventHandle begin, GpuEventHandle end, double& seconds) override;
    GpuResult launch(GpuFunctionHandle function, const LaunchSize& size, std::span<void* const> arguments,
                     GpuStreamHandle stream) override;

private:
    struct Block {
        std::unique_ptr<std::byte[]> memory;
        std::size_t bytes = 0;
        bool freed = false;
    };
    using Blocks = std::map<std::uintptr_t, Block>;
    struct Stream;
    /// How much of each stream something comes after.
    using Order = std::map<const Stream*, std::size_t>;
    struct Work {
        std::string name;
        const Stream* stream = nullptr;
        std::size_t number = 0;  ///< on its stream, from 1
        Order after;
        std::vector<Range> reads, writes;
        std::vector<Range> may_use;  ///< by a launch, of which the rest is known when it runs
        std::function<void(Work&)> run;
    };
    struct Stream {
        std::deque<std::shared_ptr<Work>> work;
        std::size_t count = 0;  ///< of all work that ever was on it
        Order order;            ///< of what comes next
    };
    struct Mark {
        Stream* stream = nullptr;
        Order order;
        bool past = false;
        double at_s = 0;
    };
    struct Event {
        std::shared_ptr<Mark> mark;  ///< null: never recorded
    };
    struct Function {
        std::string name;
    };

    GpuResult failed() const { return {failure, "a failure that the test asked for"}; }
    static const Block* find(const Blocks& blocks, const Range& range);
    bool expect_pinned(const Range& range, const std::string& what);
    GpuResult release_from(Blocks& blocks, std::uintptr_t address, const char* what);
    Stream* stream_of(GpuStreamHandle stream, const char* call);
    Event* event_of(GpuEventHandle event, const char* call);
    static void run_one(Stream& stream);
    static void run_until(const Mark& mark);
    static void join(Order& order, const Order& other);
    std::shared_ptr<Work> add_work(Stream& stream, const std::string& name, std::function<void(Work&)> run);
    void host_waited(const Order& order);
    bool has_waited_for(const Work& work) const;
    void find_races(const Work& work);
    bool is_ordered(const Work& before, const Work& after) const;
    void note_what_a_launch_uses(Work& work, const std::string& kernel, const std::vector<std::byte>& argument);
    void reach(const std::byte* words, std::size_t bytes, std::set<std::uintptr_t>& seen, std::vector<Range>& reads) const;

    Blocks device_, pinned_;
    std::size_t in_use_ = 0, most_in_use_ = 0;
    std::map<void*, std::unique_ptr<Stream>> streams_;
    std::map<void*, std::unique_ptr<Event>> events_;
    std::map<void*, std::unique_ptr<Function>> functions_;
    std::set<std::thread::id> current_;
    Order host_;                                ///< what the host has waited for
    std::deque<std::shared_ptr<Work>> recent_;  ///< what it has not
    double clock_s_ = 0;
    mutable std::recursive_mutex mutex_;
};

}  // namespace kadr::test
