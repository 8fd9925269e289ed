// Meshes that bend, on the device.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "device/embree/deforming_meshes.h"
#include "device/small_scene.h"
#include "device/tables/bounds_tree.h"

namespace kadr::test {
namespace {

kernels::Material glowing() {
    kernels::Material m = material({0, 0, 0}, 0, 1);
    m.emission = {1, 1, 1};
    return m;
}

using Bend = std::function<kernels::Vec3f(kernels::Vec3f, double)>;  ///< position at rest, time

/// Vertices of a mesh at evenly spaced times.
std::shared_ptr<DeformedMesh> bent(const GeometryData& g, unsigned geometry, unsigned keys, const Bend& bend, std::uint64_t version = 1) {
    auto mesh = std::make_shared<DeformedMesh>();
    mesh->geometry = geometry;
    mesh->key_count = keys;
    mesh->version = version;
    for (unsigned k = 0; k < keys; ++k)
        for (std::size_t v = 0; v < g.positions.size(); ++v)
            mesh->vertices.push_back({bend(g.positions[v], keys > 1 ? k / (keys - 1.0) : 0.0), g.normals.empty() ? kernels::Vec3f{0, 0, 0} : g.normals[v],
                                      g.uv[0].empty() ? kernels::Vec2f{0, 0} : g.uv[0][v]});
    return mesh;
}

void add_bent(SmallScene& s, const GeometryData& g, const kernels::Material& m, unsigned keys, const Bend& bend, const glm::dmat4& place = glm::dmat4(1)) {
    const unsigned geometry = s.add_mesh(g);
    s.add_instance(geometry, m, place);
    s.snapshot.instances.edit_back().deformed = static_cast<int>(s.snapshot.deformed.size());
    auto mesh = bent(g, geometry, keys, bend);
    mesh->number = static_cast<unsigned>(s.snapshot.deformed.size());
    s.snapshot.deformed.push_back(mesh);
}

kernels::Vec3f same(kernels::Vec3f p, double) { return p; }

/// Parts of a rectangle's upper edge that rises while its lower one stays: the vertical smear is a ramp.
TEST(Deformation, RisingEdgeCoversEachPixelForItsTime) {
    for (const int width : {1, 0}) {
        SmallScene s;
        s.camera({0, 0, 10}, {0, 0, 0}, 0.25);
        s.snapshot.settings.max_bounces = 0;
        add_bent(s, unit_square(), glowing(), 2, [](kernels::Vec3f p, double t) { return kernels::Vec3f{p.x, p.y > 0 ? static_cast<float>(-1 + 2 * t) : -1.0f, 0}; });
        const Image image = s.render(256, 2, width).image;
        for (const int row : {10, 13, 16, 20, 24}) {
            const double y = -(row + 0.5 - 16) / 16 * 2.5, covered = std::abs(y) < 1 ? (1 - y) / 2 : 0;
            EXPECT_NEAR(image.at(16, row, 1), covered, 0.03) << "row " << row;  // as in Motion.SlidingSquare...
        }
    }
}

TEST(Deformation, LooksAsAMovingInstanceDoes) {
    // The same slide by vertices and by transforms: normals, shadow rays and light sampling agree.
    const auto render = [](bool by_vertices) {
        SmallScene s;
        const kernels::Material m = material({0.8f, 0.7f, 0.6f}, 0, 0.5f);
        if (by_vertices)
            add_bent(s, unit_sphere(24), m, 3, [](kernels::Vec3f p, double t) { return kernels::Vec3f{static_cast<float>(p.x + t), p.y, p.z}; });
        else
            s.add_moving(s.add_mesh(unit_sphere(24)), m, {place({0, 0, 0}), place({1, 0, 0})});
        s.add_instance(s.add_mesh(unit_square()), m, glm::rotate(place({0, -1.2, 0}, 4), -kPi / 2, glm::dvec3(1, 0, 0)));
        kernels::Light sun;
        sun.kind = kernels::LightKind::directional;
        sun.radiance = {2, 2, 2};
        sun.direction = {-0.3f, -0.5f, -0.8124f};
        s.add_light(sun);
        return s.render(64).image;
    };
    const Image a = render(true), b = render(false);
    double difference = 0, sum = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) difference += std::abs(a.at(x, y, 1) - b.at(x, y, 1)), sum += b.at(x, y, 1);
    EXPECT_LT(difference / sum, 0.002);  // the same samples; rounding moves a few hits
}

TEST(Deformation, NormalsTurnWithTheKeys) {
    // A square whose keys turn its normals from +x+z to -x+z, while it stays: half way they face the camera.
    SmallScene s;
    GeometryData g = unit_square();
    g.normals.assign(4, {0, 0, 1});
    add_bent(s, g, material({1, 1, 1}, 0, 1), 2, same);
    auto mesh = std::make_shared<DeformedMesh>(*s.snapshot.deformed[0]);
    for (std::size_t v = 0; v < 8; ++v) mesh->vertices[v].normal = {v < 4 ? 0.6f : -0.6f, 0, 0.8f};
    s.snapshot.deformed[0] = mesh;
    FilmLayers layers;
    layers.normal = true;
    const auto normal = [&] { return s.render(64, 2, 0, layers).image; };
    const Image image = normal();
    int channel = -1;
    for (std::size_t c = 0; c < image.channels.size(); ++c)
        if (image.channels[c].find("normal") != std::string::npos && channel < 0) channel = static_cast<int>(c);
    ASSERT_GE(channel, 0);
    EXPECT_NEAR(image.at(16, 16, channel), 0, 0.05);
}

TEST(Deformation, IsTheSameForAnyThreadsAndWidths) {
    const auto render = [](int threads, int width) {
        SmallScene s;
        add_bent(s, unit_sphere(16), material({0.7f, 0.7f, 0.7f}, 0, 0.4f), 5,
                 [](kernels::Vec3f p, double t) { return kernels::Vec3f{static_cast<float>(p.x * std::cos(t * p.y) + p.z * std::sin(t * p.y)), p.y, static_cast<float>(p.z * std::cos(t * p.y) - p.x * std::sin(t * p.y))}; });
        kernels::Light sun;
        sun.kind = kernels::LightKind::directional;
        sun.radiance = {2, 2, 2};
        sun.direction = {-0.3f, -0.5f, -0.8124f};
        s.add_light(sun);
        return s.render(8, threads, width).image.pixels;
    };
    const auto one = render(1, 0);
    EXPECT_EQ(one, render(2, 0));
    EXPECT_EQ(one, render(7, 0));
    const auto narrow = render(1, 1);
    double sum = 0, wide = 0;
    for (std::size_t i = 0; i < one.size(); ++i) sum += narrow[i], wide += one[i];
    EXPECT_NEAR(sum / wide, 1, 1e-3);
}

TEST(Deformation, EmittersThatGrowShineAsTheyAre) {
    // A panel above a floor doubles its width while the shutter is open: next-event estimation (path, with its weights
    // against hits) agrees with paths that find it by chance alone.
    const auto render = [](bool sampled) {
        SmallScene s;
        s.camera({0, 3, 6}, {0, 0, 0}, 0.3);
        const kernels::Material floor = material({0.8f, 0.8f, 0.8f}, 0, 1);
        s.add_instance(s.add_mesh(unit_square()), floor, glm::rotate(place({0, -1, 0}, 4), -kPi / 2, glm::dvec3(1, 0, 0)));
        kernels::Material panel = glowing();
        panel.emission = {4, 4, 4};
        panel.double_sided = true;
        const auto grow = [](kernels::Vec3f p, double t) { return kernels::Vec3f{static_cast<float>(p.x * (0.5 + 1.5 * t)), 1.5f, p.y}; };
        if (sampled) {
            add_bent(s, unit_square(), panel, 2, grow);
        } else {  // many still panels, one for each time: each is a scene of its own
            double sum = 0;
            for (int i = 0; i < 16; ++i) {
                SmallScene still;
                still.camera({0, 3, 6}, {0, 0, 0}, 0.3);
                still.add_instance(still.add_mesh(unit_square()), floor, glm::rotate(place({0, -1, 0}, 4), -kPi / 2, glm::dvec3(1, 0, 0)));
                add_bent(still, unit_square(), panel, 1, [&](kernels::Vec3f p, double) { return grow(p, (i + 0.5) / 16); });
                sum += still.render(64).mean() / 16;
            }
            return sum;
        }
        return s.render(1024).mean();
    };
    EXPECT_NEAR(render(true) / render(false), 1, 0.01);  // both are noisy by some 0.3 %
}

TEST(Deformation, RefittedStructuresShowTheNewShape) {
    SmallScene s;
    s.snapshot.settings.max_bounces = 0;
    const GeometryData g = unit_sphere(16);
    add_bent(s, g, glowing(), 1, same);
    DeviceRequest request;
    request.name = "cpu";
    const DeviceChoice choice = make_device(request);
    choice.device->load(s.scene, nullptr);
    const auto mean = [&](const Bend& bend, std::uint64_t version) {
        s.snapshot.deformed[0] = bent(g, s.snapshot.instances[0].geometry, 1, bend, version);
        s.snapshot.geometry_key = version;
        choice.device->set_frame(s.snapshot);
        Film film(32, 32, {});
        Pass pass;
        pass.sample_count = pass.total_samples = 64;
        choice.device->render(pass, film);
        double sum = 0;
        const Image image = film.develop();
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x) sum += image.at(x, y, 1);
        return sum;
    };
    const double whole = mean(same, 1);
    const auto squeeze = [](double by) { return [by](kernels::Vec3f p, double) { return kernels::Vec3f{p.x, static_cast<float>(p.y * by), p.z}; }; };
    EXPECT_NEAR(mean(squeeze(0.9), 2) / whole, 0.9, 0.01);
    EXPECT_NEAR(mean(squeeze(0.5), 3) / whole, 0.5, 0.01);
    EXPECT_NEAR(mean([](kernels::Vec3f p, double) { return kernels::Vec3f{p.x + 20, p.y, p.z}; }, 4), 0, 1e-6);
    EXPECT_NEAR(mean(same, 5) / whole, 1, 1e-6);
}

