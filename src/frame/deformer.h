#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "frame/skeleton.h"
#include "frame/skinning.h"

namespace kadr {

struct Bindings;
struct DeformedMesh;

/// Of the motion tolerance, what the vertices of a bending mesh may use up; its place has the rest.
inline constexpr double kDeformationShare = 0.5;

/// The vertices that one joint carries, in the coordinates of the geometry, before morphing.
struct JointBox {
    glm::dvec3 low{0}, high{0};
    std::size_t joint = 0;
};

/// What bends one primitive of one node: a skin, morph targets, or both.
///
/// Bent vertices are kept in coordinates of order 1, (position - centre) / scale, where position is in the coordinates of
/// the seed's node: of a skinned mesh the root of its skin, whose own motion stays with the instance.
struct Deformer {
    int mesh_node = -1;
    std::uint32_t geometry = 0;
    std::optional<Skeleton> skeleton;   ///< none: morph targets alone
    Skinning skinning = Skinning::linear;
    glm::dvec3 centre{0};
    double scale = 1;
    std::vector<JointBox> boxes;        ///< of joints that carry anything; without a skin the whole mesh
    std::vector<double> target_sizes;   ///< [morph target] longest difference of a position
    std::vector<double> clip_offsets_s{0};  ///< of its copies, each once, ascending: as many bent meshes
    std::uint32_t first_mesh = 0;           ///< number of the one with the first offset; those of all deformers are counted on

    std::uint32_t end_mesh() const { return first_mesh + static_cast<std::uint32_t>(clip_offsets_s.size()); }
    /// The pose at a time of the shot.
    DeformationPose pose(const Scene& scene, const Bindings& bindings, double time_s, double clip_offset_s = 0) const;
};

/// A deformer at one of its clip offsets: what copies with equal offsets share.
struct BentMesh {
    const Deformer* deformer = nullptr;
    double clip_offset_s = 0;
};

/// The last vertices of every bent mesh: what does not change is not computed again.
class DeformedCache {
public:
    std::shared_ptr<const DeformedMesh> find(std::uint32_t number, std::uint64_t version) const;
    void keep(std::shared_ptr<const DeformedMesh> mesh);

private:
    mutable std::mutex mutex_;
    std::map<std::uint32_t, std::shared_ptr<const DeformedMesh>> last_;
};

}  // namespace kadr
