// `kadr describe`: the manual of the format, from the schema table.
#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"
#include "shot/prices.h"
#include "shot/quality.h"
#include "shot/schema.h"
#include "shot/shot_parser.h"

namespace kadr {

namespace {

std::string type_text(const FieldSpec& field) {
    std::string text = field.forms == 0 ? "any value" : expectation(field);
    if (field.forms == kSection) text = "a map";
    if (field.forms & kTrack) text += "; may be a track";
    if (field.forms & kMotion) text += ", { path: ... } or { orbit: ... }";
    return text;
}

std::string summary(const FieldSpec& field) {
    if (!field.built) return fmt::format("{} (not supported yet)", field.doc);
    if (field.required) return fmt::format("{} (required)", field.doc);
    return *field.fallback ? fmt::format("{} (default: {})", field.doc, field.fallback) : field.doc;
}

void append_rows(std::string& text, std::string_view section, std::size_t indent) {
    const auto fields = fields_below(section);
    std::size_t width = 0;
    for (const FieldSpec* field : fields) width = std::max(width, key_of(*field).size());
    for (const FieldSpec* field : fields) {
        text += fmt::format("{:{}}{:<{}}  {}\n", "", indent, key_of(*field), width, summary(*field));
        append_rows(text, field->path, indent + 2);
    }
}

std::string units_text() {
    std::string text = "\nUnits (the first is that of a bare number)\n";
    constexpr std::pair<const char*, Quantity> kRows[] = {
        {"angles", Quantity::angle},
        {"times", Quantity::time},
        {"lengths", Quantity::length},
        {"lenses and sensors", Quantity::lens},
        {"pixels", Quantity::pixels},
        {"shutter", Quantity::frames},
        {"illuminance", Quantity::illuminance},
        {"intensity", Quantity::intensity},
        {"luminance", Quantity::luminance},
        {"power", Quantity::power},
        {"exposure", Quantity::stops},
        {"loudness", Quantity::gain},
    };
    for (const auto& [name, quantity] : kRows) text += fmt::format("  {:<18}  {}\n", name, unit_names(quantity));
    return text;
}

std::string whole_manual() {
    std::string text = "The shot file, format version 1. `kadr describe render.samples` tells more about one key.\n\n";
    append_rows(text, "", 0);
    text += "\nTracks: a value over time, wherever a field may be keyed\n";
    append_rows(text, "track", 2);
    text += "\nKeys of a track with more than a value\n";
    append_rows(text, "key", 2);
    text += "\nRotations about an axis\n";
    append_rows(text, "rotation", 2);
    text += "\nPositions that travel, wherever a position may be keyed\n";
    append_rows(text, "motion", 2);
    text += "\nOrbits\n";
    append_rows(text, "orbit", 2);
    text += "\nShake\n";
    append_rows(text, "shake", 2);
    text += "\nReels: a second kind of file, which lists shots and becomes one video; `kadr describe reel.shots`\n";
    append_rows(text, "reel", 2);
    return text + units_text();
}

std::string one_field(const FieldSpec& field) {
    std::string text = fmt::format("{}\n  {}\n\n", field.path, field.doc);
    if (!field.built)
        return text + "  not supported yet: the key is part of the format, but this version of Kadr cannot do it\n";
    text += fmt::format("  type     {}\n", type_text(field));
    if (field.quantity != Quantity::number && !natural_unit(field.quantity).empty())
        text += fmt::format("  units    {}\n", unit_names(field.quantity));
    if (field.required)
        text += "  required\n";
    else if (*field.fallback)
        text += fmt::format("  default  {}\n", field.fallback);
    if (*field.example) text += fmt::format("  example  {}\n", field.example);
    for (const Choice& choice : choices_of(field)) {
        if (!choice.built) text += fmt::format("  not supported yet: {}\n", choice.name);
    }
    if (!fields_below(field.path).empty()) {
        text += "\n  keys\n";
        append_rows(text, field.path, 4);
    }
    return text;
}

/// What somebody may have meant: the nearest path, or else the paths whose last part ("samples") is nearest.
std::vector<std::string> similar_paths(std::string_view key) {
    std::vector<std::string> paths, keys, result;
    for (const auto table : {schema_table(), reel_table()}) {
        for (const FieldSpec& field : table) {
            paths.emplace_back(field.path);
            keys.emplace_back(key_of(field));
        }
    }
    const auto path = nearest_name(key, paths);
    if (path) return {*path};
    const auto last = nearest_name(key, keys);
    for (std::size_t i = 0; last && i < keys.size(); ++i) {
        if (keys[i] == *last) result.push_back(paths[i]);
    }
    return result;
}

}  // namespace

std::string describe_schema(std::string_view key) {
    if (key.empty()) return whole_manual();
    if (key == "quality") return describe_quality();
    if (key == "prices") return describe_prices();
    if (const FieldSpec* field = find_field(key)) return one_field(*field);
    const auto similar = similar_paths(key);
    throw InputError(fmt::format("the shot format has no key '{}'", key),
                     similar.empty() ? "`kadr describe` lists all keys"
                                     : fmt::format("did you mean {}?", fmt::join(similar, " or ")));
}

}  // namespace kadr
