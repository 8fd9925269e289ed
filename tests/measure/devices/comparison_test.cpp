// Devices compared for real: the processor with itself at other widths, with the reference in double and with the fake
// GPU, which all show the same; and with devices that are wrong on purpose, which all are caught.
#include "measure/device_comparison.h"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "device/broken_device.h"
#include "hiprt/tracing_gpu.h"
#include "render/tiny_shot.h"

namespace kadr::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Grass that turns a quarter within five frames, on a studio's floor, under a lamp and a panel.
std::filesystem::path write_shot(const std::filesystem::path& folder, const std::string& more = "") {
    const std::string assets = std::string(KADR_SOURCE_DIR) + "/shots/assets/";
    write_text(
        folder / "parity.yaml",
        "kadr: 1\nname: parity\ntiming: { fps: 24, frames: 0-4 }\nimage: { size: [40, 24] }\n"
        "scenes:\n  - { id: studio, gltf: " +
            assets +
            "studio.glb }\n"
            "  - { id: grass, gltf: " +
            assets +
            "tuft.glb, transform: { scale: 4, rotate: { axis: [0, 1, 0], "
            "angle: { keys: { 0 f: 0 deg, 4 f: 90 deg } } } } }\n"
            "camera: { position: [0, 1.2, 4], look_at: [0, 0.5, 0], focal_length: 40 mm }\n"
            "lights:\n  - { id: lamp, type: point, intensity: 8 cd, position: [1, 2, 2] }\n"
            "  - { id: panel, type: area, size: [1, 1], luminance: 3 nt, position: [-1, 2.5, 1], look_at: [0, 0, 0] }\n"
            "environment: { color: [0.2, 0.25, 0.3] }\nrender: { bounces: { total: 2 } }\n" +
            more);
    return folder / "parity.yaml";
}

struct Parity {
    TemporaryFolder folder;
    DeviceComparisonOptions options;
    Parity() {
        options.render.shot = write_shot(folder.path());
        options.render.device.threads = 2;
        options.devices = {"cpu", "cpu:1"};
    }
    DeviceComparison run() const {
        return compare_devices(options, [](const ComparedDeviceFrame&) {});
    }
    /// The second device is the processor, broken.
    DeviceComparison with_broken(const std::function<void(BrokenDevice&)>& break_it) {
        options.make = [this, break_it](const std::string& name, const LoadedShot& shot) -> std::unique_ptr<Device> {
            auto device = make_compared_device(name, shot, 2);
            if (name == options.devices.first) return device;
            auto broken = std::make_unique<BrokenDevice>(std::move(device));
            break_it(*broken);
            return broken;
        };
        return run();
    }
};

void expect_same(const DeviceComparison& comparison) {
    EXPECT_FALSE(comparison.differs()) << json_of(comparison);
    EXPECT_THAT(comparison.verdict(), HasSubstr(" show the same: "));
}

TEST(CompareDevices, TheProcessorAtOtherWidthsIsTheSameInTheFirstMiddleAndLastFrame) {
    Parity parity;
    const DeviceComparison comparison = parity.run();
    expect_same(comparison);
    ASSERT_EQ(comparison.frames.size(), 3u);
    EXPECT_EQ(comparison.frames[1].frame, 2);
    EXPECT_EQ(comparison.frames[2].frame, 4);
    const ComparedDeviceFrame& frame = comparison.frames[0];
    EXPECT_EQ(frame.rays.rays, 3u * 40 * 24);
    EXPECT_EQ(frame.rays.other_ids, 0u);  // probes trace the same single rays at either width
    EXPECT_GT(frame.noise.scales[0].tests, 2000u);
    EXPECT_LT(frame.pictures.flip, 1.5 * frame.noise_alone.flip + 1e-3);
    EXPECT_GT(frame.times[1].rays_per_s(), 0);
    EXPECT_THAT(comparison.devices[1], HasSubstr("1 lane"));
}

TEST(CompareDevices, TheReferenceInDoubleIsTheSame) {
    Parity parity;
    parity.options.devices = {"cpu", "exact"};
    parity.options.render.overrides.frames = "1";
    const DeviceComparison comparison = parity.run();
    expect_same(comparison);
    ASSERT_EQ(comparison.frames.size(), 1u);
    EXPECT_EQ(comparison.frames[0].rays.wrong(), 0u);
}

/// Rays of a lens as long start just before the subject on the processor, and at the camera in the reference.
TEST(CompareDevices, TheReferenceIsTheSameThroughALongLens) {
    Parity parity;
    parity.options.devices = {"cpu", "exact"};
    parity.options.render.overrides.frames = "0";
    parity.options.render.overrides.set = {{"camera.position", "[0, 100, 20000]"}, {"camera.focal_length", "null"}, {"camera.vertical_fov", "0.006 deg"}};
    expect_same(parity.run());
}

