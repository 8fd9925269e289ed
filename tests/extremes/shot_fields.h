#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shot/schema.h"
#include "shot/shot_parser.h"

namespace kadr::test {

/// A number in a shot or in a reel: what `--set` it takes to put one there.
struct NumberSlot {
    std::string field;               ///< of the schema table
    std::string path;                ///< what is set
    std::string before, after;       ///< the text of its value around the number
    std::string ordinary;            ///< a number that belongs there
    ShotOverrides with(const std::string& number) const;
};

/// Every place of a field that takes a number: as it is, in each unit, in a list, in a rotation, as a time or a value of keys.
std::vector<NumberSlot> slots_of(const FieldSpec& field);
/// Whether the field holds numbers of its own.
bool has_numbers(const FieldSpec& field);

/// The shot around them: of scene.gltf (full_scene.h), "rig" and "ground", with one light of each kind. Frame 12 at 24 a second
/// lies between keys at 0 s and 1 s.
std::string shot_around_slots();
/// The reel around those of the reel's own table: of shot.yaml, twice.
std::string reel_around_slots();

}  // namespace kadr::test
