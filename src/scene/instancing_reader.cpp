#include "scene/instancing_reader.h"

#include <cmath>
#include <map>

#include <fmt/format.h>

#include "scene/accessor.h"

namespace kadr {

namespace {

constexpr std::string_view kName = "EXT_mesh_gpu_instancing";
/// As many instances as a whole scene may have; an accessor without bytes could ask for any number.
constexpr std::size_t kMostPlaces = (1u << 24) - 1;

std::string pointer_to(std::size_t node, std::string_view attribute) {
    return fmt::format("/nodes/{}/extensions/{}/attributes{}{}", node, kName, attribute.empty() ? "" : "/", attribute);
}

/// What the extension allows beside floats.
enum class Also { nothing, normalized_bytes_and_shorts };

bool is_allowed(const tinygltf::Accessor& accessor, int type, Also also) {
    if (accessor.type != type) return false;
    const int component = accessor.componentType;
    const bool small = component == TINYGLTF_COMPONENT_TYPE_BYTE || component == TINYGLTF_COMPONENT_TYPE_SHORT;
    return component == TINYGLTF_COMPONENT_TYPE_FLOAT || (also == Also::normalized_bytes_and_shorts && small && accessor.normalized);
}

}  // namespace

void InstancingReader::read(std::vector<Node>& nodes, std::vector<std::vector<Placement>>& sets) {
    std::map<Attributes, int> known;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const nlohmann::json& source = document_.json()["nodes"][i];
        const auto extensions = source.find("extensions");
        if (extensions == source.end() || !extensions->contains(kName)) continue;
        const Attributes attributes = attributes_of(i, (*extensions)[std::string(kName)]["attributes"]);
        if (document_.model().nodes[i].mesh < 0) {
            document_.warnings.push_back(document_.warning(fmt::format("/nodes/{}/extensions/{}", i, kName), "has no effect: the node has no mesh"));
            continue;
        }
        const auto [place, added] = known.try_emplace(attributes, static_cast<int>(sets.size()));
        if (added) sets.push_back(read_set(i, attributes));
        nodes[i].placement_set = place->second;
    }
}

InstancingReader::Attributes InstancingReader::attributes_of(std::size_t node, const nlohmann::json& attributes) const {
    struct Rule {
        const char* name;
        int Attributes::* accessor;
        int type;
        Also also;
        const char* expected;
    };
    constexpr Rule kRules[] = {{"TRANSLATION", &Attributes::translation, TINYGLTF_TYPE_VEC3, Also::nothing, "expected VEC3 of float"},
                               {"ROTATION", &Attributes::rotation, TINYGLTF_TYPE_VEC4, Also::normalized_bytes_and_shorts, "expected VEC4 of float, or of normalized byte or short"},
                               {"SCALE", &Attributes::scale, TINYGLTF_TYPE_VEC3, Also::nothing, "expected VEC3 of float"}};
    Attributes found;
    std::string first;
    for (const auto& [name, index] : attributes.items()) {  // attributes of the file's own count as well
        const tinygltf::Accessor& accessor = document_.model().accessors[index.get<std::size_t>()];
        for (const Rule& rule : kRules) {
            if (name != rule.name) continue;
            if (!is_allowed(accessor, rule.type, rule.also)) document_.fail(pointer_to(node, name), "is " + describe_accessor(accessor), rule.expected);
            found.*rule.accessor = index.get<int>();
        }
        if (!first.empty() && accessor.count != found.count)
            document_.fail(pointer_to(node, name), fmt::format("has {} elements, {} has {}", accessor.count, first, found.count), "expected as many elements in every attribute");
        if (first.empty()) first = name;
        found.count = accessor.count;
    }
    if (found.count > kMostPlaces)
        document_.fail(pointer_to(node, first), fmt::format("has {} elements", found.count), fmt::format("expected at most {} instances", kMostPlaces));
    if (first.empty()) document_.fail(pointer_to(node, {}), "is empty", "expected TRANSLATION, ROTATION or SCALE");
    return found;
}

std::vector<float> InstancingReader::read_finite(std::size_t node, const char* name, int accessor) const {
    if (accessor < 0) return {};
    std::vector<float> values = read_floats(document_, accessor);
    const std::size_t components = static_cast<std::size_t>(component_count(document_.model().accessors[static_cast<std::size_t>(accessor)].type));
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i])) document_.fail(pointer_to(node, name), fmt::format("element {} is not finite", i / components), "expected numbers; the file is damaged");
    return values;
}

std::vector<Placement> InstancingReader::read_set(std::size_t node, const Attributes& attributes) const {
    const std::vector<float> t = read_finite(node, "TRANSLATION", attributes.translation), r = read_finite(node, "ROTATION", attributes.rotation),
                             s = read_finite(node, "SCALE", attributes.scale);
    std::vector<Placement> set(attributes.count);
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (!t.empty()) set[i].translation = {t[3 * i], t[3 * i + 1], t[3 * i + 2]};
        if (!s.empty()) set[i].scale = {s[3 * i], s[3 * i + 1], s[3 * i + 2]};
        if (r.empty()) continue;
        const glm::quat rotation(r[4 * i + 3], r[4 * i], r[4 * i + 1], r[4 * i + 2]);
        if (!(glm::length(rotation) > 1e-6f))
            document_.fail(pointer_to(node, "ROTATION"), fmt::format("element {} is a quaternion of length 0", i), "expected unit quaternions, x y z w");
        set[i].rotation = glm::normalize(rotation);
    }
    return set;
}

}  // namespace kadr
