// The GPU's kernel that bends meshes, built for the host: the vertices and tangents of the processor's skinning, to the
// last bit; and boxes that hold their triangles at any time.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

#include "device/hiprt/gpu_bender.h"
#include "device/small_scene.h"
#include "frame/skinning.h"
#include "kernels/gpu/moving_triangle.h"

namespace kadr::test {
namespace {

constexpr std::size_t kVertices = 5000;  // more than the processor's blocks hold

/// What a mesh may have.
struct Kind {
    const char* name;
    int slots, joints;
    Skinning skinning;
    bool stretch, normals, tangents, morphs;
};
constexpr Kind kKinds[] = {
    {"one joint", 1, 5, Skinning::linear, false, true, false, false},
    {"four joints, tangents", 4, 12, Skinning::linear, true, true, true, false},
    {"nine joints and morph targets", 9, 30, Skinning::linear, true, true, true, true},
    {"morph targets alone", 0, 1, Skinning::linear, false, true, true, true},
    {"flat, morphed", 0, 1, Skinning::linear, false, false, false, true},
    {"a skin of a single joint", 4, 1, Skinning::dual_quaternion, true, true, true, false},
    {"dual quaternions", 4, 12, Skinning::dual_quaternion, false, true, true, false},
    {"dual quaternions that stretch, morph targets", 8, 12, Skinning::dual_quaternion, true, true, true, true},
};

class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    float between(double low, double high) { return static_cast<float>(std::uniform_real_distribution<double>(low, high)(engine_)); }
    kernels::Vec3f vec(double size) { return {between(-size, size), between(-size, size), between(-size, size)}; }
    std::uint16_t below(int end) { return static_cast<std::uint16_t>(std::uniform_int_distribution<int>(0, end - 1)(engine_)); }

private:
    std::mt19937 engine_;
};

GeometryData mesh_of(const Kind& kind, Random& random) {
    GeometryData g;
    for (std::size_t v = 0; v < kVertices; ++v) {
        g.positions.push_back(random.vec(1));
        if (kind.normals) g.normals.push_back(normalize(random.vec(1) + kernels::Vec3f{0, 0, 0.01f}));
        if (kind.tangents) g.tangents.push_back({random.between(-1, 1), random.between(-1, 1), 0.1f, v % 2 == 0 ? 1.0f : -1.0f});
        g.uv[0].push_back({random.between(0, 1), random.between(0, 1)});
        const std::size_t first = g.skin.weights.size();
        float sum = 0;
        // As the loader leaves them: descending, unused slots behind.
        for (int s = 0; s < kind.slots; ++s) {
            g.skin.joints.push_back(random.below(kind.joints));
            g.skin.weights.push_back(s <= static_cast<int>(v) % kind.slots ? 1.0f / static_cast<float>(s + 1) : 0.0f);
            sum += g.skin.weights.back();
        }
        for (std::size_t s = first; s < g.skin.weights.size(); ++s) g.skin.weights[s] /= sum;
    }
    g.skin.per_vertex = kind.slots;
    for (unsigned i = 0; i + 2 < kVertices; i += 2) g.indices.insert(g.indices.end(), {i, i + 1, i + 2});
    if (!kind.morphs) return g;
    for (int t = 0; t < 4; ++t) {
        MorphTarget target;
        for (std::uint32_t v = 0; v < kVertices; v += t == 0 ? 1 : 3) {  // one dense, others sparse
            target.vertices.push_back(v);
            target.positions.push_back(random.vec(0.3));
            if (t != 1) target.normals.push_back(random.vec(0.3));
            if (t == 2) target.tangents.push_back(random.vec(0.3));
        }
        g.targets.push_back(target);
    }
    return g;
}

DeformationPose pose_of(const Kind& kind, Random& random) {
    DeformationPose pose;
    for (int j = 0; j < kind.joints; ++j) {
        const kernels::Vec3f axis = random.vec(1), at = random.vec(2);
        glm::dmat4 m = glm::rotate(glm::translate(glm::dmat4(1), {at.x, at.y, at.z}), static_cast<double>(random.between(-3, 3)), glm::normalize(glm::dvec3(axis.x, axis.y, axis.z + 1e-3)));
        if (kind.stretch) m = glm::scale(m, glm::dvec3(1.3, j % 3 == 0 ? -0.8 : 0.8, 1.1));
        if (kind.stretch) m[1][0] += 0.2;
        pose.joints.push_back(m);
    }
    if (kind.morphs) pose.weights = {random.between(-1, 1), 0, random.between(-1, 1), random.between(0, 1)};
    return pose;
}

/// A mesh bent at three keys by both.
struct Bent {
    GeometryData geometry;
    DeformedMesh mesh;
    std::vector<kernels::Vertex> vertices;
    std::vector<kernels::Vec4f> tangents;

