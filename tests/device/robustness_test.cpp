// Threads, widths, extremes of scale and place, rays that are not finite.
#include <gtest/gtest.h>

#include "device/small_scene.h"

namespace kadr::test {
namespace {

SmallScene lit_sphere(glm::dvec3 at, double radius, bool fixed) {
    SmallScene s;
    s.snapshot.render_origin = at;
    s.camera(at + glm::dvec3(0, 0, 5 * radius), at, 0.25);
    s.add_instance(s.add_mesh(unit_sphere()), material({0.8f, 0.8f, 0.8f}, 0, 0.5f), place(at, radius), fixed);
    kernels::Light sun;
    sun.kind = kernels::LightKind::directional;
    sun.radiance = {2, 2, 2};
    sun.direction = {-0.3f, -0.5f, -0.8124f};
    s.add_light(sun);
    s.snapshot.environment.radiance = {0.2f, 0.3f, 0.4f};
    return s;
}

TEST(Determinism, ThreadsDoNotChangePixels) {
    SmallScene s = lit_sphere({0, 0, 0}, 1, true);
    s.snapshot.settings.width = 70;
    s.snapshot.settings.height = 50;
    const Image one = s.render(9, 1).image;
    for (const int threads : {2, 7}) EXPECT_EQ(s.render(9, threads).image.pixels, one.pixels) << threads << " threads";
}

TEST(Determinism, PassesDoNotChangePixels) {
    SmallScene s = lit_sphere({0, 0, 0}, 1, true);
    const auto render = [&](std::vector<int> passes) {
        DeviceRequest request;
        request.name = "cpu";
        const DeviceChoice choice = make_device(request);
        choice.device->load(s.scene, nullptr);
        choice.device->set_frame(s.snapshot);
        Film film(32, 32, {});
        int first = 0;
        for (int n : passes) {
            Pass pass;
            pass.first_sample = first;
            pass.sample_count = n;
            pass.total_samples = 16;
            choice.device->render(pass, film);
            first += n;
        }
        return film.develop().pixels;
    };
    EXPECT_EQ(render({16}), render({4, 12}));
}

TEST(Determinism, OneLaneAndEightAgree) {
    if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has no AVX2";
    SmallScene s = lit_sphere({0, 0, 0}, 1, true);
    const Image narrow = s.render(16, 2, 1).image, wide = s.render(16, 2, 8).image;
    // The kernels agree to the last bit; Embree's packets and single rays may round a hit differently, and a path that
    // takes another turn there changes its pixel.
    int differing = 0;
    for (std::size_t i = 0; i < wide.pixels.size(); ++i)
        differing += std::abs(narrow.pixels[i] - wide.pixels[i]) > 1e-3f * (1 + std::abs(wide.pixels[i]));
    EXPECT_LE(differing, static_cast<int>(wide.pixels.size() / 50));
}

/// The sphere must look the same wherever it is and however large: no false shadow, no leak.
TEST(Precision, PlaceAndScaleDoNotMatter) {
    const double reference = lit_sphere({0, 0, 0}, 1, true).render(64).mean();
    for (const bool fixed : {true, false})
        for (const double distance : {1e3, 1e5, 1e7}) {
            const glm::dvec3 at = distance * glm::dvec3(0.6, -0.5, 0.62449979984);
            EXPECT_NEAR(lit_sphere(at, 1, fixed).render(64).mean() / reference, 1.0, 0.002)
                << "at " << distance << " m, fixed " << fixed;
        }
    for (const bool fixed : {true, false})
        for (const double radius : {1e-6, 1e6})
            EXPECT_NEAR(lit_sphere({0, 0, 0}, radius, fixed).render(64).mean() / reference, 1.0, 0.002)
                << "radius " << radius << ", fixed " << fixed;
}

TEST(Precision, TinyMeshFarFromTheOriginKeepsItsOwnCoordinates) {
    // A floor of 0.2 mm under a roof of the same size, 0.01 mm above it, one metre from the render origin. There a ray
    // offset of 256 units in the last place is 0.03 mm: flattened, shadow rays would start above the roof. The roof
    // faces the floor, so culling hides it from the camera and not from the floor.
    SmallScene s;
    s.snapshot.settings.integrator = kernels::IntegratorKind::direct;
    s.snapshot.settings.cull_backfaces = true;
    s.camera({0, 0, 1 + 5e-4}, {0, 0, 1}, 0.1);
    const unsigned square = s.add_mesh(unit_square());
    s.add_instance(square, material({0.8f, 0.8f, 0.8f}, 0, 1), place({0, 0, 1}, 1e-4));
    kernels::Light sun;
    sun.kind = kernels::LightKind::directional;
    sun.radiance = {1, 1, 1};
    sun.direction = {0, 0, -1};
    s.add_light(sun);
    EXPECT_GT(s.render(1).mean(), 0.2);
    s.add_instance(square, material({0.8f, 0.8f, 0.8f}, 0, 1),
                   place({0, 0, 1 + 1e-5}, 1e-4) * glm::rotate(glm::dmat4(1), kPi, glm::dvec3(1, 0, 0)));
    EXPECT_EQ(s.render(1).mean(), 0);
}

/// A ball on an arm that turns by 4° while the shutter is open, in light from everywhere: a path leaves it after one
/// hit, so it is as bright as one that stands still. Where Embree's slerp turns otherwise than ours, rays would begin
/// below the surface, meet it again and lose a fifth of their light.
TEST(Precision, WhatTurnsDoesNotHitItself) {
    const auto light_lost = [](double degrees) {
        SmallScene s;
        GeometryData ball = unit_sphere(32);
        for (kernels::Vec3f& p : ball.positions) p = {1 + 0.05f * p.x, 0.05f * p.y, 0.05f * p.z};
        const auto turned = [](double angle) { return glm::rotate(glm::dmat4(1), glm::radians(angle), glm::dvec3(0, 0, 1)); };
        s.add_moving(s.add_mesh(ball), material({0.8f, 0.8f, 0.8f}, 0, 1), {turned(-degrees / 2), turned(degrees / 2)}, false);
        s.camera({1, 0, 1}, {1, 0, 0}, 0.2);
        s.snapshot.environment.radiance = {1, 1, 1};
        return 1 - s.render(64).mean();
    };
    const double still = light_lost(0);
    // One hit takes a fifth of the light, two take 0.36. Three per cent are the noise of the ball's outline at 64 samples.
    for (const double degrees : {3.65, 4.0, 5.0, 8.0}) EXPECT_NEAR(light_lost(degrees) / still, 1, 0.03) << degrees;
}

TEST(Robustness, RaysThatAreNotFiniteAreDroppedAndCounted) {
    SmallScene s = lit_sphere({0, 0, 0}, 1, true);
    s.snapshot.camera_keys[0].position.x = NAN;
    const auto result = s.render(2);
    EXPECT_EQ(result.statistics.dropped_samples, 2u * 32 * 32);
    EXPECT_EQ(result.mean(), 0);
}

/// Debian's Embree ends the program on them.
TEST(Robustness, RaysBeyondWhatEmbreeTakesAreDroppedAndCounted) {
    SmallScene s = lit_sphere({0, 0, 0}, 1, true);
    s.snapshot.camera_keys[0].position.x = 1e19f;
    EXPECT_EQ(s.render(2).statistics.dropped_samples, 2u * 32 * 32);
}

TEST(Robustness, EmptySceneOnePixelNoLights) {
    SmallScene s;
    s.snapshot.settings.width = s.snapshot.settings.height = 1;
    EXPECT_EQ(s.render(1).mean(), 0);
    s.snapshot.environment.radiance = {0.25f, 0.5f, 0.75f};
    EXPECT_EQ(s.render(3).image.at(0, 0, 2), 0.75f);
}

TEST(Robustness, CullingAndMirrorsKeepTheFront) {
    for (const bool fixed : {true, false})
        for (const double mirror : {1.0, -1.0}) {
            SmallScene s;
            s.snapshot.settings.cull_backfaces = true;
            kernels::Material m = material({0, 0, 0}, 0, 1);
            m.emission = {1, 1, 1};
            s.add_instance(s.add_mesh(unit_square()), m, glm::scale(glm::dmat4(1), glm::dvec3(mirror, 1, 1)), fixed);
            s.camera({0, 0, 5}, {0, 0, 0}, 0.1);
            EXPECT_NEAR(s.render(4).mean(), 1, 1e-3) << "front, mirror " << mirror << ", fixed " << fixed;
            s.camera({0, 0, -5}, {0, 0, 0}, 0.1);
            EXPECT_NEAR(s.render(4).mean(), 0, 1e-3) << "back, mirror " << mirror << ", fixed " << fixed;
        }
}

TEST(Device, NamesAndRefusals) {
    DeviceRequest request;
    for (const char* name : {"gpu", "hiprt:", "hiprt:first", "hiprt:-1", "hiprt:0,1"}) {
        request.name = name;
        EXPECT_THROW(make_device(request), InputError) << name;
    }
    for (const auto& [name, text] : {std::pair{"hiprt:0,0", "error: --device hiprt:0,0: GPU 0 is there twice\n  name every GPU once: one renders one frame at a time"},
                                     {"hiprt:0,", "error: --device is 'hiprt:0,'\n  expected the number of a GPU, as in hiprt:0, or several, as in hiprt:0,1; see kadr devices"},
                                     {"hiprt:1,x", "error: --device is 'hiprt:1,x'\n  expected the number of a GPU, as in hiprt:0, or several, as in hiprt:0,1; see kadr devices"}}) {
        request.name = name;
        try {
            make_devices(request);
            FAIL() << name;
        } catch (const InputError& error) {
            EXPECT_EQ(error.diagnostics()[0].text(), text);
        }
    }
    request.name = "hiprt:0,1";
    try {
        make_device(request);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.diagnostics()[0].text(), "error: --device hiprt:0,1: only kadr render deals out frames to several GPUs\n  name one, as in hiprt:0");
    }
    request.name = "cpu";
    EXPECT_EQ(make_devices(request).size(), 1u);
    EXPECT_EQ(list_devices().size(), 2u);
}

TEST(Device, WithoutGpuTheReasonIsOneSentence) {
    const DeviceReport gpu = list_devices()[1];
    ASSERT_EQ(gpu.name, "hiprt");
    if (gpu.usable) GTEST_SKIP() << "there is a GPU here";
    DeviceRequest request;
    request.name = "hiprt";
    try {
        make_device(request);
        FAIL() << "there is no GPU";
    } catch (const InputError& error) {
        EXPECT_EQ(error.diagnostics()[0].text(), "error: --device hiprt: " + gpu.reason +
                                                     "\n  use --device cpu, or --device auto, which takes the best that works");
    }
    request.name = "auto";
    EXPECT_EQ(make_device(request).why, gpu.reason);
}

TEST(Layers, DepthNormalAlbedo) {
    SmallScene s;
    s.camera({0, 0, 5}, {0, 0, 0}, 0.3);
    s.add_instance(s.add_mesh(unit_square()), material({0.2f, 0.4f, 0.6f}, 0, 1), glm::dmat4(1));
    FilmLayers layers;
    layers.depth = layers.normal = layers.albedo = true;
    const Image image = s.render(4, 1, 0, layers).image;
    const auto channel = [&](const std::string& name) {
        return static_cast<int>(std::find(image.channels.begin(), image.channels.end(), name) - image.channels.begin());
    };
    EXPECT_NEAR(image.at(16, 16, channel("depth.Z")), 5, 1e-5);
    EXPECT_NEAR(image.at(8, 20, channel("depth.Z")), 5, 1e-5);  // along the view axis, not along the ray
    EXPECT_NEAR(image.at(16, 16, channel("normal.Z")), 1, 1e-6);
    EXPECT_NEAR(image.at(16, 16, channel("albedo.B")), 0.6, 1e-6);
    EXPECT_TRUE(std::isinf(image.at(0, 0, channel("depth.Z"))));
}

}  // namespace
}  // namespace kadr::test
