#include "scene/gltf_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string_view>

#include "base/text.h"

namespace kadr {

namespace {

using nlohmann::json;

constexpr std::size_t kMostProblems = 20;       // a broken file has thousands; the first tell enough
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargestCount = 2147483648.0;  // 2^31 elements
constexpr double kLargestSize = 4294967296.0;   // 4 GiB: GLB cannot hold more

enum class Type { integer, index, number, string, boolean, numbers, indices, strings, object, objects, index_map, index_maps };

/// One property of one kind of glTF object.
struct Property {
    std::string_view owner;      ///< kind of the object that holds it
    std::string_view key;
    Type type;
    std::string_view of = {};    ///< index, indices: the collection; object, objects: the kind; string: allowed values by '|'
    bool required = false;
    double min = -kInfinity, max = kInfinity;
    std::size_t length = 0;      ///< of arrays; 0: any
};

constexpr bool kRequired = true, kOptional = false;

// Source: glTF 2.0 specification, section 5 (Properties Reference), and the extensions' own schemas.
constexpr Property kProperties[] = {
    {"root", "asset", Type::object, "asset", kRequired},
    {"root", "scene", Type::index, "scenes"},
    {"root", "extensionsUsed", Type::strings},
    {"root", "extensionsRequired", Type::strings},
    {"root", "accessors", Type::objects, "accessor"},
    {"root", "animations", Type::objects, "animation"},
    {"root", "buffers", Type::objects, "buffer"},
    {"root", "bufferViews", Type::objects, "buffer_view"},
    {"root", "cameras", Type::objects, "camera"},
    {"root", "images", Type::objects, "image"},
    {"root", "materials", Type::objects, "material"},
    {"root", "meshes", Type::objects, "mesh"},
    {"root", "nodes", Type::objects, "node"},
    {"root", "samplers", Type::objects, "sampler"},
    {"root", "scenes", Type::objects, "scene"},
    {"root", "skins", Type::objects, "skin"},
    {"root", "textures", Type::objects, "texture"},
    {"root", "extensions", Type::object, "root_extensions"},
    {"root_extensions", "KHR_lights_punctual", Type::object, "light_list"},
    {"light_list", "lights", Type::objects, "light"},
    {"root_extensions", "KHR_materials_variants", Type::object, "variant_list"},
    {"variant_list", "variants", Type::objects, "variant", kRequired},
    {"variant", "name", Type::string, {}, kRequired},

    {"asset", "version", Type::string, {}, kRequired},
    {"asset", "minVersion", Type::string},

    {"accessor", "bufferView", Type::index, "bufferViews"},
    {"accessor", "byteOffset", Type::integer, {}, kOptional, 0, kLargestSize},
    {"accessor", "componentType", Type::integer, {}, kRequired, 5120, 5126},
    {"accessor", "normalized", Type::boolean},
    {"accessor", "count", Type::integer, {}, kRequired, 1, kLargestCount},
    {"accessor", "type", Type::string, "SCALAR|VEC2|VEC3|VEC4|MAT2|MAT3|MAT4", kRequired},
    {"accessor", "sparse", Type::object, "sparse"},
    {"sparse", "count", Type::integer, {}, kRequired, 1, kLargestCount - 1},
    {"sparse", "indices", Type::object, "sparse_indices", kRequired},
    {"sparse", "values", Type::object, "sparse_values", kRequired},
    {"sparse_indices", "bufferView", Type::index, "bufferViews", kRequired},
    {"sparse_indices", "byteOffset", Type::integer, {}, kOptional, 0, kLargestCount - 1},
    {"sparse_indices", "componentType", Type::integer, {}, kRequired, 5121, 5125},
    {"sparse_values", "bufferView", Type::index, "bufferViews", kRequired},
    {"sparse_values", "byteOffset", Type::integer, {}, kOptional, 0, kLargestCount - 1},

    {"animation", "name", Type::string},
    {"animation", "channels", Type::objects, "channel", kRequired},
    {"animation", "samplers", Type::objects, "animation_sampler", kRequired},
    {"channel", "sampler", Type::integer, {}, kRequired, 0, kLargestCount},
    {"channel", "target", Type::object, "channel_target", kRequired},
    {"channel_target", "node", Type::index, "nodes"},
    {"channel_target", "path", Type::string, {}, kRequired},
    {"channel_target", "extensions", Type::object, "channel_target_extensions"},
    {"channel_target_extensions", "KHR_animation_pointer", Type::object, "animation_pointer"},
    {"animation_pointer", "pointer", Type::string, {}, kRequired},
    {"animation_sampler", "input", Type::index, "accessors", kRequired},
    {"animation_sampler", "output", Type::index, "accessors", kRequired},
    {"animation_sampler", "interpolation", Type::string, "LINEAR|STEP|CUBICSPLINE"},

    {"buffer", "uri", Type::string},
    {"buffer", "byteLength", Type::integer, {}, kRequired, 1, kLargestSize},
    {"buffer_view", "buffer", Type::index, "buffers", kRequired},
    {"buffer_view", "byteOffset", Type::integer, {}, kOptional, 0, kLargestSize},
    {"buffer_view", "byteLength", Type::integer, {}, kRequired, 1, kLargestSize},
    {"buffer_view", "byteStride", Type::integer, {}, kOptional, 4, 252},

    {"camera", "name", Type::string},
    {"camera", "type", Type::string, "perspective|orthographic", kRequired},
    {"camera", "perspective", Type::object, "perspective"},
    {"camera", "orthographic", Type::object, "orthographic"},
    {"perspective", "aspectRatio", Type::number, {}, kOptional, 0},
    {"perspective", "yfov", Type::number, {}, kRequired, 1e-6, 3.141592653589793},
    {"perspective", "znear", Type::number, {}, kRequired, 0},
    {"perspective", "zfar", Type::number, {}, kOptional, 0},
    {"orthographic", "xmag", Type::number, {}, kRequired},
    {"orthographic", "ymag", Type::number, {}, kRequired},
    {"orthographic", "znear", Type::number, {}, kRequired, 0},
    {"orthographic", "zfar", Type::number, {}, kRequired, 0},

    {"image", "name", Type::string},
    {"image", "uri", Type::string},
    {"image", "mimeType", Type::string},
    {"image", "bufferView", Type::index, "bufferViews"},

    {"material", "name", Type::string},
    {"material", "pbrMetallicRoughness", Type::object, "pbr"},
    {"material", "normalTexture", Type::object, "texture_info"},
    {"material", "occlusionTexture", Type::object, "texture_info"},
    {"material", "emissiveTexture", Type::object, "texture_info"},
    {"material", "emissiveFactor", Type::numbers, {}, kOptional, 0, 1, 3},
    {"material", "alphaMode", Type::string, "OPAQUE|MASK|BLEND"},
    {"material", "alphaCutoff", Type::number, {}, kOptional, 0},
    {"material", "doubleSided", Type::boolean},
    {"material", "extensions", Type::object, "material_extensions"},
    {"material_extensions", "KHR_materials_unlit", Type::object, "unlit"},
    {"material_extensions", "KHR_materials_emissive_strength", Type::object, "emissive_strength"},
    {"emissive_strength", "emissiveStrength", Type::number, {}, kOptional, 0},
    {"material_extensions", "KHR_materials_ior", Type::object, "ior"},
    {"ior", "ior", Type::number, {}, kOptional, 0},
    {"pbr", "baseColorFactor", Type::numbers, {}, kOptional, 0, 1, 4},
    {"pbr", "baseColorTexture", Type::object, "texture_info"},
    {"pbr", "metallicFactor", Type::number, {}, kOptional, 0, 1},
    {"pbr", "roughnessFactor", Type::number, {}, kOptional, 0, 1},
    {"pbr", "metallicRoughnessTexture", Type::object, "texture_info"},
    {"texture_info", "index", Type::index, "textures", kRequired},
    {"texture_info", "texCoord", Type::integer, {}, kOptional, 0, 1000},
    {"texture_info", "scale", Type::number},
    {"texture_info", "strength", Type::number, {}, kOptional, 0, 1},
    {"texture_info", "extensions", Type::object, "texture_info_extensions"},
    {"texture_info_extensions", "KHR_texture_transform", Type::object, "texture_transform"},
    {"texture_transform", "offset", Type::numbers, {}, kOptional, -kInfinity, kInfinity, 2},
    {"texture_transform", "rotation", Type::number},
    {"texture_transform", "scale", Type::numbers, {}, kOptional, -kInfinity, kInfinity, 2},
    {"texture_transform", "texCoord", Type::integer, {}, kOptional, 0, 1000},

    {"mesh", "name", Type::string},
    {"mesh", "primitives", Type::objects, "primitive", kRequired},
    {"mesh", "weights", Type::numbers},
    {"primitive", "attributes", Type::index_map, "accessors", kRequired},
    {"primitive", "indices", Type::index, "accessors"},
    {"primitive", "material", Type::index, "materials"},
    {"primitive", "mode", Type::integer, {}, kOptional, 0, 6},
    {"primitive", "targets", Type::index_maps, "accessors"},
    {"primitive", "extensions", Type::object, "primitive_extensions"},
    {"primitive_extensions", "KHR_materials_variants", Type::object, "variant_mappings"},
    {"variant_mappings", "mappings", Type::objects, "variant_mapping", kRequired},
    {"variant_mapping", "material", Type::index, "materials", kRequired},
    {"variant_mapping", "variants", Type::indices, "variants", kRequired},

    {"node", "name", Type::string},
    {"node", "camera", Type::index, "cameras"},
    {"node", "children", Type::indices, "nodes"},
    {"node", "skin", Type::index, "skins"},
    {"node", "matrix", Type::numbers, {}, kOptional, -kInfinity, kInfinity, 16},
    {"node", "mesh", Type::index, "meshes"},
    {"node", "rotation", Type::numbers, {}, kOptional, -kInfinity, kInfinity, 4},
    {"node", "scale", Type::numbers, {}, kOptional, -kInfinity, kInfinity, 3},
    {"node", "translation", Type::numbers, {}, kOptional, -kInfinity, kInfinity, 3},
    {"node", "weights", Type::numbers},
    {"node", "extensions", Type::object, "node_extensions"},
    {"node_extensions", "KHR_lights_punctual", Type::object, "light_use"},
    {"light_use", "light", Type::index, "lights", kRequired},
    {"node_extensions", "KHR_node_visibility", Type::object, "visibility"},
    {"visibility", "visible", Type::boolean},
    {"node_extensions", "EXT_mesh_gpu_instancing", Type::object, "instancing"},
    {"instancing", "attributes", Type::index_map, "accessors", kRequired},

    {"light", "name", Type::string},
    {"light", "type", Type::string, "directional|point|spot", kRequired},
    {"light", "color", Type::numbers, {}, kOptional, 0, kInfinity, 3},
    {"light", "intensity", Type::number, {}, kOptional, 0},
    {"light", "range", Type::number, {}, kOptional, 0},
    {"light", "spot", Type::object, "light_spot"},
    {"light_spot", "innerConeAngle", Type::number, {}, kOptional, 0, 1.5707963267948968},
    {"light_spot", "outerConeAngle", Type::number, {}, kOptional, 0, 1.5707963267948968},

    {"sampler", "magFilter", Type::integer, {}, kOptional, 9728, 9729},
    {"sampler", "minFilter", Type::integer, {}, kOptional, 9728, 9987},
    {"sampler", "wrapS", Type::integer, {}, kOptional, 10497, 33648},
    {"sampler", "wrapT", Type::integer, {}, kOptional, 10497, 33648},

    {"scene", "name", Type::string},
    {"scene", "nodes", Type::indices, "nodes"},

    {"skin", "name", Type::string},
    {"skin", "inverseBindMatrices", Type::index, "accessors"},
    {"skin", "skeleton", Type::index, "nodes"},
    {"skin", "joints", Type::indices, "nodes", kRequired},

    {"texture", "sampler", Type::index, "samplers"},
    {"texture", "source", Type::index, "images"},
};

const std::vector<const Property*>& properties_of(std::string_view owner) {
    static const auto table = [] {
        std::map<std::string_view, std::vector<const Property*>> result;
        for (const Property& property : kProperties) result[property.owner].push_back(&property);
        return result;
    }();
    static const std::vector<const Property*> none;
    const auto found = table.find(owner);
    return found == table.end() ? none : found->second;
}

/// Where the walk is; text is made only for messages.
struct Place {
    const Place* parent;
    std::string_view key;
    std::size_t index = 0;
    std::string text() const {
        if (!parent) return {};
        return fmt::format("{}/{}", parent->text(), key.empty() ? std::to_string(index) : std::string(key));
    }
};

std::string shown(const json& value) {
    constexpr std::size_t kLongest = 60;
    if (value.is_object()) return "an object";
    if (value.is_array()) return fmt::format("an array of {}", value.size());
    const std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
    return text.size() > kLongest ? text.substr(0, kLongest) + "..." : text;
}

std::string range_text(double min, double max) {
    if (std::isinf(max)) return fmt::format("at least {}", format_number(min));
    if (std::isinf(min)) return fmt::format("at most {}", format_number(max));
    return fmt::format("{} to {}", format_number(min), format_number(max));
}

class Checker {
public:
    Checker(json& document, const std::string& file) : document_(document), file_(file) {}

