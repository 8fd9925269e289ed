// `kadr describe --json-schema`: the format for editors, from the schema table.
#include <cmath>
#include <nlohmann/json.hpp>

#include "shot/schema.h"
#include "shot/shot_parser.h"

namespace kadr {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kDraft = "https://json-schema.org/draft/2020-12/schema";

Json section_schema(std::string_view path);

Json number_schema(const FieldSpec& field, const char* type) {
    Json schema{{"type", type}};
    if (field.low == kAboveZero)
        schema["exclusiveMinimum"] = 0;
    else if (std::isfinite(field.low))
        schema["minimum"] = field.low;
    if (std::isfinite(field.high)) schema["maximum"] = field.high;
    return schema;
}

/// A number with one of the quantity's units, as text.
Json with_unit_schema(const FieldSpec& field) {
    std::string units;
    for (const UnitSpec& unit : unit_table()) {
        if (unit.quantity != field.quantity) continue;
        if (!units.empty()) units += '|';
        units += unit.name;
    }
    std::string pattern = "^[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)?";
    if (field.quantity == Quantity::time) pattern += "(/[0-9]+\\.?[0-9]*)?";
    pattern += " ?(";
    pattern += units;
    pattern += ")$";
    return {{"type", "string"}, {"pattern", std::move(pattern)}};
}

Json any_of(std::vector<Json> forms) {
    if (forms.size() == 1) return forms.front();
    Json schema;
    for (Json& form : forms) schema["anyOf"].push_back(std::move(form));
    return schema;
}

Json component_schema(const FieldSpec& field) {
    std::vector<Json> forms{number_schema(field, "number")};
    if (field.quantity != Quantity::number) forms.push_back(with_unit_schema(field));
    return any_of(std::move(forms));
}

Json list_schema(Json item, int size) {
    return {{"type", "array"}, {"items", std::move(item)}, {"minItems", size}, {"maxItems", size}};
}

Json words_schema(const FieldSpec& field) {
    Json words = Json::array();
    for (const Choice& choice : choices_of(field)) {
        if (choice.built) words.push_back(choice.name);
    }
    return {{"enum", std::move(words)}};
}

Json rotation_schema(const FieldSpec& field) {
    return any_of({list_schema(component_schema(field), 3),
                   list_schema({{"type", "number"}}, 4),
                   {{"$ref", "#/$defs/rotation"}}});
}

Json frames_schema() {
    const Json text{{"type", "string"},
                    {"pattern", "^ *-?[0-9]+(--?[0-9]+)?(x[0-9]+)?( *, *-?[0-9]+(--?[0-9]+)?(x[0-9]+)?)* *$"}};
    const Json number{{"type", "integer"}};
    const Json list{{"type", "array"}, {"items", any_of({number, text})}, {"minItems", 1}};
    return any_of({number, text, list});
}

Json texts_schema(const FieldSpec& field) {
    Json item = field.forms & kChoice ? words_schema(field) : Json{{"type", "string"}};
    return {{"type", "array"}, {"items", std::move(item)}};
}

Json track_schema(const Json& value);

Json weights_schema(const FieldSpec&) {
    const Json weight{{"type", "number"}, {"minimum", 0}};
    return {{"type", "object"}, {"minProperties", 1}, {"additionalProperties", any_of({weight, track_schema(weight)})}};
}

using FormSchema = Json (*)(const FieldSpec&);
struct FormRow {
    unsigned form;
    FormSchema schema;
};
const FormRow kFormRows[] = {
    {kText | kPath | kNode,
     [](const FieldSpec&) {
         return Json{{"type", "string"}, {"minLength", 1}};
     }},
    {kBoolean,
     [](const FieldSpec&) {
         return Json{{"type", "boolean"}};
     }},
    {kInteger, [](const FieldSpec& field) { return number_schema(field, "integer"); }},
    {kNumber, [](const FieldSpec& field) { return component_schema(field); }},
    {kVector2 | kSize2 | kRange, [](const FieldSpec& field) { return list_schema(component_schema(field), 2); }},
    {kVector3, [](const FieldSpec& field) { return list_schema(component_schema(field), 3); }},
    {kNumberList,
     [](const FieldSpec& field) {
         return Json{{"type", "array"}, {"items", component_schema(field)}, {"minItems", 1}};
     }},
    {kRotation, rotation_schema},
    {kChoice, words_schema},
    {kSection, [](const FieldSpec& field) { return section_schema(field.path); }},
    {kSections,
     [](const FieldSpec& field) {
         return Json{{"type", "array"}, {"items", section_schema(field.path)}};
     }},
    {kNamedSections,
     [](const FieldSpec& field) {
         return Json{{"type", "object"}, {"additionalProperties", section_schema(field.path)}};
     }},
    {kWeights, weights_schema},
    {kTexts, texts_schema},
    {kFrames, [](const FieldSpec&) { return frames_schema(); }},
    {kRational,
     [](const FieldSpec&) {
         return any_of(
             {{{"type", "number"}, {"exclusiveMinimum", 0}}, {{"type", "string"}, {"pattern", "^[0-9]+/[0-9]+$"}}});
     }},
    {kPoints,
     [](const FieldSpec& field) {
         return Json{{"type", "array"}, {"items", list_schema(component_schema(field), 3)}, {"minItems", 2}};
     }},
    {kOrbit,
     [](const FieldSpec&) {
         return Json{{"$ref", "#/$defs/orbit"}};
     }},
    {kShake,
     [](const FieldSpec&) {
         return Json{{"$ref", "#/$defs/shake"}};
     }},
    {kKeys,
     [](const FieldSpec&) {
         return Json{{"type", "object"}, {"minProperties", 1}};
     }},
};

/// The track grammar around a value's own schema.
Json track_schema(const Json& value) {
    Json key = section_schema("key");
    key["properties"]["value"] = value;
    Json track = section_schema("track");
    track["properties"]["keys"]["additionalProperties"] = any_of({value, key});
    return track;
}

Json value_schema(const FieldSpec& field) {
    if (!field.built) return {{"const", nullptr}};
    std::vector<Json> forms;
    for (const FormRow& row : kFormRows) {
        if (field.forms & row.form) forms.push_back(row.schema(field));
    }
    // What the table describes with words, because the reader decides by looking at the value.
    const std::string_view path = field.path;
    if (path == "shutter") forms.push_back({{"const", 0}});
    if (path == "key.ease" || path == "motion.ease" || path == "orbit.ease") forms.push_back(list_schema({{"type", "number"}}, 4));
    if (path == "scenes") forms.front()["items"] = any_of({forms.front()["items"], {{"type", "string"}}});
    if (path == "reel.shots") forms.front()["items"] = any_of({forms.front()["items"], {{"type", "string"}}});
    if (path == "output.video" || path == "reel.output.video") forms.push_back({{"const", "none"}});
    if (forms.empty()) return Json::object();
    Json value = any_of(std::move(forms));
    if (field.forms & kMotion) return any_of({value, track_schema(value), {{"$ref", "#/$defs/motion"}}});
    return field.forms & kTrack ? any_of({value, track_schema(value)}) : value;
}

Json documented(const FieldSpec& field) {
    Json schema{{"description", std::string(field.doc) + (field.built ? "" : " (not supported yet)")}};
    if (*field.fallback)
        schema["description"] = schema["description"].get<std::string>() + " (default: " + field.fallback + ")";
    schema.update(value_schema(field));
    return schema;
}

Json section_schema(std::string_view path) {
    Json schema{{"type", "object"}, {"additionalProperties", false}};
    for (const FieldSpec* field : fields_below(path)) {
        schema["properties"][std::string(key_of(*field))] = documented(*field);
        if (field->required) schema["required"].push_back(std::string(key_of(*field)));
    }
    return schema;
}

std::string reel_schema_as_json() {
    Json schema{{"$schema", kDraft}, {"title", "Kadr reel, format version 1"}};
    schema.update(section_schema("reel"));
    schema["properties"]["kadr-reel"]["const"] = 1;
    return schema.dump(2) + "\n";
}

}  // namespace

std::string schema_as_json(std::string_view kind) {
    if (kind == "reel") return reel_schema_as_json();
    Json schema{{"$schema", kDraft}, {"title", "Kadr shot, format version 1"}};
    schema.update(section_schema(""));
    schema["properties"]["kadr"]["const"] = 1;
    for (const char* grammar : {"rotation", "motion", "orbit", "shake"}) schema["$defs"][grammar] = section_schema(grammar);
    return schema.dump(2) + "\n";
}

}  // namespace kadr
