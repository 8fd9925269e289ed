#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"
#include "scene/scene.h"

namespace kadr {

/// The materials of a frame, and what they ask of the kernels.
class MaterialTable {
public:
    explicit MaterialTable(const Scene& scene) : scene_(scene) {}

    /// Takes the snapshot's materials. How a material covers (its alpha mode, its sides) never changes within a shot,
    /// so structures stay. @return whether everything emits what it did before
    bool set(const SceneSnapshot& snapshot);
    /// Notes what is shown: which materials, and whether some mesh has colours at its vertices. What is hidden, or has no
    /// triangles, asks for nothing.
    /// @param instances  those of the snapshot, in its order
    void note_shown(const SceneSnapshot& snapshot, std::span<const kernels::Instance> instances,
                    std::span<const kernels::Geometry> geometries);

    const kernels::Material* data() const { return materials_.empty() ? scene_.materials.data() : materials_.data(); }
    std::size_t count() const { return materials_.empty() ? scene_.materials.size() : materials_.size(); }
    /// What is shown needs of requirement::kMaps, kSpecials, kMirrors, kIor and kFresnel.
    unsigned requirements() const;

private:
    unsigned needs_of_lobe(const kernels::Material& shown) const;

    const Scene& scene_;
    std::vector<kernels::Material> materials_;  ///< of the snapshot; empty: the scene's
    std::vector<kernels::Vec3f> emissions_;     ///< [material] of the frame before
    std::vector<unsigned> shown_;               ///< materials, each once
    std::vector<std::optional<float>> least_green_;  ///< [texture] of those that are roughness on what was shown
    bool shows_colors_ = false, exact_fresnel_ = false;
};

/// Whether rays have to ask at every hit on this material: partial coverage, or faces to cull.
bool needs_filter(const kernels::Material& material, bool cull);

}  // namespace kadr