    std::vector<Diagnostic> run() {
        object(document_, "root", Place{nullptr, {}});
        return std::move(problems_);
    }

private:
    bool full() const { return problems_.size() >= kMostProblems; }

    void report(const Place& place, const std::string& found, const std::string& expected) {
        if (full()) return;
        Diagnostic& problem = problems_.emplace_back();
        problem.where.file = file_;
        problem.found = fmt::format("{} {}", place.parent ? place.text() : "/", found);
        problem.expected = expected;
    }
    void expected_type(const Place& place, const json& value, std::string_view what) {
        report(place, "is " + shown(value), fmt::format("expected {}; repair the file with the tool that wrote it", what));
    }

    void object(json& value, std::string_view kind, const Place& place) {
        if (!value.is_object()) return expected_type(place, value, "an object");
        for (const Property* property : properties_of(kind)) {
            if (full()) return;
            const auto member = value.find(property->key);
            const Place here{&place, property->key};
            if (member != value.end()) check(*member, *property, here);
            else if (property->required)
                report(here, "is missing", fmt::format("expected {}: glTF requires it", type_name(*property)));
        }
    }

    static std::string type_name(const Property& property) {
        switch (property.type) {
            case Type::integer: return "an integer";
            case Type::index: return fmt::format("an index into /{}", property.of);
            case Type::number: return "a number";
            case Type::string: return "a string";
            case Type::boolean: return "true or false";
            case Type::object: case Type::index_map: return "an object";
            default: return "an array";
        }
    }