TEST(CompareDevices, AGpuThatTracesIsTheSame) {
    TracingGpu gpu;
    Parity parity;
    parity.options.devices = {"cpu", "hiprt"};
    parity.options.render.overrides.frames = "3";
    parity.options.samples = 4;
    parity.options.make = [&](const std::string& name, const LoadedShot& shot) {
        return name == "hiprt" ? gpu.make() : make_compared_device(name, shot, 2);
    };
    const DeviceComparison comparison = parity.run();
    expect_same(comparison);
    EXPECT_GT(comparison.frames[0].times[1].rays, 10'000u);
    EXPECT_GT(comparison.frames[0].rays.place_error, 0) << "the fake GPU computes otherwise";
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(CompareDevices, AMovedInstanceIsFoundByRaysAndNamed) {
    Parity parity;
    parity.options.render.overrides.frames = "2";
    const DeviceComparison comparison = parity.with_broken([](BrokenDevice& broken) {
        broken.break_frame = [](SceneSnapshot& snapshot) {
            move_instance(snapshot, snapshot.instances.size() - 1, 0.01f);
        };
    });
    EXPECT_TRUE(comparison.differs());
    const RayAgreement& rays = comparison.frames[0].rays;
    EXPECT_GT(rays.wrong_ids, 10u);
    EXPECT_GT(rays.wrong_places, 10u);
    ASSERT_TRUE(rays.first_bad);
    EXPECT_EQ(rays.first_bad->frame, 2);
    EXPECT_THAT(rays.first_bad->first.node + rays.first_bad->second.node, HasSubstr("grass/"));
    EXPECT_THAT(comparison.verdict(), StartsWith("cpu and cpu:1 differ: rays in frame 2"));
}

TEST(CompareDevices, OnePercentMoreLightIsFoundByThePictureAlone) {
    Parity parity;
    parity.options.render.overrides.frames = "2";
    parity.options.samples = 64;
    const DeviceComparison comparison = parity.with_broken([](BrokenDevice& broken) {
        broken.break_frame = [](SceneSnapshot& snapshot) { scale_lights(snapshot, 1.01f); };
    });
    const ComparedDeviceFrame& frame = comparison.frames[0];
    EXPECT_EQ(frame.rays.wrong(), 0u);
    EXPECT_GT(frame.noise.scales[2].rejected, 0u) << json_of(comparison);
    EXPECT_GT(frame.noise.difference_from, 0);
    EXPECT_NEAR(frame.noise.difference, 0.01, 0.004);
    EXPECT_EQ(comparison.verdict(), "cpu and cpu:1 differ: pictures beyond noise in frame 2");
}

TEST(CompareDevices, ADroppedTriangleIsFoundByRaysAndNamed) {
    Parity parity;
    parity.options.render.overrides.frames = "2";
    // Without the grass, the first ray that differs tells a triangle of it that is seen.
    const DeviceComparison without = parity.with_broken([](BrokenDevice& broken) {
        broken.break_frame = [](SceneSnapshot& snapshot) {
            move_instance(snapshot, snapshot.instances.size() - 1, 1000);
        };
    });
    ASSERT_TRUE(without.frames[0].rays.first_bad);
    const int seen = without.frames[0].rays.first_bad->first.primitive;
    const DeviceComparison comparison = parity.with_broken([seen](BrokenDevice& broken) {
        broken.break_scene = [seen](Scene& scene) {
            drop_triangle(scene, scene.geometries.size() - 1, static_cast<std::size_t>(seen));
        };
    });
    const RayAgreement& rays = comparison.frames[0].rays;
    EXPECT_GT(rays.wrong_ids, 0u);
    EXPECT_EQ(rays.wrong_places, 0u);
    ASSERT_TRUE(rays.first_bad);
    EXPECT_EQ(rays.first_bad->first.primitive, seen);
    EXPECT_THAT(rays.first_bad->first.node, StartsWith("grass/"));
    EXPECT_LT(rays.first_bad->first.distance_m,
              rays.first_bad->second.met ? rays.first_bad->second.distance_m : 1e30);
}

/// A device whose rays slip between triangles now and then, as HIPRT's do: at their common edge, not beside it.
class Slipping final : public Device, private Probe {
public:
    Slipping(std::unique_ptr<Device> device, bool anywhere) : device_(std::move(device)), anywhere_(anywhere) {}
    std::string name() const override { return "slipping"; }
    void load(const Scene& scene, const Image* environment, const BuildSettings& build) override {
        device_->load(scene, environment, build);
    }
    void set_frame(const SceneSnapshot& snapshot) override { device_->set_frame(snapshot); }
    void render(const Pass& pass, Film& film) override { device_->render(pass, film); }
    DeviceStatistics statistics() const override { return device_->statistics(); }
    Probe* probe() override { return this; }
    mutable int slipped = 0;

private:
    std::vector<SurfaceHit> look(std::span<const kernels::Vec2f> film_px, double time) override {
        std::vector<SurfaceHit> hits = device_->probe()->look(film_px, time);
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const double least = std::min({hits[i].u, hits[i].v, 1 - hits[i].u - hits[i].v});
            const bool slips = anywhere_ ? i % 97 == 0 : least < 3e-6;
            if (!hits[i].met() || !slips) continue;
            ++slipped;
            hits[i] = {};
        }
        return hits;
    }
    std::vector<char> occluded(std::span<const SurfaceRay> rays, double time) override {
        return device_->probe()->occluded(rays, time);
    }
    std::unique_ptr<Device> device_;
    bool anywhere_;
};

/// The square's diagonal runs through the centres of its pixels.
RayAgreement agreement_with_slipping(bool anywhere) {
    TemporaryFolder folder;
    write_text(folder.path() / "square.gltf",
               R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"Square","mesh":0}],
"meshes":[{"name":"Sheet","primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,-1,0],"max":[1,1,0]},{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":6}],
"buffers":[{"byteLength":54,"uri":"data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAAAAECAAID"}]})");
    write_text(folder.path() / "square.yaml",
               "kadr: 1\nname: square\ntiming: { fps: 24, frames: \"0\" }\nimage: { size: [24, 24] }\nscenes:\n  - { "
               "id: a, gltf: square.gltf }\n"
               "camera: { position: [0, 0, 4], look_at: [0, 0, 0] }\nenvironment: { color: [1, 1, 1] }\n");
    DeviceComparisonOptions options;
    options.render.shot = folder.path() / "square.yaml";
    options.devices = {"cpu:1", "slipping"};
    options.samples = 2;
    options.replicates = 3;
    Slipping* slipping = nullptr;
    options.make = [&](const std::string& name, const LoadedShot& shot) -> std::unique_ptr<Device> {
        auto device = make_compared_device("cpu:1", shot, 1);
        if (name == "cpu:1") return device;
        auto made = std::make_unique<Slipping>(std::move(device), anywhere);
        slipping = made.get();
        return made;
    };
    RayAgreement rays;
    compare_devices(options, [&](const ComparedDeviceFrame& frame) {
        rays = frame.rays;
        EXPECT_GT(slipping->slipped, 3) << "nothing slipped";
    });
    return rays;
}

