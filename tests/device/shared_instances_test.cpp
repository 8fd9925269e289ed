// Instances that snapshots share: a device that has seen them goes on from there, and shows what it would show alone.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "device/small_scene.h"

namespace kadr::test {
namespace {

/// The lists of a snapshot, so that others can begin with them.
struct SharedLists {
    SharedList<SnapshotInstance>::Shared instances;
    SharedList<glm::dmat4>::Shared fixed_places;
    SharedList<kernels::TransformHeader>::Shared headers;
    SharedList<FrameType>::Shared types;
    SharedList<std::uint8_t>::Shared linear;
    SharedList<kernels::FrameMatrix>::Shared matrices;

    template <class T>
    static std::shared_ptr<const std::vector<T>> whole(const SharedList<T>& list) { return std::make_shared<const std::vector<T>>(list.own()); }
    explicit SharedLists(const SceneSnapshot& s)
        : instances(whole(s.instances)), fixed_places(whole(s.fixed_places)), headers(whole(s.motion.headers)), types(whole(s.motion.types)),
          linear(whole(s.motion.linear)), matrices(whole(s.motion.matrices)) {}
    void begin(SceneSnapshot& s) const {
        s.instances = {instances, {}};
        s.fixed_places = {fixed_places, {}};
        s.motion.headers = {headers, {}};
        s.motion.types = {types, {}};
        s.motion.linear = {linear, {}};
        s.motion.matrices = {matrices, {}};
    }
};

/// A square that is flattened and two that are not, in one place or another, beside others that move.
struct Frames {
    SmallScene stage;
    std::vector<SceneSnapshot> snapshots;

    Frames() {
        const unsigned square = stage.add_mesh(unit_square());
        stage.add_mesh(unit_sphere(8));
        for (const kernels::Vec3f color : {kernels::Vec3f{1, 0, 0}, kernels::Vec3f{0, 1, 0}}) {
            kernels::Material m = material({0, 0, 0}, 0, 1);
            m.emission = color;
            stage.scene.materials.push_back(m);
        }
        const SharedLists left = still(square, -0.8), right = still(square, 0.9);
        const auto turned = [](double degrees) { return glm::rotate(place({-0.2, 0, 0.1}, 0.4), glm::radians(degrees), glm::dvec3(0, 0, 1)); };
        add(left, {{place({0, 0, 0}, 0.3)}});
        add(left, {{place({0.3, 0, 0}, 0.3), place({0.6, 0.3, 0}, 0.3)}, {place({0, 0.8, 0}, 0.3)}});
        add(left, {{turned(0), turned(10), turned(20)}, {place({0.5, 0.7, 0}, 0.2)}});
        add(left, {});
        add(right, {{turned(0), turned(10), turned(20)}});
        add(right, {{place({0, 0, 0}, 0.3)}, {place({0, -0.8, 0}, 0.3)}}, true);
    }

    SharedLists still(unsigned square, double x) {
        SmallScene scene;
        scene.add_instance(square, {}, place({0, -0.9, 0}, 0.25), true);  // wherever the others stand: fixed over the shot
        scene.add_instance(square, {}, place({x, 0, 0}, 0.25), false);
        scene.add_instance(square, {}, place({x, 0.6, 0}, 0.25), false);
        for (std::size_t i = 0; i < 3; ++i) scene.snapshot.instances.edit(i).material = i == 1 ? 1 : 0;
        return SharedLists(scene.snapshot);
    }

    /// @param fixed  what follows the shared ones stands still as well, and may be flattened
    void add(const SharedLists& shared, const std::vector<std::vector<glm::dmat4>>& moving, bool fixed = false) {
        SmallScene scene;
        shared.begin(scene.snapshot);
        PreviousPlaces previous;
        previous.camera = scene.snapshot.camera_keys[0];
        for (const std::vector<glm::dmat4>& frames : moving) {
            scene.add_moving(1, {}, frames, fixed);
            scene.snapshot.instances.edit_back().material = 1;
            previous.space_from_geometry.push_back(glm::translate(glm::dmat4(1), {0.1, 0, 0}) * frames[0]);
        }
        scene.snapshot.previous = previous;
        scene.snapshot.geometry_key = snapshots.size() + 1;
        snapshots.push_back(scene.snapshot);
    }

    /// The last of some frames that are set on one device, with its motion layer.
    Image last_of(const std::vector<std::size_t>& frames, DeviceStatistics* statistics = nullptr) const {
        DeviceRequest request;
        request.name = "cpu";
        request.threads = 2;
        const DeviceChoice choice = make_device(request);
        choice.device->load(stage.scene, nullptr);
        for (const std::size_t frame : frames) choice.device->set_frame(snapshots[frame]);
        FilmLayers layers;
        layers.motion = true;
        Film film(32, 32, layers);
        Pass pass;
        pass.sample_count = pass.total_samples = 4;
        choice.device->render(pass, film);
        if (statistics) *statistics = choice.device->statistics();
        return film.develop();
    }
};

double difference(const Image& a, const Image& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) worst = std::max<double>(worst, std::abs(a.pixels[i] - b.pixels[i]));
    return worst;
}

TEST(SharedInstances, AFrameDoesNotDependOnThoseBefore) {
    const Frames f;
    std::vector<std::size_t> so_far;
    for (const std::size_t next : {0u, 1u, 2u, 3u, 1u, 4u, 5u, 4u, 0u, 2u, 5u, 3u, 0u}) {
        so_far.push_back(next);
        DeviceStatistics kept, alone;
        EXPECT_EQ(difference(f.last_of(so_far, &kept), f.last_of({next}, &alone)), 0) << "frame " << next << " after " << so_far.size() - 1 << " others";
        EXPECT_EQ(kept.instances, alone.instances);
        EXPECT_EQ(kept.moving_instances, alone.moving_instances);
        EXPECT_EQ(kept.flattened_triangles, alone.flattened_triangles);
    }
}

TEST(SharedInstances, FramesOfThisTestDiffer) {  // or the test above would prove nothing
    const Frames f;
    for (std::size_t i = 0; i + 1 < f.snapshots.size(); ++i) EXPECT_GT(difference(f.last_of({i}), f.last_of({i + 1})), 0.5) << i;
}

TEST(SharedInstances, HaveNotMoved) {
    const Frames f;
    const Image image = f.last_of({4, 0});
    // The image shows 3 m around the origin at 5 m, 10.7 pixels a metre: the shared ones at x = -0.8, the own one at 0.
    const int left = 16 - 9;
    EXPECT_EQ(image.at(left, 16, 4), 0);
    EXPECT_EQ(image.at(16, 25, 4), 0);  // flattened
    EXPECT_NEAR(image.at(16, 16, 4), -0.1 * 32 / 3 * 5 / 4.7, 0.01) << "it came from the right; its front is 4.7 m away";
}

}  // namespace
}  // namespace kadr::test
