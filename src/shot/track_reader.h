#pragma once

#include <optional>
#include <vector>

#include "anim/track.h"
#include "shot/section.h"
#include "shot/shot.h"

namespace kadr {

/// A constant or `{ keys: { time: value }, interpolate: ... }`.
std::optional<Track<double>> read_number_track(const Field& field);
std::optional<Track<glm::dvec2>> read_vector2_track(const Field& field);
std::optional<Track<glm::dvec3>> read_vector3_track(const Field& field);
/// As read_vector3_track, and no key's vector may be zero: a direction.
std::optional<Track<glm::dvec3>> read_direction_track(const Field& field);
/// One factor or three at each key, none zero.
std::optional<Track<glm::dvec3>> read_scale_track(const Field& field);
/// true, false, or keys of them, which only jump.
std::optional<SwitchTrack> read_switch_track(const Field& field);
/// One weight for each morph target, or a track of such lists: a track for each target, all with the same keys. Empty where
/// the field is absent or wrong.
std::vector<Track<double>> read_weight_tracks(const Field& field);
/// [x, y, z] degrees, a quaternion, `{ axis, angle }`, or a track of the first two.
std::optional<RotationTrack> read_rotation_track(const Field& field);
/// A point, a track of points, `{ path: ... }` or `{ orbit: ... }`.
/// @param may_turn  whether `orient: along` makes sense
std::optional<PositionTrack> read_position_track(const Field& field, bool may_turn = false);
/// An orbit; `around` may be a node where there is a place for it.
std::optional<OrbitMotion> read_orbit(const Field& field, std::optional<NodeReference>* around_node = nullptr);
std::optional<Shake> read_shake(const Field& field);
/// A point, a track of points, or a node.
std::optional<Target> read_target(const Field& field);
std::optional<NodeReference> read_node(const Field& field);

}  // namespace kadr
