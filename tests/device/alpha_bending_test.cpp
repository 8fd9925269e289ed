// Masked and blended surfaces of meshes that bend, against rigid meshes in the same pose.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "device/small_scene.h"
#include "frame/skinning.h"

namespace kadr::test {
namespace {

using kernels::Vec3f;

constexpr int kTexels = 16;
constexpr unsigned kColumns = 8;  // quads of the strip

/// Alpha that has no symmetry: a ramp in u, a step in v, some texels of their own.
TextureData leaf() {
    TextureData texture;
    texture.width = texture.height = kTexels;
    texture.texels.resize(4 * kTexels * kTexels, 255);
    for (int y = 0; y < kTexels; ++y)
        for (int x = 0; x < kTexels; ++x) {
            const int alpha = 16 * x + (y > 10 ? 60 : 0) + ((x * 7 + y * 3) % 5 == 0 ? 90 : 0);
            texture.texels[static_cast<std::size_t>(4 * (y * kTexels + x) + 3)] =
                static_cast<std::uint8_t>(std::min(alpha, 255));
        }
    return texture;
}

/// A strip from x = -1 to 1 of two joints, the right end on joint 1, with a morph target that lifts its middle.
GeometryData strip() {
    GeometryData g;
    g.name = "strip";
    g.skin.per_vertex = 2;
    MorphTarget lift;
    for (unsigned i = 0; i <= kColumns; ++i)
        for (unsigned side = 0; side < 2; ++side) {
            const float t = static_cast<float>(i) / kColumns;
            lift.vertices.push_back(static_cast<std::uint32_t>(g.positions.size()));
            lift.positions.push_back({0, 0, 2 * t * (1 - t)});
            g.positions.push_back({2 * t - 1, side ? 0.8f : -0.8f, 0});
            g.normals.push_back({0, 0, 1});
            g.uv[0].push_back({t, 1.0f - static_cast<float>(side)});
            const bool right = t > 0.5f;
            g.skin.joints.insert(g.skin.joints.end(),
                                 {static_cast<std::uint16_t>(right), static_cast<std::uint16_t>(!right)});
            g.skin.weights.insert(g.skin.weights.end(), {right ? t : 1 - t, right ? 1 - t : t});
        }
    for (unsigned i = 0; i < 2 * kColumns; i += 2)
        g.indices.insert(g.indices.end(), {i, i + 2, i + 1, i + 1, i + 2, i + 3});
    g.targets.push_back(lift);
    return g;
}

DeformationPose pose(double degrees, double lift) {
    return {{glm::dmat4(1), glm::rotate(glm::dmat4(1), glm::radians(degrees), glm::dvec3(0, 1, 0))}, {lift}};
}

kernels::Material leafy(kernels::AlphaMode mode) {
    kernels::Material m = material({0.8f, 0.7f, 0.5f}, 0, 0.6f);
    m.alpha_mode = mode;
    m.base_color_texture.texture = 0;
    m.double_sided = true;
    return m;
}

kernels::Light sun() {
    kernels::Light light;
    light.kind = kernels::LightKind::directional;
    light.radiance = {2, 2, 2};
    light.direction = {-0.3f, -0.5f, -0.8124f};
    return light;
}

/// The strip in front of a wall, which its shadow falls on.
SmallScene walled(kernels::IntegratorKind integrator) {
    SmallScene s;
    s.scene.textures.push_back(leaf());
    s.snapshot.settings.integrator = integrator;
    s.snapshot.settings.seed = 7;
    s.snapshot.settings.width = s.snapshot.settings.height = 48;
    s.add_instance(s.add_mesh(unit_square()), material({0.6f, 0.6f, 0.6f}, 0, 1), place({0, 0, -1.5}, 2), false);
    s.add_light(sun());
    return s;
}

std::shared_ptr<DeformedMesh> mesh_of(const GeometryData& g, unsigned geometry,
                                      const std::vector<DeformationPose>& poses, Skinning skinning) {
    auto mesh = std::make_shared<DeformedMesh>();
    mesh->geometry = geometry;
    mesh->key_count = static_cast<unsigned>(poses.size());
    mesh->version = 1;
    for (const DeformationPose& at : poses) {
        std::vector<kernels::Vertex> vertices(g.positions.size());
        deform_vertices(g, VertexPose(at, skinning), vertices, {});
        mesh->vertices.insert(mesh->vertices.end(), vertices.begin(), vertices.end());
    }
    return mesh;
}

Image render_bent(const std::vector<DeformationPose>& poses, kernels::AlphaMode mode,
                  kernels::IntegratorKind integrator, Skinning skinning) {
    SmallScene s = walled(integrator);
    const GeometryData g = strip();
    const unsigned geometry = s.add_mesh(g);
    s.add_instance(geometry, leafy(mode), glm::dmat4(1), false);
    s.snapshot.instances.edit_back().deformed = 0;
    s.snapshot.deformed.push_back(mesh_of(g, geometry, poses, skinning));
    return s.render(16).image;
}

/// A rigid mesh whose own vertices are those of the pose. It takes the place among the kernels' geometries that a
/// bending one has, after the rigid ones: what a blend lets through is a hash of that number too.
Image render_rigid(const DeformationPose& at, kernels::AlphaMode mode, kernels::IntegratorKind integrator,
                   Skinning skinning) {
    SmallScene s = walled(integrator);
    GeometryData g = strip();
    const std::shared_ptr<DeformedMesh> mesh = mesh_of(g, 0, {at}, skinning);
    for (std::size_t v = 0; v < g.positions.size(); ++v)
        g.positions[v] = mesh->vertices[v].position, g.normals[v] = mesh->vertices[v].normal;
    s.add_mesh(unit_square());  // not shown
    s.add_instance(s.add_mesh(g), leafy(mode), glm::dmat4(1), false);
    return s.render(16).image;
}

/// Pixels that differ by more than rounding.
int different_pixels(const Image& a, const Image& b, double rounding) {
    int count = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            double worst = 0;
            for (int c = 0; c < 4; ++c)
                worst = std::max(worst, static_cast<double>(std::abs(a.at(x, y, c) - b.at(x, y, c))));
            count += worst > rounding;
        }
    return count;
}

/// Whether the alpha matters: the same strip without holes looks different in a good part of the image.
void expect_holes(const Image& image, kernels::IntegratorKind integrator, const std::vector<DeformationPose>& poses,
                  Skinning skinning) {
    EXPECT_GT(different_pixels(image, render_bent(poses, kernels::AlphaMode::opaque, integrator, skinning), 0.01), 200);
}

TEST(AlphaBending, AStillPoseIsTheRigidMeshBitForBit) {
    for (const auto mode : {kernels::AlphaMode::mask, kernels::AlphaMode::blend})
        for (const auto integrator : {kernels::IntegratorKind::direct, kernels::IntegratorKind::path})
            for (const Skinning skinning : {Skinning::linear, Skinning::dual_quaternion}) {
                const Image bent = render_bent({pose(50, 0.4)}, mode, integrator, skinning);
                EXPECT_EQ(bent.pixels, render_rigid(pose(50, 0.4), mode, integrator, skinning).pixels);
                expect_holes(bent, integrator, {pose(50, 0.4)}, skinning);
            }
}

TEST(AlphaBending, EqualKeysOverTheShutterAreTheRigidMesh) {
    // The kernels mix equal keys, Embree too: one rounding of each coordinate, which moves hits by less than 1e-6.
    for (const auto mode : {kernels::AlphaMode::mask, kernels::AlphaMode::blend}) {
        const std::vector<DeformationPose> poses(3, pose(50, 0.4));
        const Image bent = render_bent(poses, mode, kernels::IntegratorKind::path, Skinning::linear);
        EXPECT_LE(
            different_pixels(bent, render_rigid(poses[0], mode, kernels::IntegratorKind::path, Skinning::linear), 1e-4),
            2);
    }
}

/// matrix with M a = b for the corners of a triangle and for its normal.
glm::dmat4 carrying(const Vec3f (&a)[3], const Vec3f (&b)[3]) {
    const auto frame = [](const Vec3f(&t)[3]) {
        const auto at = [&](int i) { return glm::dvec3(t[i].x, t[i].y, t[i].z); };
        const glm::dvec3 u = at(1) - at(0), v = at(2) - at(0);
        return glm::dmat4(glm::dvec4(u, 0), glm::dvec4(v, 0), glm::dvec4(glm::cross(u, v), 0), glm::dvec4(at(0), 1));
    };
    return frame(b) * glm::inverse(frame(a));
}

TEST(AlphaBending, ABlurredBendIsItsTrianglesMovingOneByOne) {
    // Between two keys every vertex goes straight, so every triangle moves by an affine map that goes linearly from one
    // key to the other: an instance of its own with two matrices shows the same, texture coordinates included.
    const std::vector<DeformationPose> poses{pose(10, 0), pose(60, 0.5)};
    const GeometryData g = strip();
    const std::shared_ptr<DeformedMesh> mesh = mesh_of(g, 0, poses, Skinning::linear);
    for (const auto mode : {kernels::AlphaMode::mask, kernels::AlphaMode::blend}) {
        SmallScene s = walled(kernels::IntegratorKind::direct);  // whose blend composites, without a hash
        for (std::size_t t = 0; t < g.indices.size(); t += 3) {
            GeometryData one;
            Vec3f a[3], b[3];
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const std::uint32_t v = g.indices[t + corner];
                a[corner] = mesh->vertices[v].position;
                b[corner] = mesh->vertices[g.positions.size() + v].position;
                one.positions.push_back(a[corner]);
                one.uv[0].push_back(g.uv[0][v]);
            }
            one.indices = {0, 1, 2};
            s.add_moving(s.add_mesh(one), leafy(mode), {glm::dmat4(1), carrying(a, b)});
            s.snapshot.motion.linear.edit_back() = 1;
        }
        const Image triangles = s.render(16).image;

        SmallScene flat = walled(kernels::IntegratorKind::direct);
        GeometryData without = g;
        without.normals.clear();  // the triangles have none of their neighbours' either
        const unsigned geometry = flat.add_mesh(without);
        flat.add_instance(geometry, leafy(mode), glm::dmat4(1), false);
        flat.snapshot.instances.edit_back().deformed = 0;
        auto bare = std::make_shared<DeformedMesh>(*mesh);
        bare->geometry = geometry;
        for (kernels::Vertex& vertex : bare->vertices) vertex.normal = {0, 0, 0};
        flat.snapshot.deformed.push_back(bare);
        const Image bent = flat.render(16).image;
        // 48 * 48 pixels of 16 samples: rounding sends a few hits across a texel's border or a triangle's edge.
        EXPECT_LE(different_pixels(bent, triangles, 2e-3), 8) << static_cast<int>(mode);
        expect_holes(bent, kernels::IntegratorKind::direct, poses, Skinning::linear);
    }
}