    Bent(const Kind& kind, unsigned seed) {
        Random random(seed);
        geometry = mesh_of(kind, random);
        auto poses = std::make_shared<std::vector<VertexPose>>();
        for (int k = 0; k < 3; ++k) poses->emplace_back(pose_of(kind, random), kind.skinning);
        mesh.key_count = 3;
        mesh.poses = poses;
        mesh.vertices.resize(3 * kVertices);
        mesh.tangents.resize(3 * geometry.tangents.size());
        for (std::size_t k = 0; k < 3; ++k)
            deform_vertices(geometry, (*poses)[k], std::span(mesh.vertices).subspan(k * kVertices, kVertices), std::span(mesh.tangents).subspan(k * geometry.tangents.size(), geometry.tangents.size()));
        launch();
    }

    /// As a grid of blocks runs the kernel.
    void launch() {
        const MorphTable morphs = make_morph_table(geometry);
        const PoseTable poses = make_pose_table(mesh, geometry);
        const auto data = [](const auto& list) { return list.empty() ? nullptr : list.data(); };
        vertices.resize(mesh.vertices.size());
        tangents.resize(mesh.tangents.size());
        kernels::BendParams params{};
        params.rest = {data(geometry.positions),    data(geometry.normals), data(geometry.tangents), data(geometry.uv[0]),
                       data(geometry.skin.joints),  data(geometry.skin.weights), data(morphs.first), data(morphs.entries),
                       data(morphs.parts),          static_cast<unsigned>(kVertices), geometry.skin.per_vertex};
        params.poses = {data(poses.matrices), data(poses.dual_quaternions), data(poses.weights), data(poses.stretches), poses.joint_count, poses.target_count, mesh.key_count};
        params.vertices = vertices.data();
        params.tangents = tangents.empty() ? nullptr : tangents.data();
        for (std::size_t i = 0; i < vertices.size(); ++i) kernels::bend_vertex(params, i);
    }
};

/// No tolerance: one source, one order of additions.
TEST(BendKernel, MakesTheProcessorsVerticesToTheLastBit) {
    unsigned seed = 1;
    for (const Kind& kind : kKinds) {
        const Bent bent(kind, seed++);
        EXPECT_EQ(std::memcmp(bent.vertices.data(), bent.mesh.vertices.data(), bent.vertices.size() * sizeof(kernels::Vertex)), 0) << kind.name;
        EXPECT_EQ(bent.tangents.size(), kind.tangents ? 3 * kVertices : 0u) << kind.name;
        if (kind.tangents) {
            EXPECT_EQ(std::memcmp(bent.tangents.data(), bent.mesh.tangents.data(), bent.tangents.size() * sizeof(kernels::Vec4f)), 0) << kind.name;
        }
        const auto moved = [&](std::size_t v) { return bent.vertices[v].position.x != bent.geometry.positions[v].x; };
        EXPECT_TRUE(moved(0) && moved(kVertices - 1)) << kind.name;
    }
}

TEST(BendKernel, BoxesHoldTheirTrianglesAtAnyTime) {
    const Bent bent(kKinds[1], 7);
    kernels::Geometry g{};
    g.vertices = bent.vertices.data();
    g.indices = bent.geometry.indices.data();
    g.vertex_count = kVertices;
    g.triangle_count = static_cast<unsigned>(bent.geometry.indices.size() / 3);
    g.key_count = 3;
    for (unsigned t = 0; t < g.triangle_count; ++t) {
        const kernels::TriangleBox box = kernels::box_of(g, t);
        for (const float time : {0.0f, 0.2f, 0.5f, 0.9f, 1.0f}) {
            kernels::Vec3f p[3];
            kernels::corners_at(g, t, time, p);
            for (const kernels::Vec3f& c : p) {
                EXPECT_TRUE(c.x > box.low.x && c.y > box.low.y && c.z > box.low.z) << t;
                EXPECT_TRUE(c.x < box.high.x && c.y < box.high.y && c.z < box.high.z) << t;
            }
        }
    }
}

}  // namespace
}  // namespace kadr::test