TEST(StructureUpdate, FollowsTheGrowthOfTheTree) {
    const auto chosen = [](unsigned keys_before, bool low, unsigned keys, double growth) { return choose_update({keys_before, low, keys, growth}); };
    EXPECT_EQ(chosen(0, false, 1, 1), StructureUpdate::build);  // the first frame
    EXPECT_EQ(chosen(1, false, 1, 1), StructureUpdate::refit);
    EXPECT_EQ(chosen(1, false, 1, kMostGrowth), StructureUpdate::refit);
    EXPECT_EQ(chosen(1, false, 1, kMostGrowth + 1e-9), StructureUpdate::build_low);
    // The figure itself, which the measured speed of rays stands behind.
    EXPECT_EQ(chosen(1, false, 1, 1.05), StructureUpdate::refit);
    EXPECT_EQ(chosen(1, false, 1, 1.0501), StructureUpdate::build_low);
    EXPECT_EQ(chosen(1, true, 1, 1.5), StructureUpdate::build_low);  // still as fast
    EXPECT_EQ(chosen(1, true, 1, 1.01), StructureUpdate::build);      // calmed down: Embree cannot refit the low one
    EXPECT_EQ(chosen(1, false, 1, NAN), StructureUpdate::build_low);
    for (const unsigned before : {0u, 1u, 2u, 3u}) EXPECT_EQ(chosen(before, false, 3, 1), StructureUpdate::build);  // several keys: none is refitted
    EXPECT_EQ(chosen(3, false, 1, 1), StructureUpdate::build);
}

