// Instances that stay from frame to frame: whatever the frames before were, a frame looks as it does alone.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "device/small_scene.h"

namespace kadr::test {
namespace {

kernels::Material glowing(kernels::Vec3f emission) {
    kernels::Material m = material({0, 0, 0}, 0, 1);
    m.emission = emission;
    return m;
}

/// A scene of two meshes, and frames of it that are set one after the other.
struct Frames {
    SmallScene stage;
    std::vector<SceneSnapshot> snapshots;

    Frames() {
        stage.add_mesh(unit_square());
        stage.add_mesh(unit_sphere(8));
        for (const kernels::Vec3f color : {kernels::Vec3f{1, 0, 0}, kernels::Vec3f{0, 1, 0}}) stage.scene.materials.push_back(glowing(color));
    }

    struct Seen {
        unsigned mesh = 0;
        std::vector<glm::dmat4> frames;
        bool linear = false, visible = true;
    };
    void add(const std::vector<Seen>& seen) {
        SmallScene scene;
        for (const Seen& one : seen) {
            scene.add_moving(one.mesh, {}, one.frames);
            scene.snapshot.instances.edit_back().material = one.mesh;
            scene.snapshot.instances.edit_back().mask = one.visible ? 0xffffffffu : 0;
            scene.snapshot.motion.linear.edit_back() = one.linear ? 1 : 0;
        }
        scene.snapshot.settings.max_bounces = 0;
        scene.snapshot.geometry_key = snapshots.size() + 1;
        snapshots.push_back(scene.snapshot);
    }

    /// The image of the last of some frames that are set on one device.
    Image last_of(const std::vector<std::size_t>& frames, std::uint64_t* instances = nullptr) const {
        DeviceRequest request;
        request.name = "cpu";
        request.threads = 2;
        const DeviceChoice choice = make_device(request);
        choice.device->load(stage.scene, nullptr);
        for (const std::size_t frame : frames) choice.device->set_frame(snapshots[frame]);
        Film film(32, 32, {});
        Pass pass;
        pass.sample_count = pass.total_samples = 4;
        choice.device->render(pass, film);
        if (instances) *instances = choice.device->statistics().instances;
        return film.develop();
    }
};

double difference(const Image& a, const Image& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) worst = std::max<double>(worst, std::abs(a.pixels[i] - b.pixels[i]));
    return worst;
}

/// Kinds of motion, numbers of keys, meshes, visible or not, more and fewer instances.
Frames varied_frames() {
    Frames f;
    const auto turned = [](double degrees) { return glm::rotate(place({-0.5, 0, 0}, 0.4), glm::radians(degrees), glm::dvec3(0, 0, 1)); };
    f.add({{0, {place({-0.7, 0, 0}, 0.3), place({-0.5, 0.3, 0}, 0.3)}, true}, {1, {place({0.6, 0, 0}, 0.4)}}, {0, {place({0, 0.8, 0}, 0.3)}}});
    f.add({{0, {place({-0.4, 0, 0}, 0.3), place({-0.2, -0.3, 0}, 0.3)}, true}, {1, {place({0.6, 0.5, 0}, 0.4)}}, {0, {place({0, -0.8, 0}, 0.3)}}});
    f.add({{0, {turned(0), turned(10), turned(20)}}, {0, {place({0.5, 0, 0}, 0.2)}}});
    f.add({{0, {turned(0), turned(10)}}, {1, {place({0.5, 0, 0}, 0.3)}, false, false}, {1, {place({0.5, -0.5, 0}, 0.3)}}});
    f.add({{1, {turned(0), turned(10)}, true}, {1, {place({0.5, 0, 0}, 0.3)}}});
    return f;
}

TEST(InstanceLevel, AFrameDoesNotDependOnThoseBefore) {
    const Frames f = varied_frames();
    std::vector<std::size_t> so_far;
    for (const std::size_t next : {0u, 1u, 2u, 3u, 4u, 0u, 3u, 1u, 4u, 2u, 0u}) {
        so_far.push_back(next);
        std::uint64_t kept_count = 0, alone_count = 0;
        const Image kept = f.last_of(so_far, &kept_count), alone = f.last_of({next}, &alone_count);
        EXPECT_EQ(difference(kept, alone), 0) << "frame " << next << " after " << so_far.size() - 1 << " others";
        EXPECT_EQ(kept_count, alone_count);
    }
}

TEST(InstanceLevel, FramesOfThisTestDiffer) {  // or the test above would prove nothing
    const Frames f = varied_frames();
    for (std::size_t i = 0; i + 1 < f.snapshots.size(); ++i) EXPECT_GT(difference(f.last_of({i}), f.last_of({i + 1})), 0.5) << i;
}

/// A square that never moves, at a place of its own.
SceneSnapshot still_square(std::uint32_t id, double x, bool visible = true) {
    SmallScene scene;
    scene.add_moving(0, {}, {place({x, 0, 0}, 0.3)}, true);
    scene.snapshot.instances.edit_back().material = 0;
    scene.snapshot.instances.edit_back().id = id;
    scene.snapshot.instances.edit_back().mask = visible ? 0xffffffffu : 0;
    scene.snapshot.settings.max_bounces = 0;
    scene.snapshot.geometry_key = 1 + 2 * id + (visible ? 1 : 0);
    return scene.snapshot;
}

TEST(InstanceLevel, StillInstancesAreToldApartByTheirIds) {
    // As many as before, and all of them still: only their ids say that they are others.
    Frames f;
    f.snapshots = {still_square(0, -0.5), still_square(1, 0.5)};
    EXPECT_GT(difference(f.last_of({0}), f.last_of({1})), 0.5);
    EXPECT_EQ(difference(f.last_of({0, 1}), f.last_of({1})), 0);
}

TEST(InstanceLevel, WhatIsHiddenNeitherShowsNorShines) {
    Frames f;
    f.snapshots = {still_square(0, 0), still_square(0, 0, false)};
    const auto brightest = [](const Image& image) {
        float most = 0;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) most = std::max(most, image.at(x, y, 0));
        return most;
    };
    EXPECT_EQ(brightest(f.last_of({0})), 1);
    EXPECT_EQ(brightest(f.last_of({1})), 0);
    EXPECT_EQ(brightest(f.last_of({0, 1})), 0);
    // Nor does it light a wall that the camera sees.
    for (const bool fixed : {false, true})
        for (const bool visible : {false, true}) {
            SmallScene room;
            room.snapshot.settings.max_bounces = 1;
            room.add_instance(room.add_mesh(unit_square()), material({0.8f, 0.8f, 0.8f}, 0, 1), place({0, 0, 0}));
            room.add_instance(0, glowing({5, 5, 5}), glm::rotate(place({0, 0, 8}), kPi, glm::dvec3(0, 1, 0)), fixed);
            room.snapshot.instances.edit_back().mask = visible ? 0xffffffffu : 0;
            room.add_instance(0, material({0, 0, 0}, 0, 1), place({50, 0, 0}), false);  // far away, so that the mesh is there in any case
            EXPECT_EQ(room.render(4).mean(0) > 0, visible) << fixed;
        }
}

TEST(InstanceLevel, CountsWhatIsShown) {
    const Frames f = varied_frames();
    std::uint64_t count = 0;
    f.last_of({0, 3}, &count);
    EXPECT_EQ(count, 2u);  // one of three is hidden
}

}  // namespace
}  // namespace kadr::test