TEST(CompareDevices, RaysThatSlipThroughAnEdgeAreToldFromHoles) {
    const RayAgreement edges = agreement_with_slipping(false), holes = agreement_with_slipping(true);
    EXPECT_GT(edges.other_ids, 3u);
    EXPECT_EQ(edges.at_edges, edges.other_ids);
    EXPECT_EQ(edges.wrong(), 0u);
    EXPECT_GT(holes.wrong_ids, 0u);
    ASSERT_TRUE(holes.first_bad);
    EXPECT_EQ(holes.first_bad->first.mesh.substr(0, 5), "Sheet");
    EXPECT_FALSE(holes.first_bad->second.met);
}

TEST(CompareDevices, WritesPicturesMapsAndAReport) {
    Parity parity;
    parity.options.render.overrides.frames = "0";
    parity.options.output = parity.folder.path() / "out";
    const DeviceComparison comparison = parity.run();
    for (const char* name : {"parity.0000.cpu.exr", "parity.0000.cpu-1.exr", "parity.0000.flip.png",
                             "parity.0000.z.png", "parity.devices.json"})
        EXPECT_GT(std::filesystem::file_size(parity.options.output / name), 100u) << name;
    std::ifstream file(comparison.json);
    const auto json = nlohmann::json::parse(file);
    EXPECT_EQ(json["devices"][1]["name"], "cpu:1");
    EXPECT_EQ(json["frames"][0]["rays"]["wrong_ids"], 0);
    EXPECT_EQ(json["frames"][0]["noise"]["scales"][2]["name"], "picture");
    EXPECT_EQ(json["frames"][0]["files"].size(), 4u);
    EXPECT_FALSE(json["differs"]);
}

TEST(CompareDevices, NamesAreTwoThatThereAre) {
    EXPECT_EQ(parse_device_pair("cpu,hiprt:2"), (std::pair<std::string, std::string>("cpu", "hiprt:2")));
    EXPECT_EQ(parse_device_pair("exact,cpu:8").first, "exact");
    for (const char* wrong :
         {"", "cpu", "cpu,", "cpu,gpu", "cpu,hiprt:", "cpu,hiprt:x", "cpu:2,cpu", "cpu,cpu,cpu", "auto,cpu"})
        EXPECT_THROW(parse_device_pair(wrong), InputError) << wrong;
}

TEST(CompareDevices, AMissingGpuIsNamedWithTheReason) {
    Parity parity;
    parity.options.devices = {"cpu", "hiprt"};
    try {
        parity.run();
        GTEST_SKIP() << "this machine has a GPU that works";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("--devices: hiprt: "),
                                        HasSubstr("expected two devices that work here, as in --devices cpu,cpu:1")));
    }
}

}  // namespace
}  // namespace kadr::test
