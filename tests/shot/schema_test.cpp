#include "shot/schema.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "shot/shot.h"
#include "shot/shot_parser.h"

namespace kadr {
namespace {

using ::testing::HasSubstr;

TEST(Schema, HasEachKeyOnceAndBelowASection) {
    std::set<std::string> seen;
    for (const FieldSpec& field : schema_table()) {
        const std::string path = field.path;
        EXPECT_TRUE(seen.insert(path).second) << path;
        EXPECT_NE(std::string(field.doc), "") << path;
        const std::size_t dot = path.rfind('.');
        EXPECT_TRUE(dot == std::string::npos || seen.count(path.substr(0, dot))) << path;
        EXPECT_TRUE(!field.built || *field.example) << path;
    }
}

TEST(Schema, DescribesEveryKey) {
    const std::string manual = describe_schema("");
    for (const FieldSpec& field : schema_table()) {
        EXPECT_THAT(describe_schema(field.path), HasSubstr(field.doc)) << field.path;
        const bool heading = is_grammar(field.path);
        EXPECT_TRUE(heading || manual.find(field.doc) != std::string::npos) << field.path;
    }
}

TEST(Schema, DescribesOneKeyLikeThis) {
    EXPECT_EQ(describe_schema("shutter.angle"),
              "shutter.angle\n"
              "  part of the frame during which the shutter is open; 360 deg is all of it\n"
              "\n"
              "  type     0 to 360 deg\n"
              "  units    deg, rad\n"
              "  default  180 deg\n"
              "  example  angle: 180 deg\n");
    EXPECT_EQ(describe_schema("render.samples.max_error"),
              "render.samples.max_error\n"
              "  sample each pixel until its standard error is below this, in values of the display (0 to 1)\n"
              "\n"
              "  type     1e-06 to 1\n"
              "  example  max_error: 0.01\n");
}

std::string unknown(std::string_view key) {
    try {
        return describe_schema(key);
    } catch (const InputError& error) {
        return error.what();
    }
}

TEST(Schema, HelpsWithUnknownKeys) {
    EXPECT_EQ(unknown("render.sampels"),
              "error: the shot format has no key 'render.sampels'\n  did you mean render.samples?");
    EXPECT_EQ(unknown("look_at"),
              "error: the shot format has no key 'look_at'\n  did you mean camera.look_at or lights.look_at?");
    EXPECT_EQ(unknown("xyzzy"), "error: the shot format has no key 'xyzzy'\n  `kadr describe` lists all keys");
}

/// Where a path stands in the JSON Schema, through maps, lists and alternatives.
const nlohmann::json* step_into(const nlohmann::json& schema, const std::string& key) {
    if (schema.contains("properties") && schema["properties"].contains(key)) return &schema["properties"][key];
    if (schema.contains("items")) {
        if (const auto* found = step_into(schema["items"], key)) return found;
    }
    if (schema.contains("additionalProperties") && schema["additionalProperties"].is_object()) {
        if (const auto* found = step_into(schema["additionalProperties"], key)) return found;
    }
    if (!schema.contains("anyOf")) return nullptr;
    for (const auto& form : schema["anyOf"]) {
        if (const auto* found = step_into(form, key)) return found;
    }
    return nullptr;
}

TEST(Schema, JsonHasEveryKey) {
    const nlohmann::json schema = nlohmann::json::parse(schema_as_json());
    EXPECT_EQ(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    EXPECT_EQ(schema["required"], (nlohmann::json{"kadr", "scenes", "camera"}));
    for (const FieldSpec& field : schema_table()) {
        const std::string path = field.path;
        const bool grammar = is_grammar(path.substr(0, path.find('.')));
        if (grammar || path.starts_with("render.samples."))
            continue;  // no values of a shot that can be written
        const nlohmann::json* at = &schema;
        for (std::size_t begin = 0; at && begin <= path.size();) {
            const std::size_t end = std::min(path.find('.', begin), path.size());
            at = step_into(*at, path.substr(begin, end - begin));
            begin = end + 1;
        }
        ASSERT_TRUE(at) << path;
        EXPECT_THAT((*at)["description"].get<std::string>(), HasSubstr(field.doc)) << path;
    }
    EXPECT_TRUE(schema["$defs"]["rotation"]["properties"].contains("axis"));
    EXPECT_EQ(schema["$defs"]["motion"]["properties"]["orbit"]["$ref"], "#/$defs/orbit");
    EXPECT_EQ(schema["properties"]["camera"]["properties"]["shake"]["$ref"], "#/$defs/shake");
}

// Words of the table stand in the order of the enums that they become.
TEST(Schema, ChoicesAreInTheOrderOfTheirEnums) {
    const auto name = [](const char* path, auto value) {
        return choices_of(*find_field(path))[static_cast<std::size_t>(value)].name;
    };
    EXPECT_EQ(name("lights.type", LightKind::spot), "spot");
    EXPECT_EQ(name("lights.type", LightKind::area), "area");
    EXPECT_EQ(name("lights.falloff", SpotFalloff::blender), "blender");
    EXPECT_EQ(name("camera.sensor.fit", CameraSpec::Fit::vertical), "vertical");
    EXPECT_EQ(name("render.integrator", Integrator::path), "path");
    EXPECT_EQ(name("render.filter", FilterKind::blackman_harris), "blackman-harris");
    EXPECT_EQ(name("render.filter.type", FilterKind::mitchell), "mitchell");
    EXPECT_EQ(name("view.transform", ViewTransform::pbr_neutral), "pbr-neutral");
    EXPECT_EQ(name("output.aovs", Aov::error), "error");
    EXPECT_EQ(name("output.aovs", Aov::motion), "motion");
    EXPECT_EQ(name("output.video.codec", VideoCodec::gif), "gif");
    EXPECT_EQ(name("output.video.codec", VideoCodec::vp9), "vp9");
    EXPECT_EQ(name("track.interpolate", Interpolation::cubic), "cubic");
}

}  // namespace
}  // namespace kadr
