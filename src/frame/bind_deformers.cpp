#include "frame/bind_deformers.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "frame/bindings.h"
#include "frame/deform.h"
#include "frame/deform_fit.h"
#include "frame/problem.h"

namespace kadr {

namespace {

constexpr int kBoundTimes = 9;                ///< at which the bounds of a deformer are taken over the shot
constexpr std::size_t kMostBoundOffsets = 64;  ///< and clip offsets of copies

bool bends(const Scene& scene, const MorphRig& morphs, const InstanceSeed& seed) {
    const Node& node = scene.nodes[static_cast<std::size_t>(seed.mesh_node)];
    const GeometryData& geometry = scene.geometries[seed.geometry];
    if (node.skin >= 0 && geometry.skin.per_vertex > 0) return true;
    const bool weighs = std::any_of(node.weights.begin(), node.weights.end(), [](double weight) { return weight != 0; });
    return !geometry.targets.empty() && (weighs || morphs.moves(seed.mesh_node));
}

std::vector<JointBox> boxes_of(const GeometryData& geometry, bool skinned) {
    std::map<std::size_t, JointBox> boxes;
    const auto add = [&](std::size_t joint, const kernels::Vec3f& p) {
        const glm::dvec3 at(p.x, p.y, p.z);
        const auto [place, fresh] = boxes.try_emplace(joint, JointBox{at, at, joint});
        place->second.low = glm::min(place->second.low, at);
        place->second.high = glm::max(place->second.high, at);
    };
    const auto slots = skinned ? static_cast<std::size_t>(geometry.skin.per_vertex) : std::size_t{1};
    for (std::size_t v = 0; v < geometry.positions.size(); ++v)
        for (std::size_t i = v * slots; i < (v + 1) * slots; ++i)
            if (!skinned || geometry.skin.weights[i] > 0) add(skinned ? geometry.skin.joints[i] : 0, geometry.positions[v]);
    std::vector<JointBox> result;
    for (const auto& [joint, box] : boxes) result.push_back(box);
    return result;
}

std::vector<double> target_sizes(const GeometryData& geometry) {
    std::vector<double> sizes;
    for (const MorphTarget& target : geometry.targets) {
        double longest = 0;
        for (const kernels::Vec3f& d : target.positions) longest = std::max(longest, glm::length(glm::dvec3(d.x, d.y, d.z)));
        sizes.push_back(longest);
    }
    return sizes;
}

/// Some of a deformer's clip offsets, from the first to the last.
std::vector<double> bounding_offsets(const Deformer& deformer) {
    const std::size_t all = deformer.clip_offsets_s.size(), count = std::min(all, kMostBoundOffsets);
    std::vector<double> offsets;
    for (std::size_t i = 0; i < count; ++i) offsets.push_back(deformer.clip_offsets_s[count > 1 ? i * (all - 1) / (count - 1) : 0]);
    return offsets;
}

/// Centre and scale that hold the mesh over the whole shot in all copies, as far as some times and copies tell.
void set_bounds(const BoundShot& shot, const Bindings& bindings, Deformer& deformer) {
    const std::vector<int>& frames = shot.timing().frames;
    const double begin = shot.sequence().frame(frames.front()).open_s, end = shot.sequence().frame(frames.back()).close_s;
    std::vector<glm::dvec3> corners;
    for (const double offset : bounding_offsets(deformer))
        for (int i = 0; i < kBoundTimes; ++i)
            add_corners(deformer, finite_pose(shot, bindings, deformer, std::lerp(begin, end, i / (kBoundTimes - 1.0)), offset), corners);
    glm::dvec3 low = corners.front(), high = low;
    for (const glm::dvec3& corner : corners) low = glm::min(low, corner), high = glm::max(high, corner);
    const glm::dvec3 half = 0.5 * (high - low);
    deformer.centre = 0.5 * (low + high);
    deformer.scale = std::max({half.x, half.y, half.z});
    if (!(deformer.scale > 0)) deformer.scale = 1;  // everything in one point
}

std::vector<double> offsets_of(std::span<const Placement> copies) {
    std::vector<double> offsets;
    for (const Placement& copy : copies) offsets.push_back(copy.clip_offset_s);
    if (offsets.empty()) offsets.push_back(0);
    std::sort(offsets.begin(), offsets.end());
    offsets.erase(std::unique(offsets.begin(), offsets.end()), offsets.end());
    return offsets;
}

/// @param copies  of the seed's file
Deformer make_deformer(const BoundShot& shot, const Bindings& bindings, const InstanceSeed& seed, std::span<const Placement> copies) {
    const Node& node = shot.scene().nodes[static_cast<std::size_t>(seed.mesh_node)];
    const GeometryData& geometry = shot.scene().geometries[seed.geometry];
    const bool skinned = node.skin >= 0 && geometry.skin.per_vertex > 0;
    Deformer deformer;
    deformer.mesh_node = seed.mesh_node;
    deformer.geometry = seed.geometry;
    if (skinned) deformer.skeleton = Skeleton(shot.scene(), node.skin);
    deformer.skinning = shot.shot().scenes[static_cast<std::size_t>(bindings.rig.file_of(seed.mesh_node))].skinning;
    deformer.boxes = boxes_of(geometry, skinned);
    deformer.target_sizes = target_sizes(geometry);
    deformer.clip_offsets_s = offsets_of(copies);
    if (!bindings.deformers.empty()) deformer.first_mesh = bindings.deformers.back().end_mesh();
    return deformer;
}

/// What one bent mesh takes: four keys of vertices, here and for the frame that is made ahead, and the structure over it.
/// A crowd of 1000 running foxes at as many offsets takes 590 kB each, for which this says 586.
double bytes_of_mesh(const GeometryData& geometry) {
    const double key = static_cast<double>(geometry.positions.size() * sizeof(kernels::Vertex) + geometry.tangents.size() * sizeof(kernels::Vec4f));
    return 8 * key + kStructureBytes * static_cast<double>(geometry.indices.size() / 3);
}

/// Copies at other times of their clips have vertices of their own.
void check_memory(const BoundShot& shot, const Bindings& bindings) {
    double total = 0, most = 0;
    const Deformer* worst = nullptr;
    for (const Deformer& deformer : bindings.deformers) {
        const double bytes = static_cast<double>(deformer.clip_offsets_s.size()) * bytes_of_mesh(shot.scene().geometries[deformer.geometry]);
        total += bytes;
        if (deformer.clip_offsets_s.size() > 1 && bytes > most) most = bytes, worst = &deformer;
    }
    if (total <= kMostBentBytes || !worst) return;
    const int file = bindings.rig.file_of(worst->mesh_node);
    const GeometryData& geometry = shot.scene().geometries[worst->geometry];
    throw InputError(problem_at(shot.shot().scenes.at(static_cast<std::size_t>(file)).instances->where,
                                fmt::format("the mesh of node '{}' ({} vertices) bends at {} clip offsets: all bending copies together take about {:.0f} GB",
                                            node_path(shot.scene(), file, worst->mesh_node), geometry.positions.size(), worst->clip_offsets_s.size(), total / 1e9),
                                fmt::format("expected at most {:.0f} GB: copies with equal offsets share their vertices, so give fewer different ones (offset_steps), or a coarser mesh",
                                            kMostBentBytes / 1e9)));
}

}  // namespace

void bind_deformers(const BoundShot& shot, std::span<const std::vector<Placement>> copies, Bindings& bindings) {
    for (InstanceSeed& seed : bindings.seeds) {
        if (!bends(shot.scene(), bindings.morphs, seed)) continue;
        seed.deformer = static_cast<int>(bindings.deformers.size());
        bindings.deformers.push_back(make_deformer(shot, bindings, seed, copies[static_cast<std::size_t>(bindings.rig.file_of(seed.mesh_node))]));
        if (bindings.deformers.back().skeleton) seed.node = bindings.deformers.back().skeleton->root();
    }
    check_memory(shot, bindings);
    for (Deformer& deformer : bindings.deformers) set_bounds(shot, bindings, deformer);
}

}  // namespace kadr
