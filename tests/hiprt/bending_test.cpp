// Meshes that bend, on the GPU: their vertices are copied, their structures updated or built anew.

#include <algorithm>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "device/small_scene.h"
#include "frame/skinning.h"
#include "fake_gpu.h"

namespace kadr::test {
namespace {

/// A square that bends, shown twice, and a device that shows it frame by frame.
struct Bending {
    FakeGpu gpu;
    SmallScene s;
    std::unique_ptr<Device> device;

    Bending() {
        const unsigned square = s.add_mesh(unit_square());
        for (int i = 0; i < 2; ++i) {
            s.add_instance(square, material({1, 1, 1}, 0, 1), place({i, 0, 0}), false);
            s.snapshot.instances.edit(static_cast<std::size_t>(i)).deformed = 0;
        }
        device = gpu.make();
        device->load(s.scene, nullptr);
    }
    /// @param reach  how far the third corner is, at the last key; also what its tangent says
    void show(std::uint64_t version, float reach, unsigned keys = 1) {
        auto mesh = std::make_shared<DeformedMesh>();
        mesh->geometry = 0;
        mesh->number = 7;
        mesh->version = version;
        mesh->key_count = keys;
        for (unsigned k = 0; k < keys; ++k)
            for (const kernels::Vec3f& p : s.scene.geometries[0].positions)
                mesh->vertices.push_back({p, {0, 0, 1}, {0, 0}});
        mesh->vertices[4 * (keys - 1) + 2].position = {reach, reach, 0};
        mesh->tangents.assign(mesh->vertices.size(), {reach, 0, 0, 1});
        s.snapshot.deformed = {mesh};
        ++s.snapshot.geometry_key;
        device->set_frame(s.snapshot);
    }
    void render() {
        Film film(32, 32, {});
        film.clear();
        device->render({}, film);
    }
    std::string complaints() {
        device.reset();
        return gpu.complaints();
    }
    StructureCounts counts() const { return device->statistics().structures; }
};

TEST(BendingOnGpu, OneStructureForAllCopiesUpdatedWhileItIsGood) {
    Bending b;
    b.show(1, 1);
    EXPECT_EQ(b.counts(), (StructureCounts{2, 0, 0}));  // the mesh, and all instances
    EXPECT_EQ(b.gpu.hiprt.geometries.size(), 1u);
    EXPECT_EQ(b.gpu.hiprt.geometries.begin()->second.options.flags, hiprt::build_flag::kFast);
    b.show(2, 1.0001f);
    EXPECT_EQ(b.counts(), (StructureCounts{1, 1, 0}));
    b.render();
    const kernels::SceneView& view = b.gpu.launches.back().scene;
    EXPECT_EQ(view.geometries[view.instances[1].geometry].vertices[2].position.x, 1.0001f);
    EXPECT_EQ(view.geometries[view.instances[1].geometry].tangents[3].x, 1.0001f);
    b.show(2, 1.0001f);
    EXPECT_EQ(b.counts(), (StructureCounts{1, 0, 1}));
    b.show(3, 300);
    EXPECT_EQ(b.gpu.hiprt.geometries.begin()->second.input.mesh.triangle_count, 2u);
    EXPECT_EQ(b.complaints(), "");
}

TEST(BendingOnGpu, AStructureThatItsVerticesHaveLeftIsBuiltAnew) {
    Bending b;
    b.s.scene.geometries[0] = unit_sphere(8);  // enough triangles to make a bad tree of
    b.device->load(b.s.scene, nullptr);
    const auto show = [&](std::uint64_t version, float shift) {
        auto mesh = std::make_shared<DeformedMesh>();
        mesh->number = 7;
        mesh->version = version;
        for (const kernels::Vec3f& p : b.s.scene.geometries[0].positions) mesh->vertices.push_back({p, p, {0, 0}});
        for (std::size_t i = 0; i < mesh->vertices.size(); i += 2) mesh->vertices[i].position.x += shift;
        b.s.snapshot.deformed = {mesh};
        ++b.s.snapshot.geometry_key;
        b.device->set_frame(b.s.snapshot);
    };
    show(1, 0);
    show(2, 1e-4f);
    EXPECT_EQ(b.counts(), (StructureCounts{1, 1, 0}));
    show(3, 5);
    EXPECT_EQ(b.counts(), (StructureCounts{2, 0, 0}));
    EXPECT_EQ(b.complaints(), "");
}

TEST(BendingOnGpu, ThoseShownNoMoreAreForgotten) {
    Bending b;
    b.show(1, 1);
    b.s.snapshot.deformed.clear();
    for (std::size_t i = 0; i < 2; ++i) b.s.snapshot.instances.edit(i).deformed = -1;
    ++b.s.snapshot.geometry_key;
    b.device->set_frame(b.s.snapshot);
    EXPECT_EQ(b.gpu.hiprt.geometries.size(), 1u);
    EXPECT_EQ(b.gpu.hiprt.geometries.begin()->second.options.flags, hiprt::build_flag::kHighQuality);
    EXPECT_EQ(b.complaints(), "");
}

TEST(BendingOnGpu, AFrameThatFailedLeavesNoVerticesBehind) {
    Bending b;
    b.show(1, 1);
    const std::size_t before = b.gpu.runtime->calls.size();
    b.show(2, 1.0001f);
    // The same again, but HIPRT fails once the new vertices are on their way.
    b.show(1, 1);
    std::size_t update = before;
    while (b.gpu.runtime->calls[update] != "build_geometries") ++update;
    b.gpu.runtime->failing_call = static_cast<int>(b.gpu.runtime->calls.size() + update - before);
    EXPECT_THROW(b.show(2, 1.0001f), RenderError);
    b.show(1, 1);
    b.render();
    const kernels::SceneView& view = b.gpu.launches.back().scene;
    EXPECT_EQ(view.geometries[view.instances[1].geometry].vertices[2].position.x, 1.0f);
    EXPECT_EQ(b.complaints(), "");
}

TEST(BendingOnGpu, BlurredMeshesAreBoxesAroundAllThatTheirTrianglesPass) {
    Bending b;
    b.show(1, 1);
    b.show(2, 5, 3);  // the third corner begins at 1, 1 and ends at 5, 5
    b.render();
    ASSERT_EQ(b.gpu.hiprt.geometries.size(), 1u);
    const FakeHiprt::GeometryRecord& record = b.gpu.hiprt.geometries.begin()->second;
    ASSERT_EQ(record.input.type, hiprt::PrimitiveType::aabb_list);
    EXPECT_EQ(record.input.geometry_type, kernels::geometry_type::kMoving);
    ASSERT_EQ(record.input.list.box_count, 2u);
    const float* box = static_cast<const float*>(record.input.list.boxes);
    for (int c = 0; c < 2; ++c) {
        EXPECT_LT(box[c], -1);
        EXPECT_NEAR(box[c], -1, 1e-5);
        EXPECT_GT(box[3 + c], 5);
        EXPECT_NEAR(box[3 + c], 5, 1e-5);
    }
    const kernels::LaunchParams& launch = b.gpu.launches.back();
    EXPECT_NE(launch.functions, nullptr);
    const kernels::Geometry& geometry = launch.scene.geometries[launch.scene.instances[0].geometry];
    EXPECT_EQ(geometry.key_count, 3u);
    EXPECT_EQ(geometry.vertices[2].position.x, 1.0f);
    EXPECT_EQ(geometry.vertices[2 * 4 + 2].position.x, 5.0f);
    EXPECT_THAT(b.gpu.hiprt.modules.begin()->second.source, ::testing::HasSubstr("KADR_REQUIREMENTS 10u"));
    // New boxes every frame, in the same place.
    b.show(3, 7, 3);
    EXPECT_NEAR(static_cast<const float*>(b.gpu.hiprt.geometries.begin()->second.input.list.boxes)[3], 7, 1e-4);
    EXPECT_EQ(b.counts(), (StructureCounts{2, 0, 0}));
    b.show(4, 1);
    EXPECT_EQ(b.gpu.hiprt.geometries.begin()->second.input.type, hiprt::PrimitiveType::triangle_mesh);
    b.render();
    EXPECT_EQ(b.complaints(), "");
}

/// From poses, the GPU makes the vertices: those of the host, which only the choice between update and build reads, are
/// other ones here.
TEST(BendingOnGpu, PosesAreBentByKernelsToTheProcessorsVertices) {
    for (const unsigned keys : {1u, 3u}) {
        Bending b;
        GeometryData& square = b.s.scene.geometries[0];
        square.normals.assign(4, {0, 0, 1});
        square.tangents.assign(4, {1, 0, 0, 1});
        square.skin = {2, {0, 1, 1, 0, 0, 1, 1, 0}, {0.5f, 0.5f, 1, 0, 0.75f, 0.25f, 1, 0}};
        square.targets.resize(1);
        square.targets[0].vertices = {1, 3};
        square.targets[0].positions = {{0, 0, 0.5f}, {0, 0.25f, 0}};
        b.device->load(b.s.scene, nullptr);
        auto mesh = std::make_shared<DeformedMesh>();
        auto poses = std::make_shared<std::vector<VertexPose>>();
        std::vector<kernels::Vertex> expected(std::size_t{4} * keys);
        std::vector<kernels::Vec4f> tangents(expected.size());
        for (std::size_t k = 0; k < keys; ++k) {
            const double turn = 0.4 * static_cast<double>(k) + 0.2;
            DeformationPose pose;
            pose.joints = {glm::rotate(glm::dmat4(1), turn, glm::dvec3(0, 1, 0)), glm::translate(glm::dmat4(1), glm::dvec3(0, turn, 0))};
            pose.weights = {turn};
            poses->emplace_back(pose, keys == 1 ? Skinning::linear : Skinning::dual_quaternion);
            deform_vertices(square, poses->back(), std::span(expected).subspan(4 * k, 4), std::span(tangents).subspan(4 * k, 4));
        }
        mesh->number = 7;
        mesh->version = 1;
        mesh->key_count = keys;
        mesh->poses = poses;
        mesh->vertices.assign(expected.size(), {{1, 2, 3}, {0, 0, 1}, {9, 9}});
        mesh->tangents.assign(expected.size(), {0, 0, 0, 0});
        b.s.snapshot.deformed = {mesh};
        ++b.s.snapshot.geometry_key;
        b.device->set_frame(b.s.snapshot);
        EXPECT_EQ(b.device->statistics().bending, (BendingCounts{1, 1, keys > 1 ? 1u : 0u, keys}));
        b.render();
        const kernels::SceneView& view = b.gpu.launches.back().scene;
        const kernels::Geometry& bent = view.geometries[view.instances[0].geometry];
        EXPECT_EQ(std::memcmp(bent.vertices, expected.data(), expected.size() * sizeof(kernels::Vertex)), 0);
        EXPECT_EQ(std::memcmp(bent.tangents, tangents.data(), tangents.size() * sizeof(kernels::Vec4f)), 0);
        if (keys > 1) {
            const float* box = static_cast<const float*>(b.gpu.hiprt.geometries.begin()->second.input.list.boxes);
            float low = expected[0].position.y;
            for (std::size_t k = 0; k < keys; ++k)
                for (const std::size_t v : {0u, 1u, 2u}) low = std::min(low, expected[4 * k + v].position.y);
            EXPECT_NEAR(box[1], low, 1e-5);
        }
        EXPECT_EQ(b.gpu.runtime->count("launch"), keys > 1 ? 3u : 2u);  // the vertices, the boxes, the picture
        EXPECT_EQ(b.complaints(), "");
    }
}

TEST(BendingOnGpu, PlacesOneFrameEarlier) {
    Bending b;
    b.s.snapshot.render_origin = {0, 0, 100};
    b.s.snapshot.previous.emplace();
    b.s.snapshot.previous->space_from_geometry = {place({5, 0, -100}), place({6, 0, -100})};
    b.s.snapshot.previous->deformed = {{{9, 0, 0}, {9, 1, 0}, {9, 2, 0}, {9, 3, 0}}};
    b.s.snapshot.previous->camera = b.s.snapshot.camera_keys[0];
    b.s.snapshot.previous->camera.lens_radius = 3;
    b.show(1, 1);
    b.render();
    const kernels::SceneView& view = b.gpu.launches.back().scene;
    EXPECT_EQ(view.previous_matrices[1].m[0][3], 6.0f);
    EXPECT_EQ(view.previous_matrices[1].m[2][3], -100.0f);
    EXPECT_EQ(view.geometries[view.instances[0].geometry].previous[3].y, 3.0f);
    EXPECT_EQ(view.previous_camera.keys[0].lens_radius, 3.0f);
    b.s.snapshot.previous.reset();
    b.show(2, 1);
    b.render();
    EXPECT_EQ(b.gpu.launches.back().scene.previous_matrices, nullptr);
    EXPECT_EQ(b.complaints(), "");
}

}  // namespace
}  // namespace kadr::test