    void check(json& value, const Property& property, const Place& place) {
        switch (property.type) {
            case Type::integer: integer(value, property, place); break;
            case Type::index: index(value, property.of, place); break;
            case Type::number: number(value, property, place); break;
            case Type::string: string(value, property, place); break;
            case Type::boolean:
                if (!value.is_boolean()) expected_type(place, value, "true or false");
                break;
            case Type::object: object(value, property.of, place); break;
            case Type::index_map: index_map(value, property.of, place); break;
            default: array(value, property, place);
        }
    }

    void array(json& value, const Property& property, const Place& place) {
        if (!value.is_array()) return expected_type(place, value, "an array");
        if (property.length && value.size() != property.length)
            return expected_type(place, value, fmt::format("{} numbers", property.length));
        for (std::size_t i = 0; i < value.size() && !full(); ++i) element(value[i], property, Place{&place, {}, i});
    }

    void element(json& value, const Property& property, const Place& place) {
        switch (property.type) {
            case Type::numbers: number(value, property, place); break;
            case Type::indices: index(value, property.of, place); break;
            case Type::objects: object(value, property.of, place); break;
            case Type::index_maps: index_map(value, property.of, place); break;
            default:
                if (!value.is_string()) expected_type(place, value, "a string");
        }
    }

    void index_map(json& value, std::string_view collection, const Place& place) {
        if (!value.is_object()) return expected_type(place, value, "an object");
        for (auto& [key, member] : value.items()) index(member, collection, Place{&place, key});
    }

