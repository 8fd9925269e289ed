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

/// A track of the shot whose values may leave the range that its keys keep, and what its row of the format allows.
struct LimitedTrack {
    std::string name;            ///< "lights.key.intensity"
    Diagnostic place;            ///< where it stands, without words
    const FieldSpec* spec;       ///< whose limits hold for every component
    std::vector<Track<double>> components;
};

/// Notes a track of a field with limits that may leave them between or beyond its keys; its keys were checked.
void note_limits(const Field& field, const Track<double>& track);
void note_limits(const Field& field, const Track<glm::dvec2>& track);
void note_limits(const Field& field, const Track<glm::dvec3>& track);
/// As the first, with limits of its own: those of a row that has none. @param spec  outlives the shot
void note_limits(const Field& field, const Track<double>& track, const FieldSpec& spec);

/// One problem for each track that leaves its limits from the first opening of the shutter to its last closing, at its
/// farthest value.
/// @param lead_s  how much earlier the values are already needed
std::vector<Diagnostic> values_out_of_range(std::span<const LimitedTrack> tracks, const Sequence& sequence, double lead_s = 0);

}  // namespace kadr
