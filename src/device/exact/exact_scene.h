#pragma once

#include <memory>
#include <vector>

#include "device/exact/box_tree.h"
#include "device/tables/emitter_tables.h"
#include "device/tables/environment_tables.h"
#include "device/tables/light_tables.h"
#include "device/tables/material_table.h"
#include "device/tables/packed_geometry.h"
#include "frame/frame_state.h"
#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// A tree of the boxes of a mesh's triangles. Needles have several, one a stretch: the one box of a needle that lies across
/// the axes would be met by most rays.
struct TriangleTree {
    BoxTree tree;
    std::vector<std::uint32_t> triangle_of;  ///< [box]
};

/// The meshes of a scene in their own coordinates; never change.
struct ExactMeshes {
    explicit ExactMeshes(const Scene& scene);

    std::vector<PackedGeometry> packed;      ///< [geometry]
    std::vector<kernels::Geometry> views;    ///< [geometry]
    std::vector<TriangleTree> trees;         ///< [geometry]
    std::vector<ExactBox> bounds;            ///< [geometry]
};

/// A shot at one moment, as kernels over double and ExactTracer read it: nothing moves, nothing is rounded to float but
/// what files hold in float, and what stands where comes from the tracks themselves, not from keys between which a device
/// interpolates.
class ExactScene {
public:
    /// All of them outlive it. @param snapshot  says what is shown, with which materials and environment
    ExactScene(const BoundShot& shot, const ExactMeshes& meshes, const EnvironmentTables& environment, const SceneSnapshot& snapshot);
    ExactScene(const ExactScene&) = delete;
    ExactScene& operator=(const ExactScene&) = delete;

    /// @param time  in [0, 1] of the snapshot's part of the shutter
    void move_to(double time);
    const kernels::SceneViewOf<double>& view() const { return view_; }

    struct Placed {
        glm::dmat4 object_from_world;
        bool shown = false;
    };
    const std::vector<Placed>& placed() const { return placed_; }  ///< [instance]
    const BoxTree& tree() const { return tree_; }                  ///< of the instances' boxes in the world
    const ExactMeshes& meshes() const { return meshes_; }

private:
    void place_instances(double time_s);
    glm::dmat4 space_from_geometry(const SnapshotInstance& instance, double time_s) const;

    const BoundShot& shot_;
    const ExactMeshes& meshes_;
    const SceneSnapshot& snapshot_;
    MaterialTable materials_;
    std::vector<kernels::Texture> textures_;
    std::vector<kernels::Instance> instances_;
    std::vector<kernels::InstanceMotion> motions_;
    std::vector<kernels::AffineOf<double>> matrices_;
    std::vector<Placed> placed_;
    BoxTree tree_;
    kernels::CameraKeyOf<double> camera_{};
    LightTablesOf<double> lights_;
    EmitterTablesOf<double> emitters_;
    kernels::SceneViewOf<double> view_{};
};

}  // namespace kadr
