// The frame to come is copied and built while one renders: nothing that a launch on its way looks at is touched.

#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "device/small_scene.h"
#include "fake_gpu.h"

namespace kadr::test {
namespace {

using ::testing::HasSubstr;

constexpr int kFrames = 6;

/// Frame `n` of a scene in which all that can change does: an instance moves, another appears, a mesh bends, lights,
/// camera and materials change.
struct Changing {
    SmallScene s;
    unsigned square = 0, sphere = 0;

    Changing() {
        s.snapshot.settings.width = 24;
        s.snapshot.settings.height = 16;
        square = s.add_mesh(unit_square());
        sphere = s.add_mesh(unit_sphere(6));
    }
    std::shared_ptr<const SceneSnapshot> frame(int n) const {
        SmallScene f = s;
        f.add_instance(square, material({1, 1, 1}, 0, 1), place({0, 0, 0}), false);
        f.add_instance(square, material({1, 1, 1}, 0, 1), place({n, 0, 0}), false);
        f.snapshot.instances.edit(0).deformed = 0;
        f.add_moving(square, material({0.5f, 1, 1}, 0, 1), {place({0, n, 0}), place({1, n, 0})});
        if (n > 3) f.add_instance(sphere, material({1, 1, 1}, 0, 1), place({0, 0, n}), false);
        auto mesh = std::make_shared<DeformedMesh>();
        mesh->number = 7;
        mesh->version = static_cast<std::uint64_t>(n + 1);
        for (const kernels::Vec3f& p : f.scene.geometries[square].positions)
            mesh->vertices.push_back({{p.x, p.y, 0.1f * static_cast<float>(n)}, {0, 0, 1}, {0, 0}});
        f.snapshot.deformed = {mesh};
        f.snapshot.materials = f.scene.materials;
        f.snapshot.materials[0].emission = {static_cast<float>(n), 0, 0};
        kernels::Light light;
        light.radiance = {1, static_cast<float>(n), 1};
        f.add_light(light);
        f.snapshot.frame_number = n;
        f.snapshot.geometry_key = static_cast<std::uint64_t>(n + 1);
        return std::make_shared<SceneSnapshot>(f.snapshot);
    }
    /// The scene with the materials that its frames speak of.
    Scene scene() const {
        SmallScene f = s;
        for (int i = 0; i < 4; ++i) f.scene.materials.push_back(material({1, 1, 1}, 0, 1));
        return f.scene;
    }
};

/// What a frame's launches looked at, read when they ran.
struct Seen {
    std::vector<float> values;
    bool operator==(const Seen&) const = default;
};

/// A GPU that notes what its launches see of the scene.
struct LookingGpu : FakeGpu {
    std::vector<Seen> seen;
    LookingGpu() {
        runtime->on_launch = [this, checks = runtime->on_launch](const std::string& function,
                                                                 const std::byte* argument) {
            kernels::LaunchParams params;
            std::memcpy(static_cast<void*>(&params), argument, sizeof params);
            seen.push_back(look(params));
            return checks(function, argument);
        };
    }
    Seen look(const kernels::LaunchParams& params) const {
        Seen s;
        const auto scene = hiprt.scenes.find(static_cast<hiprt::Scene>(const_cast<void*>(params.top)));
        if (scene == hiprt.scenes.end()) return s;
        for (const kernels::FrameSrt& frame : scene->second.srt)
            for (const float value : frame.translation) s.values.push_back(value);
        for (const kernels::FrameMatrix& frame : scene->second.matrices) s.values.push_back(frame.matrix[0][3]);
        for (std::size_t i = 0; i < scene->second.instances.size(); ++i) {
            const kernels::Instance& instance = params.scene.instances[params.instance_of[i]];
            const kernels::Geometry& geometry = params.scene.geometries[instance.geometry];
            for (unsigned v = 0; v < geometry.vertex_count; ++v) s.values.push_back(geometry.vertices[v].position.z);
            s.values.push_back(params.scene.materials[instance.material].emission.x);
        }
        s.values.push_back(params.scene.lights.keys[0].radiance.y);
        return s;
    }
};

struct Result {
    std::vector<Seen> seen;
    std::uint64_t staged = 0;
    std::string memory_steps;
    std::string complaints;
};

/// Renders all frames, one after another; the next one is staged when a launch of a frame is on its way.
/// @param before  of a frame, with the device's GPU
Result render(LookingGpu& gpu, bool stages, const std::function<void(LookingGpu&, int)>& before = {}) {
    Changing shot;
    const Scene scene = shot.scene();
    Result result;
    {
        const std::unique_ptr<Device> device = gpu.make();
        device->load(scene, nullptr);
        Film film(24, 16, {});
        std::shared_ptr<const SceneSnapshot> now = shot.frame(0), next;
        for (int n = 0; n < kFrames; ++n, now = next) {
            if (before) before(gpu, n);
            device->set_frame(*now);
            film.clear();
            device->begin_film(film);
            next = shot.frame(n + 1);
            Pass pass;
            pass.sample_count = pass.total_samples = 2;
            pass.idle = [&] {
                if (stages) device->stage(next);
            };
            device->render(pass, film);
            device->read_film(film);
            EXPECT_EQ(film.samples(3, 3), 2u) << n;
            result.staged += device->statistics().staged;
            result.memory_steps = device->statistics().memory_steps;
        }
    }
    result.seen = gpu.seen;
    result.complaints = gpu.complaints();
    return result;
}
Result render(bool stages, const std::function<void(LookingGpu&, int)>& before = {}) {
    LookingGpu gpu;
    return render(gpu, stages, before);
}

TEST(FramesAhead, AreMadeWhileOneRendersAndShowTheSame) {
    const Result one = render(false), two = render(true);
    ASSERT_EQ(one.complaints, "");
    EXPECT_EQ(two.complaints, "");
    EXPECT_EQ(one.staged, 0u);
    EXPECT_EQ(two.staged, static_cast<std::uint64_t>(kFrames - 1));
    ASSERT_EQ(one.seen.size(), static_cast<std::size_t>(kFrames));
    EXPECT_NE(one.seen[1], one.seen[2]);
    EXPECT_EQ(two.seen, one.seen);
    EXPECT_EQ(two.memory_steps, "");
}

TEST(FramesAhead, AFrameOfTheSameSizeIsBuiltWithoutWaitingForLaunches) {
    FakeGpu gpu;
    SmallScene s;
    s.add_moving(s.add_mesh(unit_square()), material({1, 1, 1}, 0, 1), {place({0, 0, 0}), place({1, 0, 0})});
    {
        const std::unique_ptr<Device> device = gpu.make();
        device->load(s.scene, nullptr);
        std::vector<std::shared_ptr<const SceneSnapshot>> frames;
        for (std::uint64_t n = 1; n <= 5; ++n) {
            s.snapshot.geometry_key = n;
            frames.push_back(std::make_shared<SceneSnapshot>(s.snapshot));
        }
        Film film(32, 32, {});
        for (std::size_t n = 0; n + 1 < frames.size(); ++n) {
            device->set_frame(*frames[n]);
            film.clear();
            device->begin_film(film);
            Pass pass;
            pass.total_samples = 1;
            pass.idle = [&] {
                const std::size_t waits = gpu.runtime->count("synchronize_all") + gpu.runtime->count("synchronize");
                device->stage(frames[n + 1]);
                // The first two frames take memory; after that it is there.
                if (n < 2) return;
                EXPECT_EQ(gpu.runtime->count("synchronize_all") + gpu.runtime->count("synchronize"), waits) << n;
            };
            device->render(pass, film);
        }
        EXPECT_EQ(gpu.runtime->count("create_scene"), 2u);
        EXPECT_EQ(gpu.runtime->count("build_scene"), 5u);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(FramesAhead, AreGivenUpWhereMemoryIsShort) {
    const Result plenty = render(false);
    // After the first frame there is only so much room left.
    int dropped = 0, served = 0;
    for (const std::size_t room : {60'000, 20'000, 8'000, 4'000, 2'000, 1'000}) {
        const Result little = render(true, [&](LookingGpu& gpu, int n) {
            if (n == 1) gpu.runtime->capacity = gpu.runtime->in_use() + room;
        });
        EXPECT_EQ(little.complaints, "") << room;
        EXPECT_EQ(little.seen, plenty.seen) << room;
        dropped += little.memory_steps.find("frames are no longer made ahead") != std::string::npos;
        served += little.memory_steps.empty();
    }
    EXPECT_GT(dropped, 0);
    EXPECT_GT(served, 0);
}

TEST(FramesAhead, WhatDoesNotFitIsSaidWhenItIsThatFramesTurn) {
    FakeGpu gpu;
    SmallScene s;
    const unsigned square = s.add_mesh(unit_square());
    s.add_instance(square, material({1, 1, 1}, 0, 1), place({0, 0, 0}), false);
    s.snapshot.geometry_key = 1;
    SmallScene large = s;
    large.add_instance(large.add_mesh(unit_sphere(128)), material({1, 1, 1}, 0, 1), place({1, 0, 0}), false);
    large.snapshot.geometry_key = 2;
    const auto next = std::make_shared<const SceneSnapshot>(large.snapshot);
    {
        const std::unique_ptr<Device> device = gpu.make();
        device->load(large.scene, nullptr);
        device->set_frame(s.snapshot);
        Film film(32, 32, {});
        film.clear();
        device->begin_film(film);
        device->render({}, film);
        const std::size_t plenty = gpu.runtime->capacity;
        gpu.runtime->capacity = gpu.runtime->in_use() + 1000;
        device->stage(next);  // and the frame at hand goes on
        device->render({}, film);
        device->read_film(film);
        EXPECT_EQ(film.samples(3, 3), 2u);
        EXPECT_THROW(device->set_frame(*next), RenderError);
        gpu.runtime->capacity = plenty;
        device->set_frame(s.snapshot);  // and the one before is made anew
        device->render({}, film);
        EXPECT_NE(gpu.launches.back().top, nullptr);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(FramesAhead, OthersMayComeInBetweenAndEqualOnesAreNotTakenForIt) {
    LookingGpu gpu;
    Changing shot;
    const Scene scene = shot.scene();
    {
        const std::unique_ptr<Device> device = gpu.make();
        device->load(scene, nullptr);
        const auto zero = shot.frame(0), one = shot.frame(1), two = shot.frame(2);
        device->set_frame(*zero);
        device->stage(one);
        device->stage(one);  // it is staged already
        device->set_frame(*two);
        EXPECT_EQ(device->statistics().staged, 0u);
        const SceneSnapshot copy = *one;
        device->set_frame(copy);  // another object: nobody knows that it is the same
        EXPECT_EQ(device->statistics().staged, 0u);
        device->set_frame(*one);
        EXPECT_EQ(device->statistics().staged, 1u);
        device->set_frame(*one);  // it was taken
        EXPECT_EQ(device->statistics().staged, 0u);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(FramesAhead, WhicheverCallFailsTheErrorIsClearAndEverythingIsFreed) {
    std::size_t calls = 0;
    render(true, [&](LookingGpu& gpu, int n) {
        if (n == 3) calls = gpu.runtime->calls.size();
    });
    ASSERT_GT(calls, 100u);
    for (int n = 0; n < static_cast<int>(calls); ++n) {
        LookingGpu gpu;
        ::testing::internal::CaptureStderr();
        try {
            render(gpu, true, [&](LookingGpu&, int) { gpu.runtime->failing_call = n; });
        } catch (const RenderError& error) {
            EXPECT_THAT(error.what(), HasSubstr("cannot ")) << n;
        }
        ::testing::internal::GetCapturedStderr();
        EXPECT_EQ(gpu.complaints(), "") << n;
    }
}

}  // namespace
}  // namespace kadr::test
