#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "frame/frame_state.h"
#include "frame/render_space.h"
#include "frame/shared_list.h"
#include "kernels/camera/shutter.h"
#include "kernels/scene/motion_types.h"
#include "kernels/scene/scene_types.h"

namespace kadr {

/// What the frames of an instance are: SRT, or matrices where it is sheared.
enum class FrameType : std::uint8_t { srt, matrix };

/// Transforms of all instances over the shutter, in HIPRT's own layout: frames evenly spaced on [0, 1], in the render
/// space. HIPRT wants one type for the whole scene; here only what is sheared pays for matrices.
struct MotionFrames {
    SharedList<kernels::TransformHeader> headers;  ///< [instance] into srt or matrices
    SharedList<FrameType> types;                   ///< [instance]
    SharedList<kernels::FrameSrt> srt;
    SharedList<kernels::FrameMatrix> matrices;
    /// Whether matrices are interpolated linearly: where two of them already meet the motion tolerance, and where the shot asks
    /// for it; [instance].
    SharedList<std::uint8_t> linear;
    bool mixes_matrices = false;                    ///< the shot asks for it (render.motion_frames), whatever comes of it
    double widest_step_rad = 0;                     ///< between two frames of a fixed number; 0: at most 10 degrees
    double max_error_px = 0;                        ///< largest screen-space deviation from the true path
    double bending_error_px = 0;                    ///< the same of instances whose vertices bend, without their vertices
    std::uint32_t worst = 0;                        ///< index of the instance that has max_error_px
};

class VertexPose;

/// A mesh that bends, over the part of the shutter: its vertices at evenly spaced times of [0, 1], in the normalised
/// coordinates that world_from_geometry of its instances speaks of. Triangles, texture coordinates and colours are those
/// of its geometry. Never changes once made, so snapshots and devices share it.
struct DeformedMesh {
    std::uint32_t geometry = 0;              ///< index into Scene::geometries
    std::uint32_t number = 0;                ///< stable over the shot: equal numbers are the same mesh at the same clip offset
    std::uint32_t key_count = 1;             ///< one: it keeps its shape
    std::vector<kernels::Vertex> vertices;   ///< [key][vertex]
    std::vector<kernels::Vec4f> tangents;    ///< [key][vertex]; empty where the geometry has none
    /// [key] what vertices and tangents were made from (frame/skinning.h): a device may make them again, to the same
    /// bits, where they are needed. Null: they came from elsewhere.
    std::shared_ptr<const std::vector<VertexPose>> poses;
    std::uint64_t version = 0;               ///< equal for equal vertices of one number
    double error_px = 0;                     ///< largest deviation of the linear way between keys from the true one
};

struct SnapshotInstance {
    std::uint32_t geometry = 0, material = 0;  ///< indices into Scene
    std::uint32_t id = 0;                      ///< stable over the shot
    std::uint32_t mask = 0xffffffffu;
    std::int32_t deformed = -1;                ///< index into SceneSnapshot::deformed; -1: rigid
    /// Index into SceneSnapshot::fixed_places: it stands in the same place of the world in every frame of the shot, and a
    /// device may flatten it. -1: it moves, or is one of so many copies that flattening does not pay.
    std::int32_t fixed_place = -1;
};

/// A light over the shutter: keys evenly spaced on [0, 1]; one when it does not move.
struct LightKeys {
    std::uint32_t first = 0, count = 1;        ///< into SceneSnapshot::light_keys
};

struct EnvironmentSnapshot {
    kernels::Vec3f radiance{0, 0, 0};          ///< colour * strength, or the factor on the image
    std::optional<std::filesystem::path> image;
    float rotate_rad = 0;                      ///< about +y
    bool visible = true;
};

/// Where things were one frame earlier, at that frame's shutter opening: what the motion layer compares with.
struct PreviousPlaces {
    /// In the render space of the snapshot that holds them, of the instances that are its own: what snapshots share has
    /// not moved.
    std::vector<glm::dmat4> space_from_geometry;
    kernels::CameraKey camera{};                   ///< in that space, too
    std::vector<std::vector<kernels::Vec3f>> deformed;  ///< [deformed mesh][vertex]
};

/// What any device needs of one frame, or of one part of its shutter, and nothing else: float, in the frame's render
/// space. Lengths count in its units (candela and lumen with them); what devices say of lengths, the depth, does too.
///
/// Instances that look and stand the same throughout the shot come first; snapshots with the same render origin share
/// them, so a device that finds the object of the frame before need not look at it again.
struct SceneSnapshot {
    int frame_number = 0;
    double open_s = 0, close_s = 0;            ///< of this part of the shutter
    double weight = 1;                         ///< this part's share of the frame's light; the parts add up to 1
    kernels::Shutter shutter;                  ///< when that light arrives
    glm::dvec3 render_origin{0};               ///< metres
    double unit_m = 1;                         ///< of the coordinates that follow (RenderSpace)
    SharedList<SnapshotInstance> instances;
    SharedList<glm::dmat4> fixed_places;       ///< world_from_geometry, double, absolute
    MotionFrames motion;                       ///< headers parallel to instances
    /// The whole table [material] that replaces the scene's in this part; empty: the scene's own. Entries beyond the
    /// scene's are copies that single entries of the shot have changed.
    std::vector<kernels::Material> materials;
    std::vector<std::shared_ptr<const DeformedMesh>> deformed;
    std::vector<kernels::CameraKey> camera_keys;
    double camera_error_px = 0;                ///< largest deviation of the interpolated camera, for its subject
    kernels::Camera camera{};                  ///< keys pointer is null here; the device points it at its own copy
    std::vector<LightKeys> lights;
    std::vector<kernels::Light> light_keys;
    /// Largest deviation of interpolated lights from their true values: relative to the light's own radiance, cosine,
    /// size and range, in radians for directions, and relative to the subject's distance for positions. At most 1e-3
    /// unless 32 segments are too few.
    double light_error = 0;
    EnvironmentSnapshot environment;
    std::optional<PreviousPlaces> previous;    ///< only where the shot asks for the motion layer
    kernels::Settings settings;
    std::uint64_t still_key = 0;               ///< hash of what the lists share with other snapshots
    std::uint64_t geometry_key = 0;            ///< equal keys: instances and motion are those of the previous frame

    RenderSpace space() const { return {render_origin, unit_m}; }
};

/// The times inside (begin, end), ascending, at which anything that a snapshot holds jumps: a shutter is split there.
std::vector<double> shot_discontinuities(const BoundShot& shot, double begin_s, double end_s);

/// Parts that a continuous stretch of the shutter is split into at most, so that motion frames, the camera's keys and
/// those of lights meet their tolerances; no part gets less than one sample. Spins alone may go beyond.
inline constexpr int kMostPartsForError = 32;

/// The snapshots of one frame: one, or several where the shutter has to be split: where something jumps, turns faster than
/// 129 motion frames follow, or strays farther than the motion tolerance.
/// @throws InputError  where the motion cannot be represented (a zero scale, half a turn between keys)
std::vector<SceneSnapshot> make_snapshots(const BoundShot& shot, const FrameTime& frame);

}  // namespace kadr