/// A glowing strip, opaque up to u = 5 / 16, in the midst of a quad, which is x = -0.375 at rest; it slides by its
/// vertices.
Image render_cut(int uv_set, double slid) {
    SmallScene s;
    s.snapshot.settings.width = s.snapshot.settings.height = 48;  // 16 pixels a metre
    s.snapshot.settings.max_bounces = 0;
    TextureData texture = leaf();
    texture.nearest = true;
    for (std::size_t i = 0; i < kTexels * kTexels; ++i) texture.texels[4 * i + 3] = i % kTexels < 5 ? 255 : 0;
    s.scene.textures.push_back(texture);
    kernels::Material glow = leafy(kernels::AlphaMode::mask);
    glow.base_color = {0, 0, 0};
    glow.emission = {1, 1, 1};
    glow.base_color_texture.uv_set = uv_set;
    GeometryData g = strip();
    if (uv_set == 1) g.uv[1] = std::exchange(g.uv[0], std::vector<kernels::Vec2f>(g.positions.size(), {0.9f, 0.9f}));
    const unsigned geometry = s.add_mesh(g);
    s.add_instance(geometry, glow, glm::dmat4(1), false);
    s.snapshot.instances.edit_back().deformed = 0;
    const glm::dmat4 moved = glm::translate(glm::dmat4(1), glm::dvec3(slid, 0, 0));
    s.snapshot.deformed = {
        mesh_of(g, geometry, {{{glm::dmat4(1), glm::dmat4(1)}, {0}}, {{moved, moved}, {0}}}, Skinning::linear)};
    return s.render(1024).image;
}

TEST(AlphaBending, AMaskCutsWhereItsTextureSaysSo) {
    for (const int uv_set : {0, 1})
        for (const double slid : {0.0, 0.5}) {
            const Image image = render_cut(uv_set, slid);
            for (int y = 14; y < 34; ++y) {
                double light = 0, moment = 0;
                for (int x = 0; x < 48; ++x)
                    light += image.at(x, y, 1), moment += image.at(x, y, 1) * (x + 0.5 - 24) / 16;
                // 4 / 1024 for each of the 16 pixels that its ends slide over, as if they all erred alike.
                EXPECT_NEAR(light, 10, 0.1) << "pixels in row " << y;
                EXPECT_NEAR(moment / light, -0.6875 + 0.5 * slid, 0.1 / 16) << "metres in row " << y;
            }
        }
}

}  // namespace
}  // namespace kadr::test
