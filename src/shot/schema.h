#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shot/units.h"

namespace kadr {

/// The forms a value may take; a field allows one or several.
enum Form : unsigned {
    kText = 1u << 0,
    kPath = 1u << 1,  ///< of a file, relative to the text that names it
    kBoolean = 1u << 2,
    kInteger = 1u << 3,
    kNumber = 1u << 4,     ///< of the field's quantity
    kVector2 = 1u << 5,    ///< [a, b] of the quantity
    kVector3 = 1u << 6,    ///< [x, y, z] of the quantity
    kRotation = 1u << 7,   ///< [x, y, z] in degrees, a quaternion, or { axis, angle }
    kChoice = 1u << 8,     ///< one word of `choices`
    kNode = 1u << 9,       ///< "scene", "scene/Node"
    kSection = 1u << 10,   ///< a map, whose keys are the rows below this path
    kSections = 1u << 11,  ///< a list of such maps
    kTexts = 1u << 12,     ///< a list of texts
    kFrames = 1u << 13,    ///< 0-95, "5,9,12-20"
    kRational = 1u << 14,  ///< 24, 23.976, 24000/1001
    kKeys = 1u << 15,      ///< a map of times to values
    kSize2 = 1u << 16,     ///< [width, height], whole numbers
    kRange = 1u << 17,     ///< [least, largest] of the quantity
    kNamedSections = 1u << 20,  ///< a map of names to maps, whose keys are the rows below this path
    kPoints = 1u << 27,    ///< a list of [x, y, z]
    kMotion = 1u << 28,    ///< a position that may travel: the rows below `motion`
    kOrbit = 1u << 29,     ///< the rows below `orbit`
    kShake = 1u << 30,     ///< the rows below `shake`
    kWeights = 1u << 21,        ///< a map of names to weights, each of which may be keyed over time
    kNumberList = 1u << 22,   ///< a list of numbers of the quantity, one or more
    kTrack = 1u << 31,     ///< each of the forms may be keyed over time
};

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// As `low`: any positive number.
inline constexpr double kAboveZero = std::numeric_limits<double>::denorm_min();

/// One key of the format. The parser's checks, `kadr describe` and the JSON Schema all read this row.
struct FieldSpec {
    const char* path;  ///< "render.samples"; keys of list items stand under their list: "lights.color"
    unsigned forms = 0;
    Quantity quantity = Quantity::number;
    double low = -kInfinity, high = kInfinity;  ///< inclusive, in the natural unit; of every component
    const char* choices = "";                   ///< "a|b|!c" in the order of the enum; '!' marks what is not built yet
    const char* fallback = "";                  ///< default, as one would write it; empty: none
    const char* doc = "";
    const char* example = "";
    const char* hint = "";  ///< what to do when the value is out of range
    bool required = false;
    bool built = true;  ///< false: known to the format, refused by name
};

/// Every key of a shot file, sections before their keys.
std::span<const FieldSpec> schema_table();

/// Every key of a reel file, below "reel": "reel.shots.in".
std::span<const FieldSpec> reel_table();

/// A row of either table. @return null for a path the format does not have
const FieldSpec* find_field(std::string_view path);

/// Rows directly below a section ("" for the top), in the table's order.
std::vector<const FieldSpec*> fields_below(std::string_view section);

/// Sections of values wherever a row's forms allow them, not of a shot: track, key, rotation, ...
bool is_grammar(std::string_view section);

/// Last part of the path.
std::string_view key_of(const FieldSpec& field);

struct Choice {
    std::string name;
    bool built = true;
};
std::vector<Choice> choices_of(const FieldSpec& field);

/// "none", "one of direct, path": the choices that are built.
std::string choices_text(const FieldSpec& field);

/// "0 to 360 deg", "at least 1 px", "more than 0", or empty where anything goes.
std::string range_text(const FieldSpec& field);

/// What a field takes, to follow "expected ": "a whole number from 1 to 1048576", "one of direct, path".
std::string expectation(const FieldSpec& field);

}  // namespace kadr