/// Structures of a sphere from frame to frame, as DeformingMeshes makes them.
class Structures {
public:
    explicit Structures(GeometryData mesh = unit_sphere(16)) : sphere_(std::move(mesh)) {
        add_bent(scene_, sphere_, glowing(), 1, same);
        meshes_ = std::make_unique<DeformingMeshes>(device_.get(), scene_.scene);
    }
    /// "built low refitted" of the frame
    std::string frame(unsigned keys, const Bend& bend) {
        scene_.snapshot.deformed[0] = bent(sphere_, scene_.snapshot.instances[0].geometry, keys, bend, ++version_);
        std::vector<kernels::Geometry> geometries;
        view_.materials = scene_.scene.materials.data();
        meshes_->set_frame(scene_.snapshot, view_, false, geometries);
        EXPECT_EQ(rtcGetDeviceError(device_.get()), RTC_ERROR_NONE);
        return std::to_string(meshes_->built()) + " " + std::to_string(meshes_->built_low()) + " " + std::to_string(meshes_->refitted());
    }
    /// Distance of a ray down the z axis from z = 5, at the shutter's opening.
    double depth(float x, float y) {
        RTCRayHit hit{{x, y, 5, 0, 0, 0, -1, 0, INFINITY, 0xffffffffu, 0, 0}, {}};
        hit.hit.geomID = hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        QueryContext context;
        intersect1(meshes_->structure(scene_.snapshot.instances[0]), context, hit, false);
        return static_cast<double>(hit.ray.tfar);
    }

private:
    GeometryData sphere_;
    SmallScene scene_;
    kernels::SceneView view_{};
    EmbreeDeviceHandle device_{rtcNewDevice(nullptr)};
    std::unique_ptr<DeformingMeshes> meshes_;
    std::uint64_t version_ = 0;
};

