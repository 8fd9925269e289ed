// Several devices render one shot: what each of them renders is what one alone would have.

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "render/frame_farm.h"
#include "shot/shot_parser.h"
#include "tracing_gpu.h"

namespace kadr::test {
namespace {

namespace fs = std::filesystem;

/// A triangle that moves and turns, lit by a lamp that moves, in six frames of 24 x 16 pixels.
class ShotFile {
public:
    ShotFile() {
        std::string name = (fs::temp_directory_path() / "kadr-farm-XXXXXX").string();
        folder_ = mkdtemp(name.data());
        std::ofstream(folder_ / "triangle.gltf")
            << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"Triangle","mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-1,-1,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAAAAAAAAgD8AAAAA"}]})";
        std::ofstream(file())
            << "kadr: 1\nname: farm\ntiming: { fps: 24, frames: 0-5 }\nimage: { size: [24, 16] }\nscenes:\n"
               "  - { id: t, gltf: triangle.gltf, transform: { rotate: { keys: { 0 f: [0, 0, 0], 6 f: [0, 40 deg, 0] } "
               "} } }\n"
               "camera: { position: [0, 0, 4], look_at: [0, 0, 0] }\n"
               "lights: [ { type: point, power: 800 lm, position: { keys: { 0 f: [0, 1, 2], 6 f: [1, 0, 2] } } } ]\n"
               "environment: { color: [1, 1, 1], strength: 0.2 }\nrender: { samples: 4, bounces: { total: 2 } }\n";
    }
    ~ShotFile() {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    ShotFile(const ShotFile&) = delete;
    ShotFile& operator=(const ShotFile&) = delete;
    fs::path file() const { return folder_ / "farm.yaml"; }

private:
    fs::path folder_;
};

struct Rendered {
    std::vector<std::vector<float>> frames;
    std::set<std::string> devices;
    std::uint64_t staged = 0;
};

Rendered render(const ShotFile& shot, std::vector<DeviceChoice> devices) {
    const LoadedShot loaded(parse_shot(shot.file()));
    FrameFarm::Settings settings;
    settings.frames = loaded.bound().timing().frames.size();
    settings.clock = [] { return 0.0; };
    settings.progress = [](int, double, int) {};
    settings.rendered = [](const FrameTask&, const FrameTask::Rendered&) {};
    FrameSchedule schedule(settings.frames, devices.size(), [&](std::size_t index) {
        auto task = std::make_shared<FrameTask>();
        task->index = index;
        task->time = loaded.bound().sequence().frame(loaded.bound().timing().frames[index]);
        task->parts = std::make_shared<const std::vector<SceneSnapshot>>(make_snapshots(loaded.bound(), task->time));
        return task;
    });
    FrameFarm farm(loaded, std::move(devices), settings);
    farm.start(schedule);
    Rendered rendered;
    for (std::size_t index = 0; index < settings.frames; ++index) {
        const FrameTask::Rendered frame = schedule.at(index)->rendered.get();
        rendered.frames.push_back(frame->image.pixels);
        rendered.devices.insert(frame->device);
        rendered.staged += frame->statistics.staged;
        schedule.delivered();
    }
    farm.join();
    return rendered;
}

TEST(FrameFarm, TwoProcessorsRenderWhatOneDoes) {
    const auto cpus = [](int count) {
        std::vector<DeviceChoice> devices;
        for (int i = 0; i < count; ++i) devices.push_back(make_device({"cpu", 1, 0}));
        return devices;
    };
    const ShotFile shot;
    const Rendered one = render(shot, cpus(1)), two = render(shot, cpus(2));
    ASSERT_EQ(one.frames.size(), 6u);
    EXPECT_NE(one.frames[0], one.frames[5]);
    EXPECT_EQ(two.frames, one.frames);
}

TEST(FrameFarm, TwoGpusRenderWhatOneDoes) {
    const ShotFile shot;
    TracingGpu alone, left, right;
    right.runtime->compute = 80;  // another kind of GPU
    const auto gpus = [](std::initializer_list<TracingGpu*> all) {
        std::vector<DeviceChoice> devices;
        for (TracingGpu* gpu : all) devices.push_back({gpu->make(), "a test", ""});
        return devices;
    };
    const Rendered one = render(shot, gpus({&alone})), two = render(shot, gpus({&left, &right}));
    EXPECT_NE(one.frames[0], one.frames[5]);
    EXPECT_EQ(two.frames, one.frames);
    EXPECT_GT(left.runtime->count("launch"), 0u);
    EXPECT_GT(right.runtime->count("launch"), 0u);
    for (const TracingGpu* gpu : {&alone, &left, &right}) EXPECT_EQ(gpu->complaints(), "");
}

TEST(FrameFarm, AGpuThatFailsSaysSo) {
    const ShotFile shot;
    TracingGpu left, right;
    std::vector<DeviceChoice> devices;
    devices.push_back({left.make(), "a test", ""});
    devices.push_back({right.make(), "a test", ""});
    right.runtime->capacity = right.runtime->in_use() + 100;  // enough to start, too little for any frame
    try {
        render(shot, std::move(devices));
        FAIL();
    } catch (const RenderError& error) {
        EXPECT_EQ(std::string(error.what())
                      .rfind("hiprt (a recording, HIPRT API 3001): the memory of the GPU does not hold ", 0),
                  0u)
            << error.what();
    }
    EXPECT_EQ(left.complaints(), "");
    EXPECT_EQ(right.complaints(), "");
}

}  // namespace
}  // namespace kadr::test