    static bool make_integer(json& value) {
        if (value.is_number_integer()) return true;
        if (!value.is_number_float()) return false;
        const double number = value.get<double>();
        if (std::trunc(number) != number || std::abs(number) > 9e15) return false;
        if (number < 0) value = static_cast<std::int64_t>(number);
        else value = static_cast<std::uint64_t>(number);
        return true;
    }

    void integer(json& value, const Property& property, const Place& place) {
        if (!make_integer(value)) return expected_type(place, value, "an integer");
        range(value, property, place);
    }

    void number(const json& value, const Property& property, const Place& place) {
        if (!value.is_number()) return expected_type(place, value, "a number");
        if (!std::isfinite(value.get<double>()) || std::abs(value.get<double>()) > std::numeric_limits<float>::max())
            return expected_type(place, value, "a finite number that fits 32-bit floats");
        range(value, property, place);
    }

    void range(const json& value, const Property& property, const Place& place) {
        const double number = value.get<double>();
        if (!(number >= property.min && number <= property.max))
            report(place, "is " + shown(value), "expected " + range_text(property.min, property.max));
    }

    void string(const json& value, const Property& property, const Place& place) {
        if (!value.is_string()) return expected_type(place, value, "a string");
        if (property.of.empty()) return;
        const std::string& text = value.get_ref<const std::string&>();
        for (std::string_view rest = property.of; ; rest.remove_prefix(rest.find('|') + 1)) {
            if (text == rest.substr(0, rest.find('|'))) return;
            if (rest.find('|') == std::string_view::npos) break;
        }
        std::string choices(property.of);
        std::replace(choices.begin(), choices.end(), '|', ' ');
        report(place, "is " + shown(value), "expected one of: " + choices);
    }