TEST(StructureUpdate, ARefitKeepsTheTree) {
    // Embree takes the wish for a refit and builds anew where the scene is not of the kind that it refits. What tells the
    // two apart: a build leaves out triangles beyond 1.844e18, and a refit does not look for them again.
    GeometryData g = unit_sphere(16);
    const auto first = static_cast<std::uint32_t>(g.positions.size());
    g.positions.insert(g.positions.end(), {{-1, -1, -10}, {1, -1, -10}, {0, 1, -10}});
    g.normals.insert(g.normals.end(), 3, {0, 0, 1});
    g.indices.insert(g.indices.end(), {first, first + 1, first + 2});
    const auto wide = [](float by) { return [by](kernels::Vec3f p, double) { return p.z < -9 ? kernels::Vec3f{by * p.x, by * p.y, p.z} : p; }; };
    Structures structures(g);
    EXPECT_EQ(structures.frame(1, wide(1.9e18f)), "1 0 0");
    EXPECT_EQ(structures.frame(1, wide(1.8e18f)), "0 0 1");
    EXPECT_EQ(structures.depth(3, 3), INFINITY);
    Structures anew(g);
    anew.frame(1, wide(1.8e18f));
    EXPECT_NEAR(anew.depth(3, 3), 15, 1e-3);  // it could be met
}

TEST(StructureUpdate, IsWhatHappensToTheMesh) {
    Structures structures;
    const auto deep = [](float by) { return [by](kernels::Vec3f p, double) { return kernels::Vec3f{p.x, p.y, by * p.z}; }; };
    // Some triangles thrown about: no tree of before fits.
    const auto mess = [](float by) { return [by](kernels::Vec3f p, double) { return kernels::Vec3f{std::fmod(by * 97 * p.x, 1.0f), std::fmod(by * 83 * p.y, 1.0f), std::fmod(by * 71 * p.z, 1.0f)}; }; };
    const auto shows = [&](float by) { EXPECT_NEAR(structures.depth(0.01f, 0.02f), 5 - by, 0.02) << by; };
    EXPECT_EQ(structures.frame(1, same), "1 0 0");
    shows(1);
    EXPECT_EQ(structures.frame(1, deep(1.1f)), "0 0 1");
    shows(1.1f);
    EXPECT_EQ(structures.frame(1, mess(1)), "1 1 0");
    EXPECT_EQ(structures.frame(1, deep(1.2f)), "1 0 0");  // no worse than the mess: a tree worth keeping
    shows(1.2f);
    EXPECT_EQ(structures.frame(1, deep(1.25f)), "0 0 1");
    shows(1.25f);
    EXPECT_EQ(structures.frame(2, deep(1.3f)), "1 0 0");
    shows(1.3f);
    EXPECT_EQ(structures.frame(2, deep(1.35f)), "1 0 0");
    shows(1.35f);
    EXPECT_EQ(structures.frame(1, deep(1.4f)), "1 0 0");
    shows(1.4f);
}

TEST(BoundsTree, TellsAGentleBendFromAMess) {
    const GeometryData g = unit_sphere(32);
    BoundsTree tree;
    const auto at = [&](const Bend& bend) { return bent(g, 0, 1, bend)->vertices; };
    tree.order(at(same), g.indices);
    const double rest = tree.cost(at(same), g.indices);
    EXPECT_NEAR(tree.cost(at([](kernels::Vec3f p, double) { return p * 7.0f; }), g.indices) / rest, 1, 1e-4);  // size does not count
    EXPECT_LT(tree.cost(at([](kernels::Vec3f p, double) { return kernels::Vec3f{p.x + 0.1f * p.y * p.y, p.y, p.z}; }), g.indices) / rest, 1.1);
    EXPECT_GT(tree.cost(at([](kernels::Vec3f p, double) { return kernels::Vec3f{std::fmod(97 * p.x, 1.0f), std::fmod(83 * p.y, 1.0f), std::fmod(71 * p.z, 1.0f)}; }), g.indices) / rest, 3);
}

}  // namespace
}  // namespace kadr::test
