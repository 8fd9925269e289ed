#pragma once

#include <span>
#include <string>
#include <vector>

#include "anim/timing.h"
#include "anim/track.h"
#include "base/error.h"

namespace kadr {

struct Field;
struct FieldSpec;

/// What the values of a track have to keep to at every time, and keep to at its keys.
enum class Keep {
    range,      ///< every component the limits of its row
    sign,       ///< every component its sign: a scale cannot pass through zero
    direction,  ///< not all components are zero at once
    cone,       ///< of a spot's inner and outer half-angle the first is at most the second
};

/// A track of the shot whose values may do between or beyond its keys what they do not do there.
struct LimitedTrack {
    std::string name;            ///< "lights.key.intensity"
    Diagnostic place;            ///< where it stands, without words
    const FieldSpec* spec;       ///< its row of the format
    std::vector<Track<double>> components;
    Keep keep = Keep::range;
};

/// Notes a track of a field with limits that may leave them between or beyond its keys; its keys were checked.
void note_limits(const Field& field, const Track<double>& track);
void note_limits(const Field& field, const Track<glm::dvec2>& track);
void note_limits(const Field& field, const Track<glm::dvec3>& track);
/// As the first, with limits of its own: those of a row that has none. @param spec  outlives the shot
void note_limits(const Field& field, const Track<double>& track, const FieldSpec& spec);

/// Notes a track of scales or of directions, whose keys were checked not to be zero.
void note_scale(const Field& field, const Track<glm::dvec3>& track);
void note_direction(const Field& field, const Track<glm::dvec3>& track);
/// Notes the half-angles of a spot. @param field  that of the inner one
void note_cone(const Field& field, const Track<double>& inner, const Track<double>& outer);

/// One problem for each track that leaves its limits from the first opening of the shutter to its last closing, at its
/// farthest value, or does what else it may not, at the first time.
/// @param lead_s  how much earlier the values are already needed
std::vector<Diagnostic> values_out_of_range(std::span<const LimitedTrack> tracks, const Sequence& sequence, double lead_s = 0);
/// The same of a single frame, which need not be one of the shot's.
std::vector<Diagnostic> values_out_of_range(std::span<const LimitedTrack> tracks, const Timing& timing, const FrameTime& frame, double lead_s = 0);

}  // namespace kadr
