// The GPU device over fakes: what HIPRT and the kernels are given, what comes back, and what happens when calls fail,
// memory runs out or the user cancels.

#include <atomic>
#include <cmath>
#include <cstring>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "device/small_scene.h"
#include "fake_gpu.h"
#include "kernels/sampler/sobol.h"

namespace kadr::test {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

glm::dmat4 turned(double degrees, glm::dvec3 position = {0, 0, 0}) {
    return glm::rotate(glm::translate(glm::dmat4(1), position), glm::radians(degrees), glm::dvec3(0, 1, 0));
}

/// A bit of everything: still, moving, hidden, empty, sheared, cut out and textured instances, lights, an environment.
SmallScene full_scene() {
    SmallScene s;
    s.snapshot.settings.width = 24;
    s.snapshot.settings.height = 20;
    s.environment.width = 4;
    s.environment.height = 2;
    s.environment.channels = {"R", "G", "B"};
    s.environment.pixels.assign(24, 0.5f);
    const unsigned square = s.add_mesh(unit_square()), sphere = s.add_mesh(unit_sphere(8)), empty = s.add_mesh({});
    TextureData texture;
    texture.width = texture.height = 2;
    texture.texels.assign(16, 200);
    s.scene.textures.push_back(texture);
    kernels::Material plain = material({0.5f, 0.5f, 0.5f}, 0, 1), textured = plain, cut = plain, glowing = plain;
    textured.base_color_texture.texture = 0;
    cut.alpha_mode = kernels::AlphaMode::mask;
    glowing.emission = {1, 1, 1};
    s.add_instance(square, textured, place({0, 0, 0}));
    s.add_instance(empty, plain, place({0, 0, 0}));
    s.add_instance(sphere, plain, place({1, 0, 0}), false);
    s.snapshot.instances.edit(2).mask = 0;
    s.add_instance(square, cut, place({2, 0, 0}), false);
    s.add_instance(sphere, glowing, place({-2, 0, 0}), false);
    glm::dmat4 shear(1);
    shear[1][0] = 0.5;
    s.add_instance(sphere, plain, shear, false);
    s.add_moving(sphere, plain, {turned(0), turned(9), turned(18)});
    kernels::Light light;
    light.radiance = {1, 1, 1};
    s.add_light(light);
    light.kind = kernels::LightKind::area;
    s.add_light(light);
    return s;
}

/// Renders one frame. @return the film
Film render(Device& device, SmallScene& s, Pass pass = {}, FilmLayers layers = {}, bool weighted = false) {
    s.snapshot.geometry_key = 1;
    device.load(s.scene, s.environment.width > 0 ? &s.environment : nullptr);
    device.set_frame(s.snapshot);
    Film film(s.snapshot.settings.width, s.snapshot.settings.height, layers);
    film.clear(weighted);
    pass.total_samples = pass.sample_count;
    device.begin_film(film);
    device.render(pass, film);
    device.read_film(film);
    return film;
}

TEST(HiprtDevice, AFrameIsRenderedWithoutFaultsOrLeaks) {
    FakeGpu gpu;
    SmallScene s = full_scene();
    {
        const std::unique_ptr<Device> device = gpu.make();
        EXPECT_EQ(device->name(), "hiprt (a recording, HIPRT API 3001)");
        Pass pass;
        pass.sample_count = 5;
        Film film = render(*device, s, pass);
        for (int y = 0; y < film.height(); ++y)
            for (int x = 0; x < film.width(); ++x) {
                EXPECT_EQ(film.samples(x, y), 5u);
                EXPECT_EQ(film.beauty(x, y).r, 5.0f * static_cast<float>(x));
                EXPECT_EQ(film.beauty(x, y).g, 5.0f * static_cast<float>(y));
                EXPECT_EQ(film.beauty(x, y).b, 0.0f + 1 + 2 + 3 + 4);
                EXPECT_EQ(film.beauty(x, y, 1).alpha, 0.0f);
            }
        const DeviceStatistics statistics = device->statistics();
        EXPECT_EQ(statistics.pixel_samples, 24u * 20u * 5u);
        EXPECT_EQ(statistics.rays, 3u * 24u * 20u * 5u);
        EXPECT_EQ(statistics.instances, 5u);
        EXPECT_EQ(statistics.moving_instances, 1u);
        EXPECT_EQ(statistics.structures, (StructureCounts{3, 0, 0}));  // the square, the sphere, all instances
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(HiprtDevice, HalvesLayersWeightsAndActivePixels) {
    FakeGpu gpu;
    SmallScene s = full_scene();
    {
        const std::unique_ptr<Device> device = gpu.make();
        std::vector<std::uint8_t> active(24 * 20, 0);
        active[3 * 24 + 7] = 1;
        FilmLayers layers;
        layers.depth = layers.albedo = layers.motion = true;
        Pass pass;
        pass.sample_count = 2;
        pass.half = 1;
        pass.active = active.data();
        Film film = render(*device, s, pass, layers, true);
        EXPECT_EQ(film.samples(7, 3, 1), 2u);
        EXPECT_EQ(film.weight(7, 3, 1), 1.0f);
        EXPECT_EQ(film.surface(7, 3).depth, 4);
        EXPECT_EQ(film.surface(7, 3).albedo[1], 6);
        EXPECT_EQ(film.surface(7, 3).normal[2], 0) << "a layer that nobody wants";
        EXPECT_EQ(film.surface(7, 3).depth_weight, 10);
        EXPECT_EQ(film.surface(7, 3).motion[1], 12);
        EXPECT_EQ(film.samples(7, 3, 0), 0u);
        EXPECT_EQ(film.samples(8, 3, 1), 0u);
        EXPECT_EQ(device->statistics().pixel_samples, 2u);
        // A second pass adds to the first, though the film was at home in between, and now is elsewhere.
        pass.first_sample = 2;
        device->render(pass, film);
        device->read_film(film);
        EXPECT_EQ(film.samples(7, 3, 1), 4u);
        EXPECT_EQ(film.beauty(7, 3, 1).b, 0.0f + 1 + 2 + 3);
        EXPECT_EQ(device->statistics().pixel_samples, 4u);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(HiprtDevice, HiprtGetsTheFramesOfTheSnapshot) {
    FakeGpu gpu;
    SmallScene s;
    const unsigned square = s.add_mesh(unit_square());
    for (int i = 0; i < 3; ++i) s.add_instance(square, material({1, 1, 1}, 0, 1), place({i, 0, 0}), false);
    // The third moves, by frames in HIPRT's own layout; the second is hidden.
    MotionFrames& motion = s.snapshot.motion;
    motion = {};
    for (unsigned i = 0; i < 3; ++i) {
        motion.headers.push_back({static_cast<unsigned>(motion.srt.size()), i == 2 ? 3u : 1u});
        motion.types.push_back(FrameType::srt);
        motion.linear.push_back(0);
        for (unsigned k = 0; k < motion.headers[i].frame_count; ++k)
            motion.srt.push_back({{0, 1, 0},
                                  0.1f * static_cast<float>(k),
                                  {1, 2, 3},
                                  {static_cast<float>(i), 0, 0},
                                  0.5f * static_cast<float>(k),
                                  0});
    }
    s.snapshot.instances.edit(1).mask = 0;
    s.snapshot.instances.edit(2).mask = 0x10;
    const std::unique_ptr<Device> device = gpu.make();
    render(*device, s);
    ASSERT_EQ(gpu.hiprt.scenes.size(), 1u);
    const FakeHiprt::SceneRecord& scene = gpu.hiprt.scene();
    ASSERT_EQ(scene.headers.size(), 2u);
    EXPECT_EQ(scene.headers[0].frame_count, 1u);
    EXPECT_EQ(scene.headers[1].frame_count, 3u);
    EXPECT_THAT(scene.masks, ::testing::ElementsAre(~0u, 0x10u));
    for (unsigned k = 0; k < 3; ++k)
        EXPECT_EQ(
            std::memcmp(&scene.srt[scene.headers[1].first_frame + k], &motion.srt[2 + k], sizeof(kernels::FrameSrt)),
            0);
    EXPECT_TRUE(scene.matrices.empty());
    EXPECT_EQ(gpu.launches.back().instance_of[1], 2u);
    // The kernels get the same motion, as keys.
    const kernels::InstanceMotion& moving = gpu.launches.back().scene.motions[2];
    EXPECT_EQ(moving.kind, kernels::InstanceMotion::Kind::keys);
    EXPECT_EQ(moving.count, 3u);
    EXPECT_EQ(gpu.launches.back().scene.keys[moving.first + 1].scale[1], 2.0f);
}

/// A square that moves by frames in HIPRT's own layout.
void add_srt_motion(SmallScene& s, const std::vector<kernels::FrameSrt>& frames) {
    s.add_instance(0, material({1, 1, 1}, 0, 1), place({0, 0, 0}), false);
    MotionFrames& motion = s.snapshot.motion;
    const std::size_t i = motion.headers.size() - 1;
    motion.types.edit(i) = FrameType::srt;
    motion.headers.edit(i) = {static_cast<unsigned>(motion.srt.size()), static_cast<unsigned>(frames.size())};
    for (const kernels::FrameSrt& frame : frames) motion.srt.push_back(frame);
}

TEST(HiprtDevice, BesideWhatIsShearedFramesBecomeMatrices) {
    FakeGpu gpu;
    SmallScene s;
    s.add_mesh(unit_square());
    glm::dmat4 shear(1);
    shear[1][0] = 0.5;
    s.add_instance(0, material({1, 1, 1}, 0, 1), shear, false);
    add_srt_motion(s, {{{0, 1, 0}, 0, {1, 2, 3}, {4, 5, 6}, 0, 0}, {{0, 1, 0}, 0.15f, {1, 2, 3}, {4, 5, 7}, 1, 0}});
    {
        const std::unique_ptr<Device> device = gpu.make();
        render(*device, s);
        const FakeHiprt::SceneRecord& scene = gpu.hiprt.scene();
        ASSERT_EQ(scene.matrices.size(), 3u);
        EXPECT_EQ(scene.matrices[1].matrix[1][1], 2.0f);
        EXPECT_EQ(scene.matrices[2].matrix[2][3], 7.0f);
        EXPECT_EQ(scene.matrices[2].time, 1.0f);
        EXPECT_NEAR(scene.matrices[2].matrix[0][2], 3 * std::sin(0.15), 1e-6);  // +z turns to +x
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(HiprtDevice, MatricesForAllWhereOneIsSheared) {
    FakeGpu gpu;
    SmallScene s = full_scene();
    const std::unique_ptr<Device> device = gpu.make();
    render(*device, s);
    EXPECT_TRUE(gpu.hiprt.scene().srt.empty());
    EXPECT_EQ(gpu.hiprt.scene().matrices.size(), 7u);
    EXPECT_EQ(gpu.hiprt.scene().matrices[3].matrix[0][1], 0.5f);
}

TEST(HiprtDevice, CutOutMeshesAreFilteredAndHaveNoSplits) {
    FakeGpu gpu;
    SmallScene s = full_scene();
    const std::unique_ptr<Device> device = gpu.make();
    render(*device, s);
    int filtered = 0;
    for (const auto& [handle, geometry] : gpu.hiprt.geometries) {
        const bool asks = geometry.input.geometry_type == 0;
        filtered += asks ? 1 : 0;
        EXPECT_EQ(geometry.options.flags, asks ? 6u : 2u);  // high quality, without splits where it is filtered
        EXPECT_TRUE(geometry.compacted);
    }
    EXPECT_EQ(filtered, 1);
    EXPECT_NE(gpu.launches.back().functions, nullptr);
}

TEST(HiprtDevice, WhatDoesNotChangeIsKept) {
    FakeGpu gpu;
    SmallScene s = full_scene();
    {
        const std::unique_ptr<Device> device = gpu.make();
        render(*device, s);
        const std::size_t geometries = gpu.runtime->count("create_geometries");
        device->set_frame(s.snapshot);
        EXPECT_EQ(gpu.runtime->count("build_scene"), 1u);
        EXPECT_EQ(device->statistics().structures, (StructureCounts{0, 0, 3}));
        s.snapshot.geometry_key = 2;
        device->set_frame(s.snapshot);
        EXPECT_EQ(gpu.runtime->count("build_scene"), 2u);
        EXPECT_EQ(gpu.runtime->count("create_geometries"), geometries);
        EXPECT_EQ(device->statistics().structures, (StructureCounts{1, 0, 2}));
        EXPECT_EQ(gpu.hiprt.scenes.size(), 1u);
        s.snapshot.render_origin = {1024, 0, 0};
        device->set_frame(s.snapshot);
        EXPECT_EQ(gpu.runtime->count("build_scene"), 3u);
        s.snapshot.settings.cull_backfaces = true;  // now rays ask at every hit on a single-sided surface
        device->set_frame(s.snapshot);
        EXPECT_EQ(gpu.runtime->count("build_scene"), 4u);
        EXPECT_EQ(gpu.hiprt.geometries.size(), 3u);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(HiprtDevice, MayBeUsedAndDestroyedByOtherThreads) {
    FakeGpu gpu;
    SmallScene s = full_scene();
    std::unique_ptr<Device> device = gpu.make();
    std::thread([&] { device->load(s.scene, &s.environment); }).join();
    std::thread([&] { device->set_frame(s.snapshot); }).join();
    Film film(24, 20, {});
    film.clear();
    std::thread([&] { device->render({}, film); }).join();
    std::thread([&] { device->read_film(film); }).join();
    EXPECT_EQ(film.samples(3, 3), 1u);
    std::thread([&] { device.reset(); }).join();
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(HiprtDevice, GpusThatAreTooOldAreRefusedByName) {
    FakeGpu gpu;
    gpu.runtime->compute = 61;
    try {
        gpu.make();
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(
            error.diagnostics()[0].found,
            "the GPU a recording has compute capability 6.1, and 7.5 is the least that our kernels are compiled for");
    }
    gpu.runtime->compute = 75;
    EXPECT_TRUE(gpu.make());
    gpu.runtime->vendor = GpuVendor::amd;
    gpu.runtime->compute = 0;
    EXPECT_TRUE(gpu.make());
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(HiprtDevice, WhatALaunchIsTold) {
    FakeGpu gpu;
    SmallScene s = full_scene();
    s.snapshot.settings.max_bounces = s.snapshot.settings.max_glossy = 1000;
    s.snapshot.settings.seed = 7;
    s.snapshot.weight = 0.25;
    const std::unique_ptr<Device> device = gpu.make();
    Pass pass;
    pass.half = 1;
    pass.first_sample = 8;
    pass.sample_count = 4;
    pass.dealt_share = 0.5;
    render(*device, s, pass);
    const kernels::LaunchParams& launch = gpu.launches.back();
    EXPECT_EQ(launch.scene.settings.max_bounces, 250);  // paths count theirs in eight bits
    EXPECT_EQ(launch.scene.settings.max_glossy, 250);
    EXPECT_EQ(launch.seed, kernels::seed_of_half(7, 1));
    EXPECT_EQ(launch.shutter->weight, 0.5f);  // a quarter of the light, half of the samples
    EXPECT_EQ(launch.first_sample, 8);
    EXPECT_EQ(launch.sample_count, 4);
    EXPECT_FALSE(launch.centred);
    // What was counted is of the frame at hand.
    EXPECT_EQ(device->statistics().pixel_samples, 24u * 20u * 4u);
    device->set_frame(s.snapshot);
    EXPECT_EQ(device->statistics().pixel_samples, 0u);
    s.snapshot.settings.integrator = kernels::IntegratorKind::direct;
    device->set_frame(s.snapshot);
    Film film(24, 20, {});
    film.clear();
    pass.total_samples = 1;
    pass.dealt_share = 0;
    device->render(pass, film);
    EXPECT_TRUE(gpu.launches.back().centred);
    EXPECT_EQ(gpu.launches.back().shutter->weight, 1.0f);
}

TEST(HiprtDevice, NothingToSee) {
    FakeGpu gpu;
    SmallScene s;
    {
        const std::unique_ptr<Device> device = gpu.make();
        render(*device, s);
        EXPECT_EQ(gpu.launches.back().top, nullptr);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(HiprtDevice, LowBuildsAreHiprtsFastest) {
    FakeGpu gpu;
    SmallScene s;
    s.add_instance(s.add_mesh(unit_square()), material({1, 1, 1}, 0, 1), place({0, 0, 0}), false);
    {
        const std::unique_ptr<Device> device = gpu.make();
        device->load(s.scene, nullptr, {BuildQuality::low, BuildSettings::Robust::no});
        device->set_frame(s.snapshot);
        ASSERT_EQ(gpu.hiprt.geometries.size(), 1u);
        EXPECT_EQ(gpu.hiprt.geometries.begin()->second.options.flags & hiprt::build_flag::kQualityMask, hiprt::build_flag::kFast);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(HiprtDevice, RobustRaysAreRefusedByName) {
    FakeGpu gpu;
    SmallScene s;
    {
        const std::unique_ptr<Device> device = gpu.make();
        try {
            device->load(s.scene, nullptr, {BuildQuality::medium, BuildSettings::Robust::required});
            FAIL();
        } catch (const InputError& error) {
            EXPECT_EQ(error.diagnostics()[0].text(),
                      "error: --device hiprt: render.robust is true, but HIPRT tests triangles one by one, and rays slip between two "
                      "that share an edge\n  use robust: false, or --device cpu");
        }
        // Left to Kadr, it is a wish.
        device->load(s.scene, nullptr, {BuildQuality::medium, BuildSettings::Robust::wanted});
    }
    EXPECT_EQ(gpu.complaints(), "");
}

/// HIPRT traces moving frames that are sheared wrongly: such an instance becomes a mesh that bends, in a still place.
TEST(HiprtDevice, ShearedMotionGoesByOurOwnMatrices) {
    FakeGpu gpu;
    SmallScene s;
    glm::dmat4 shear(1), later = turned(10, {1, 0, 0});
    shear[1][0] = 0.5;
    const unsigned square = s.add_mesh(unit_square());
    s.add_instance(square, material({1, 1, 1}, 0, 1), place({-1, 0, 0}), false);
    s.add_moving(square, material({1, 1, 1}, 0, 1), {shear, later * shear});
    {
        const std::unique_ptr<Device> device = gpu.make();
        render(*device, s);
        EXPECT_EQ(device->statistics().bending, (BendingCounts{1, 1, 1, device->statistics().bending.keys}));
        EXPECT_GE(device->statistics().bending.keys, 3u) << "a turn of ten degrees is no straight way";
        EXPECT_EQ(device->statistics().moving_instances, 0u);
        const kernels::SceneView& view = gpu.launches.back().scene;
        EXPECT_EQ(view.motions[1].kind, kernels::InstanceMotion::Kind::still);
        const kernels::Geometry& bent = view.geometries[view.instances[1].geometry];
        ASSERT_EQ(bent.key_count, device->statistics().bending.keys);
        for (const double time : {0.0, 1.0}) {  // the last corner is where its matrix puts it
            const kernels::Vec3f at = bent.vertices[(time == 0 ? 0 : bent.key_count - 1) * bent.vertex_count + 2].position;
            const glm::dvec3 wanted(((time == 0 ? glm::dmat4(1) : later) * shear) * glm::dvec4(1, 1, 0, 1));
            const kernels::Affine& place = view.matrices[view.motions[1].first];
            EXPECT_NEAR(place.m[0][0] * at.x + place.m[0][3], wanted.x, 1e-6);
            EXPECT_NEAR(place.m[2][2] * at.z + place.m[2][3], wanted.z, 1e-6);
        }
        // In the same place the next time: kept.
        s.snapshot.geometry_key = 2;
        device->set_frame(s.snapshot);
        EXPECT_EQ(device->statistics().structures, (StructureCounts{1, 0, 2}));
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(HiprtDevice, MotionFramesThatHiprtTracesOtherwiseAreRefusedByName) {
    FakeGpu gpu;
    SmallScene s;
    s.add_moving(s.add_mesh(unit_square()), material({1, 1, 1}, 0, 1), {place({0, 0, 0}), place({1, 0, 0})});
    const auto refusal = [&] {
        const std::unique_ptr<Device> device = gpu.make();
        device->load(s.scene, nullptr);
        try {
            device->set_frame(s.snapshot);
        } catch (const InputError& error) {
            return error.diagnostics()[0].text();
        }
        return std::string();
    };
    EXPECT_EQ(refusal(), "");
    s.snapshot.motion.mixes_matrices = true;
    EXPECT_EQ(refusal(), "error: --device hiprt: render.motion_frames.mix is matrix, and HIPRT mixes no matrices\n  use `mix: srt`, or --device cpu");
    s.snapshot.motion.mixes_matrices = false;
    s.snapshot.motion.widest_step_rad = 0.35;
    EXPECT_EQ(refusal(),
              "error: --device hiprt: render.motion_frames lets something turn by 20 degrees from one frame to the next\n"
              "  HIPRT's boxes hold what turns by 10 degrees; take more frames, `motion_frames: auto`, or --device cpu");
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(HiprtDevice, LaunchesAreShortAndCoverEverySampleOnce) {
    FakeGpu gpu;
    gpu.seconds_a_sample = 2e-6;  // 0.05 s are 25,000 samples: 10 launches for 512 x 512 pixels
    SmallScene s;
    s.snapshot.settings.width = s.snapshot.settings.height = 512;
    const std::unique_ptr<Device> device = gpu.make();
    Pass pass;
    pass.sample_count = 3;
    Film film = render(*device, s, pass);
    for (int y = 0; y < 512; y += 7)
        for (int x = 0; x < 512; ++x) EXPECT_EQ(film.beauty(x, y).b, 0.0f + 1 + 2);
    EXPECT_EQ(device->statistics().pixel_samples, 512u * 512u * 3u);
    // Before anything is known a launch takes 65,536 samples, two of them at a time.
    for (std::size_t i = 2; i < gpu.runtime->launch_s.size(); ++i) EXPECT_LE(gpu.runtime->launch_s[i], 0.1) << i;
    EXPECT_GT(gpu.runtime->launch_s.size(), 25u);
    EXPECT_LT(gpu.runtime->launch_s.size(), 60u);
}

TEST(HiprtDevice, CancellingWaitsForTwoLaunchesAtMost) {
    FakeGpu gpu;
    gpu.seconds_a_sample = 1e-5;
    SmallScene s;
    s.snapshot.settings.width = s.snapshot.settings.height = 256;
    {
        const std::unique_ptr<Device> device = gpu.make();
        std::atomic<bool> cancel{false};
        std::size_t launched = 0;
        Pass pass;
        pass.sample_count = 64;
        pass.cancel = &cancel;
        pass.progress = [&](double) {
            launched = gpu.runtime->count("launch");
            cancel = launched == 5;
        };
        Film film = render(*device, s, pass);
        EXPECT_EQ(launched, 5u);
        EXPECT_EQ(gpu.runtime->count("launch"), 5u);
        // The next film starts from nothing.
        cancel = false;
        pass.progress = {};
        film.clear();
        device->begin_film(film);
        device->render(pass, film);
        device->read_film(film);
        EXPECT_EQ(film.samples(0, 0), 64u);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(HiprtDevice, WhicheverCallFailsTheErrorIsClearAndEverythingIsFreed) {
    FakeGpu right;
    SmallScene s = full_scene();
    FilmLayers layers;
    layers.depth = true;
    render(*right.make(), s, {}, layers, true);
    const std::vector<std::string> calls = right.runtime->calls;
    ASSERT_EQ(right.complaints(), "");
    ASSERT_GT(calls.size(), 100u);
    for (std::size_t n = 0; n < calls.size(); ++n) {
        FakeGpu gpu;
        gpu.runtime->failing_call = static_cast<int>(n);
        ::testing::internal::CaptureStderr();
        std::string message;
        try {
            render(*gpu.make(), s, {}, layers, true);
        } catch (const RenderError& error) {
            message = error.what();
        }
        message += ::testing::internal::GetCapturedStderr();
        // What looks like a full memory is met by structures of lower quality, or larger ones: no error, and a right
        // frame.
        const bool mended =
            calls[n] == "create_geometries" || calls[n] == "create_scene" || calls[n] == "compact_geometries";
        EXPECT_EQ(message.empty(), mended) << n << ": " << calls[n];
        const bool says_why = message.find("a failure that the test asked for") != std::string::npos ||
                              message.find("HIPRT reports") != std::string::npos;
        EXPECT_EQ(message.find("cannot ") != std::string::npos && says_why, !mended)
            << n << ": " << calls[n] << ": " << message;
        EXPECT_EQ(gpu.complaints(), "") << n << ": " << calls[n];
    }
}

TEST(HiprtDevice, AfterAFailedFrameTheNextOneIsRight) {
    SmallScene s = full_scene();
    FakeGpu right;
    render(*right.make(), s);
    std::size_t first = 0, last = 0;  // calls of the frame
    for (std::size_t i = 0; i < right.runtime->calls.size(); ++i) {
        if (right.runtime->calls[i] == "geometries_temporary_size" && first == 0) first = i;
        if (right.runtime->calls[i] == "build_scene") last = i;
    }
    for (std::size_t n = first; n <= last; ++n) {
        FakeGpu gpu;
        gpu.runtime->failing_call = static_cast<int>(n);
        {
            const std::unique_ptr<Device> device = gpu.make();
            s.snapshot.geometry_key = 1;
            device->load(s.scene, &s.environment);
            ::testing::internal::CaptureStderr();
            bool failed = false;
            try {
                device->set_frame(s.snapshot);
            } catch (const RenderError&) {
                failed = true;
            }
            ::testing::internal::GetCapturedStderr();
            if (failed) device->set_frame(s.snapshot);
            Film film(24, 20, {});
            film.clear();
            device->begin_film(film);
            device->render({}, film);
            device->read_film(film);
            EXPECT_EQ(film.samples(3, 3), 1u);
        }
        EXPECT_EQ(gpu.complaints(), "") << n << ": " << right.runtime->calls[n];
    }
}

TEST(HiprtDevice, TheFrameBeforeAFailedOneIsMadeAnew) {
    SmallScene s = full_scene();
    FakeGpu gpu;
    {
        const std::unique_ptr<Device> device = gpu.make();
        render(*device, s);
        SceneSnapshot failing = s.snapshot;
        failing.geometry_key = 2;
        gpu.runtime->failing_call = static_cast<int>(gpu.runtime->calls.size()) + 3;
        EXPECT_THROW(device->set_frame(failing), RenderError);
        device->set_frame(s.snapshot);  // the same key as the last frame that was made
        Film film(24, 20, {});
        film.clear();
        device->render({}, film);
        EXPECT_NE(gpu.launches.back().top, nullptr);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(HiprtDevice, LittleMemoryIsMetBySmallerTilesThenLowerQualityThenFigures) {
    SmallScene s = full_scene();
    s.snapshot.settings.width = 640;
    s.snapshot.settings.height = 480;
    FakeGpu plenty;
    {
        const std::unique_ptr<Device> device = plenty.make();
        render(*device, s);
    }
    const std::size_t most = plenty.runtime->most_in_use();
    ASSERT_EQ(plenty.runtime->count("launch"), 3u);
    bool tiles = false, figures = false;
    for (std::size_t capacity = most; capacity > 2000; capacity = capacity * 9 / 10) {
        FakeGpu gpu;
        gpu.runtime->capacity = capacity;
        std::string message;
        try {
            const std::unique_ptr<Device> device = gpu.make();
            Film film = render(*device, s);
            EXPECT_EQ(film.samples(639, 479), 1u);
            EXPECT_EQ(film.beauty(639, 479).r, 639.0f);
            EXPECT_EQ(device->statistics().pixel_samples, 640u * 480u);
            // Where all of the film does not fit, the sums of both halves, not much of it goes up and comes back in parts.
            tiles = tiles || gpu.runtime->count("launch") > 3;
        } catch (const RenderError& error) {
            message = error.what();
            EXPECT_THAT(message, ::testing::AnyOf(HasSubstr("memory"), HasSubstr("HIPRT's function table")));
            figures = figures || message.find("are free") != std::string::npos;
        }
        EXPECT_EQ(gpu.complaints(), "") << capacity << ": " << message;
    }
    EXPECT_TRUE(tiles);
    EXPECT_TRUE(figures);
}

TEST(HiprtDevice, StructuresOfLowerQualityWhereHighOnesDoNotFit) {
    SmallScene s = full_scene();
    FakeGpu gpu;
    gpu.hiprt.bytes_per_triangle_of = {64, 128, 4096};  // fast, balanced, high
    gpu.runtime->capacity = 400000;
    {
        const std::unique_ptr<Device> device = gpu.make();
        render(*device, s);
        for (const auto& [handle, geometry] : gpu.hiprt.geometries)
            EXPECT_EQ(geometry.options.flags & hiprt::build_flag::kQualityMask, hiprt::build_flag::kBalanced);
    }
    EXPECT_EQ(gpu.complaints(), "");
    // Once memory was short, all of it is built at the quality that fits, what was there before included.
    FakeGpu later;
    later.hiprt.bytes_per_triangle_of = {64, 128, 4096};
    {
        SmallScene growing;
        growing.add_instance(growing.add_mesh(unit_square()), material({1, 1, 1}, 0, 1), place({0, 0, 0}), false);
        const unsigned sphere = growing.add_mesh(unit_sphere(8));
        const std::unique_ptr<Device> device = later.make();
        render(*device, growing);
        EXPECT_EQ(later.hiprt.geometries.begin()->second.options.flags, hiprt::build_flag::kHighQuality);
        growing.add_instance(sphere, material({1, 1, 1}, 0, 1), place({0, 0, 0}), false);
        growing.snapshot.geometry_key = 2;
        later.runtime->capacity = later.runtime->in_use() + 100000;
        device->set_frame(growing.snapshot);
        EXPECT_EQ(later.hiprt.geometries.size(), 2u);
        for (const auto& [handle, geometry] : later.hiprt.geometries)
            EXPECT_EQ(geometry.options.flags, hiprt::build_flag::kBalanced);
    }
    EXPECT_EQ(later.complaints(), "");
    FakeGpu tiny;
    {
        const std::unique_ptr<Device> device = tiny.make();
        device->load(s.scene, nullptr);
        tiny.runtime->capacity = tiny.runtime->in_use() + 30000;  // the sphere's structure alone takes 16 kB
        try {
            device->set_frame(s.snapshot);
            FAIL();
        } catch (const RenderError& error) {
            EXPECT_THAT(error.what(), AllOf(HasSubstr("the memory of the GPU does not hold the frame: cannot "),
                                            HasSubstr("vertices "), HasSubstr(" are free"),
                                            HasSubstr("; structures were built at lower quality")));
        }
    }
    EXPECT_EQ(tiny.complaints(), "");
}

}  // namespace
}  // namespace kadr::test