    std::size_t count_of(std::string_view collection) const {
        // Collections of extensions.
        static const std::map<std::string_view, json::json_pointer> kElsewhere{
            {"lights", json::json_pointer("/extensions/KHR_lights_punctual/lights")},
            {"variants", json::json_pointer("/extensions/KHR_materials_variants/variants")}};
        const json* list = nullptr;
        if (const auto elsewhere = kElsewhere.find(collection); elsewhere != kElsewhere.end()) {
            if (document_.contains(elsewhere->second)) list = &document_.at(elsewhere->second);
        } else if (const auto found = document_.find(collection); found != document_.end()) {
            list = &*found;
        }
        return list && list->is_array() ? list->size() : 0;
    }

    void index(json& value, std::string_view collection, const Place& place) {
        if (!make_integer(value)) return expected_type(place, value, fmt::format("an index into /{}", collection));
        const std::size_t count = count_of(collection);
        const double number = value.get<double>();
        if (number >= 0 && number < static_cast<double>(count)) return;
        report(place, "is " + shown(value),
               count ? fmt::format("expected an index into /{}: 0 to {}", collection, count - 1)
                     : fmt::format("expected an index into /{}, but the file has none", collection));
    }

    json& document_;
    const std::string& file_;
    std::vector<Diagnostic> problems_;
};

json known(const json& value, std::string_view kind, const std::vector<std::string_view>& without = {}) {
    json result = json::object();
    for (const Property* property : properties_of(kind)) {
        const auto member = value.find(property->key);
        if (member == value.end() || std::find(without.begin(), without.end(), property->key) != without.end()) continue;
        if (property->type == Type::object) {
            result[property->key] = known(*member, property->of);
        } else if (property->type == Type::objects) {
            json list = json::array();
            for (const json& item : *member) list.push_back(known(item, property->of));
            result[property->key] = std::move(list);
        } else {
            result[property->key] = *member;
        }
    }
    return result;
}

}  // namespace

std::vector<Diagnostic> check_schema(json& document, const std::string& file) { return Checker(document, file).run(); }

json known_members(const json& document) {
    return known(document, "root", {"buffers", "images"});
}

}  // namespace kadr
