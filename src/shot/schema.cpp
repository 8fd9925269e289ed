#include "shot/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/text.h"

namespace kadr {

namespace {

std::string_view parent_of(std::string_view path) {
    const std::size_t dot = path.rfind('.');
    return dot == std::string_view::npos ? std::string_view{} : path.substr(0, dot);
}

std::string with_unit(double value, const FieldSpec& field) {
    const std::string_view unit = natural_unit(field.quantity);
    return unit.empty() ? format_number(value) : fmt::format("{} {}", format_number(value), unit);
}

std::string joined(const std::vector<std::string>& parts, std::string_view between) {
    return fmt::format("{}", fmt::join(parts, between));
}

std::string number_text(const FieldSpec& field) {
    const std::string range = range_text(field);
    if (!range.empty()) return range;
    const std::string_view unit = natural_unit(field.quantity);
    return unit.empty() ? "a number" : fmt::format("a number of {}", unit);
}

std::string integer_text(const FieldSpec& field) {
    if (std::isinf(field.low)) return "a whole number";
    return fmt::format("a whole number from {} to {}", format_number(field.low), format_number(field.high));
}

/// "a map of radius, height, ..."
std::string map_text(std::string_view section) {
    std::vector<std::string> keys;
    for (const FieldSpec* below : fields_below(section)) {
        if (below->built) keys.emplace_back(key_of(*below));
    }
    return fmt::format("a map of {}", joined(keys, ", "));
}

std::string components_text(std::string_view shape, const FieldSpec& field) {
    const std::string range = range_text(field);
    return range.empty() ? fmt::format("{}", shape) : fmt::format("{}, each {}", shape, range);
}

using FormText = std::string (*)(const FieldSpec&);
struct FormRow {
    unsigned form;
    FormText text;
};

/// How each form is called, in the order in which a list of them reads best.
constexpr FormRow kFormRows[] = {
    {kInteger, integer_text},
    {kNumber, number_text},
    {kSize2, [](const FieldSpec&) -> std::string { return "[width, height], whole numbers from 1 to 65536"; }},
    {kNumberList, [](const FieldSpec& field) { return components_text("a list of numbers such as [0, 1]", field); }},
    {kVector2, [](const FieldSpec& field) { return components_text("[width, height]", field); }},
    {kRange, [](const FieldSpec& field) { return components_text("[least, largest]", field); }},
    {kVector3, [](const FieldSpec& field) { return components_text("[x, y, z]", field); }},
    {kRotation,
     [](const FieldSpec&) -> std::string {
         return "[x, y, z] in degrees, a quaternion [x, y, z, w] or { axis, angle }";
     }},
    {kBoolean, [](const FieldSpec&) -> std::string { return "true or false"; }},
    {kRational, [](const FieldSpec&) -> std::string { return "frames a second, such as 24, 23.976 or 24000/1001"; }},
    {kFrames, [](const FieldSpec&) -> std::string { return "frames such as 0-95, 0-95x2 or \"5,9,12-20\""; }},
    {kText, [](const FieldSpec&) -> std::string { return "a text"; }},
    {kPath, [](const FieldSpec&) -> std::string { return "a file path"; }},
    {kTexts, [](const FieldSpec&) -> std::string { return "a list"; }},
    {kChoice, choices_text},
    {kNode, [](const FieldSpec&) -> std::string { return "a node such as scene/Node"; }},
    {kKeys, [](const FieldSpec&) -> std::string { return "a map of times to values such as { 0 s: 1, 24 f: 2 }"; }},
    {kPoints, [](const FieldSpec&) -> std::string { return "a list of points [x, y, z]"; }},
    {kOrbit, [](const FieldSpec&) { return map_text("orbit"); }},
    {kShake, [](const FieldSpec&) { return map_text("shake"); }},
    {kWeights, [](const FieldSpec&) -> std::string { return "a map of names to weights such as { Walk: 0.3, Run: 0.7 }"; }},
    {kNamedSections,
     [](const FieldSpec& field) {
         std::vector<std::string> keys;
         for (const FieldSpec* below : fields_below(field.path)) keys.emplace_back(key_of(*below));
         return fmt::format("a map of names to maps of {}", joined(keys, ", "));
     }},
    {kSections, [](const FieldSpec&) -> std::string { return "a list of maps"; }},
};

}  // namespace

const FieldSpec* find_field(std::string_view path) {
    for (const auto table : {schema_table(), reel_table()}) {
        for (const FieldSpec& field : table) {
            if (path == field.path) return &field;
        }
    }
    return nullptr;
}

bool is_grammar(std::string_view section) {
    constexpr std::string_view kGrammar[] = {"track", "key", "rotation", "motion", "orbit", "shake"};
    return std::find(std::begin(kGrammar), std::end(kGrammar), section) != std::end(kGrammar);
}

std::vector<const FieldSpec*> fields_below(std::string_view section) {
    std::vector<const FieldSpec*> fields;
    for (const FieldSpec& field : section.starts_with("reel") ? reel_table() : schema_table()) {
        const std::string_view path = field.path;
        if (parent_of(path) == section && !(section.empty() && is_grammar(path))) fields.push_back(&field);
    }
    return fields;
}

std::string_view key_of(const FieldSpec& field) {
    const std::string_view path = field.path;
    const std::size_t dot = path.rfind('.');
    return dot == std::string_view::npos ? path : path.substr(dot + 1);
}

std::vector<Choice> choices_of(const FieldSpec& field) {
    std::vector<Choice> choices;
    std::string_view rest = field.choices;
    while (!rest.empty()) {
        const std::size_t bar = rest.find('|');
        std::string_view name = rest.substr(0, bar);
        const bool built = !name.starts_with('!');
        if (!built) name.remove_prefix(1);
        choices.push_back({std::string(name), built});
        rest = bar == std::string_view::npos ? std::string_view{} : rest.substr(bar + 1);
    }
    return choices;
}

std::string choices_text(const FieldSpec& field) {
    std::vector<std::string> names;
    for (const Choice& choice : choices_of(field)) {
        if (choice.built) names.push_back(choice.name);
    }
    return names.size() == 1 ? names.front() : fmt::format("one of {}", joined(names, ", "));
}

std::string range_text(const FieldSpec& field) {
    const bool open = field.low == kAboveZero;
    if (open && std::isinf(field.high)) return "more than " + with_unit(0, field);
    if (open) return fmt::format("more than 0 and at most {}", with_unit(field.high, field));
    if (std::isinf(field.low)) return std::isinf(field.high) ? "" : "at most " + with_unit(field.high, field);
    if (std::isinf(field.high)) return "at least " + with_unit(field.low, field);
    return fmt::format("{} to {}", format_number(field.low), with_unit(field.high, field));
}

std::string expectation(const FieldSpec& field) {
    std::vector<std::string> parts;
    for (const FormRow& row : kFormRows) {
        if (field.forms & row.form) parts.push_back(row.text(field));
    }
    if (field.forms & kSection) parts.push_back(map_text(field.path));
    if (parts.empty()) return "a value";
    return joined(parts, " or ");
}

}  // namespace kadr
