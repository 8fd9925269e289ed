// What the GPU lends is given back, whatever fails, and never while it is in use.

#include <cstring>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "device/hiprt/gpu_memory.h"
#include "device/hiprt/gpu_resources.h"
#include "device/hiprt/upload_queue.h"
#include "recording_runtime.h"

namespace kadr {
namespace {

using test::RecordingRuntime;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Gpu {
    RecordingRuntime runtime;
    GpuMemory memory{runtime};
    Gpu() { check(runtime.make_current(), "use the GPU"); }
};

TEST(GpuMemory, FiguresOfWhatIsTaken) {
    Gpu gpu;
    gpu.runtime.capacity = 1 << 20;
    EXPECT_EQ(gpu.memory.summary(), "nothing of it is ours; 1.0 MiB of 1.0 MiB are free");
    {
        const DeviceBuffer<float> vertices(gpu.memory, 65536, MemoryUse::vertices);
        const DeviceBuffer<std::uint8_t> film(gpu.memory, 100, MemoryUse::film);
        EXPECT_EQ(gpu.memory.summary(), "vertices 256.0 KiB, film 100 B; 767.9 KiB of 1.0 MiB are free");
        try {
            const DeviceBuffer<float> more(gpu.memory, 1 << 18, MemoryUse::textures);
            FAIL();
        } catch (const GpuOutOfMemory& error) {
            EXPECT_EQ(
                std::string(error.what()),
                "cannot allocate 1.0 MiB for textures: the memory of the GPU is full (vertices 256.0 KiB, film 100 B; "
                "767.9 KiB of 1.0 MiB are free)");
        }
    }
    EXPECT_EQ(gpu.memory.taken(), 0u);
    EXPECT_THAT(gpu.runtime.leaks(), IsEmpty());
    EXPECT_THAT(gpu.runtime.faults, IsEmpty());
}

TEST(DeviceBuffer, MovesAndGrowsWithoutLeaking) {
    Gpu gpu;
    {
        DeviceBuffer<int> a(gpu.memory, 10, MemoryUse::tables);
        DeviceBuffer<int> b(std::move(a));
        EXPECT_EQ(a.count(), 0u);  // NOLINT: moved from on purpose
        EXPECT_EQ(b.count(), 10u);
        const DeviceAddress address = b.address();
        b.reserve(gpu.memory, 8, MemoryUse::tables);
        EXPECT_EQ(b.address(), address);
        b.reserve(gpu.memory, 20, MemoryUse::tables);
        EXPECT_EQ(b.count(), 30u);
        EXPECT_EQ(gpu.memory.taken(MemoryUse::tables), 30 * sizeof(int));
        const DeviceBuffer<int> none(gpu.memory, 0, MemoryUse::tables);
        EXPECT_EQ(none.address(), 0u);
    }
    EXPECT_THAT(gpu.runtime.leaks(), IsEmpty());
    EXPECT_THAT(gpu.runtime.faults, IsEmpty());
}

TEST(DeviceBuffer, WaitsForWorkBeforeItIsFreed) {
    Gpu gpu;
    const GpuStream stream(gpu.runtime);
    {
        const DeviceBuffer<std::uint8_t> buffer(gpu.memory, 1000, MemoryUse::scratch);
        check(gpu.runtime.fill(buffer.address(), 7, 1000, stream.handle()), "fill");
    }
    EXPECT_THAT(gpu.runtime.faults, IsEmpty());
}

/// Sends `count` numbers in pieces of many sizes and reads them back.
std::vector<std::uint32_t> round_trip(Gpu& gpu, std::size_t count) {
    const GpuStream stream(gpu.runtime);
    std::vector<std::uint32_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 1u);
    const DeviceBuffer<std::uint32_t> buffer(gpu.memory, count, MemoryUse::tables);
    {
        UploadQueue queue(gpu.runtime, stream);
        for (std::size_t first = 0, piece = 1; first < count; first += piece, piece = piece * 3 % 1000003 + 1) {
            const std::vector<std::uint32_t> part(
                numbers.begin() + static_cast<std::ptrdiff_t>(first),
                numbers.begin() + static_cast<std::ptrdiff_t>(std::min(count, first + piece)));
            queue.add(buffer.address() + first * 4, part.data(), part.size() * 4);
        }  // the parts are gone before anything has arrived
    }
    const PinnedMemory back(gpu.runtime, count * 4);
    check(gpu.runtime.download(back.data(), buffer.address(), count * 4, stream.handle()), "read back");
    stream.synchronize("read back");
    std::vector<std::uint32_t> got(count);
    std::memcpy(got.data(), back.data(), count * 4);
    EXPECT_EQ(got, numbers);
    return got;
}

TEST(UploadQueue, EverythingArrives) {
    Gpu gpu;
    const std::size_t three_blocks = 3 * UploadQueue::kBlockBytes / 4 + 12345;
    round_trip(gpu, three_blocks);
    EXPECT_THAT(gpu.runtime.faults, IsEmpty());
    EXPECT_THAT(gpu.runtime.leaks(), IsEmpty());
}

TEST(UploadQueue, WhicheverCallFailsEverythingIsFreed) {
    Gpu right;
    round_trip(right, 5'000'000);
    for (int n = 1; n < static_cast<int>(right.runtime.calls.size()); ++n) {
        Gpu gpu;
        gpu.runtime.failing_call = n;
        const std::string call = right.runtime.calls[static_cast<std::size_t>(n)];
        ::testing::internal::CaptureStderr();
        std::string message;
        try {
            round_trip(gpu, 5'000'000);
        } catch (const RenderError& error) {
            message = error.what();
        }
        message += ::testing::internal::GetCapturedStderr();
        EXPECT_THAT(message, HasSubstr("cannot ")) << call;
        EXPECT_THAT(message, HasSubstr("a failure that the test asked for")) << call;
        EXPECT_THAT(gpu.runtime.leaks(), IsEmpty()) << call;
        EXPECT_THAT(gpu.runtime.faults, IsEmpty()) << call;
    }
}

TEST(GpuEvents, MeasureTime) {
    Gpu gpu;
    gpu.runtime.on_launch = [](const std::string&, const std::byte*) { return 0.25; };
    const GpuStream stream(gpu.runtime);
    const GpuEvent begin(gpu.runtime), end(gpu.runtime);
    begin.record(stream);
    std::vector<std::byte> argument(4096);
    void* const arguments[] = {argument.data()};
    check(gpu.runtime.launch(gpu.runtime.make_function("kernel"), {}, arguments, stream.handle()), "launch");
    end.record(stream);
    EXPECT_EQ(gpu.runtime.query(end.handle()).kind, GpuResult::Kind::not_ready);
    end.wait("wait");
    EXPECT_EQ(end.seconds_since(begin), 0.25);
    EXPECT_THAT(gpu.runtime.faults, IsEmpty());
}

}  // namespace
}  // namespace kadr
