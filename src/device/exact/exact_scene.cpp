#include "device/exact/exact_scene.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "frame/bindings.h"
#include "frame/camera_keys.h"
#include "frame/decompose.h"
#include "frame/light_keys.h"

namespace kadr {
namespace {

glm::dvec3 to_double(kernels::Vec3f v) { return {v.x, v.y, v.z}; }

using Corners = std::array<glm::dvec3, 3>;

double longest_edge(const Corners& c) { return std::max({glm::distance(c[0], c[1]), glm::distance(c[1], c[2]), glm::distance(c[2], c[0])}); }

/// Halves the longest edge as long as that makes pieces stouter.
void add_boxes(const Corners& c, int halvings, std::vector<ExactBox>& boxes) {
    constexpr double kStout = 0.1;  // height over length
    const double length = longest_edge(c), doubled_area = glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
    if (halvings == 0 || doubled_area >= kStout * length * length) {
        ExactBox box;
        for (const glm::dvec3& p : c) box.add(p);
        return boxes.push_back(box);
    }
    std::size_t from = 0;
    while (from < 2 && glm::distance(c[from], c[(from + 1) % 3]) < length) ++from;
    const std::size_t to = (from + 1) % 3, other = (from + 2) % 3;
    const glm::dvec3 middle = 0.5 * (c[from] + c[to]);
    add_boxes({c[from], middle, c[other]}, halvings - 1, boxes);
    add_boxes({middle, c[to], c[other]}, halvings - 1, boxes);
}

TriangleTree tree_of(const kernels::Geometry& mesh, ExactBox& bounds) {
    constexpr int kHalvings = 4;
    std::vector<ExactBox> boxes;
    TriangleTree tree;
    for (unsigned t = 0; t < mesh.triangle_count; ++t) {
        const auto corner = [&](unsigned c) { return to_double(mesh.vertices[mesh.indices[3 * std::size_t{t} + c]].position); };
        add_boxes({corner(0), corner(1), corner(2)}, kHalvings, boxes);
        tree.triangle_of.resize(boxes.size(), t);
    }
    for (const ExactBox& box : boxes) bounds.add(box);
    tree.tree = BoxTree(boxes);
    return tree;
}

kernels::AffineOf<double> affine(const glm::dmat4& m) {
    kernels::AffineOf<double> a;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) a.m[row][column] = m[column][row];
    return a;
}

ExactBox box_in_world(const ExactBox& box, const glm::dmat4& world_from_object) {
    ExactBox world;
    for (int corner = 0; corner < 8; ++corner)
        world.add(glm::dvec3(world_from_object * glm::dvec4(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                                                            corner & 4 ? box.high.z : box.low.z, 1)));
    return world;
}

}  // namespace

ExactMeshes::ExactMeshes(const Scene& scene) {
    packed.reserve(scene.geometries.size());
    for (const GeometryData& source : scene.geometries) {
        views.push_back(packed.emplace_back(source).view(source));
        trees.push_back(tree_of(views.back(), bounds.emplace_back()));
    }
}

ExactScene::ExactScene(const BoundShot& shot, const ExactMeshes& meshes, const EnvironmentTables& environment, const SceneSnapshot& snapshot)
    : shot_(shot), meshes_(meshes), snapshot_(snapshot), materials_(shot.scene()) {
    materials_.set(snapshot);
    for (const TextureData& texture : shot.scene().textures) textures_.push_back(texture.view());
    for (const SnapshotInstance& instance : snapshot.instances) {
        instances_.push_back({instance.geometry, instance.material, instance.id});
        motions_.push_back({static_cast<unsigned>(motions_.size()), 1, kernels::InstanceMotion::Kind::still, false});
    }
    matrices_.resize(instances_.size());
    placed_.resize(instances_.size());
    view_.geometries = meshes.views.data();
    view_.instances = instances_.data();
    view_.motions = motions_.data();
    view_.matrices = matrices_.data();
    view_.materials = materials_.data();
    view_.textures = textures_.data();
    view_.camera = {&camera_, 1, snapshot.camera.orthographic, snapshot.camera.blades, snapshot.camera.near_clip, snapshot.camera.far_clip};
    view_.settings = snapshot.settings;
    fill_environment(snapshot.environment, environment, view_.lights);
}

void ExactScene::move_to(double time) {
    const double time_s = std::lerp(snapshot_.open_s, snapshot_.close_s, time);
    place_instances(time_s);
    camera_ = to_key<double>(camera_at(shot_, time_s), snapshot_.space());
    const double middle_s = 0.5 * (snapshot_.open_s + snapshot_.close_s);
    std::vector<kernels::LightOf<double>> lights = lights_at(shot_, time_s, middle_s, snapshot_.space());
    std::vector<LightKeys> each;
    for (std::uint32_t i = 0; i < lights.size(); ++i) each.push_back({i, 1});
    lights_.set(std::move(lights), each);
    lights_.fill(view_.lights);
    emitters_.set(snapshot_, view_);
    emitters_.fill(view_.lights);
}

glm::dmat4 ExactScene::space_from_geometry(const SnapshotInstance& seen, double time_s) const {
    const Bindings& bindings = shot_.bindings();
    const Instance instance = bindings.instances[seen.id];
    return snapshot_.space().from_world(bindings.node_transform(instance.seed->node, instance.copy, time_s) * bindings.copied_from_geometry(shot_.scene(), instance));
}

void ExactScene::place_instances(double time_s) {
    std::vector<ExactBox> boxes(instances_.size());
    for (std::size_t i = 0; i < instances_.size(); ++i) {
        const SnapshotInstance& seen = snapshot_.instances[i];
        const glm::dmat4 place = space_from_geometry(seen, time_s);
        matrices_[i] = affine(place);
        placed_[i].object_from_world = glm::inverse(place);
        placed_[i].shown = seen.mask != 0 && meshes_.views[seen.geometry].triangle_count > 0 && is_finite(placed_[i].object_from_world);
        if (placed_[i].shown) boxes[i] = box_in_world(meshes_.bounds[seen.geometry], place);
    }
    tree_ = BoxTree(boxes);
}

}  // namespace kadr
