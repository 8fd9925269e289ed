#include "scene/variant_reader.h"

#include <fmt/format.h>

#include <set>

namespace kadr {

namespace {

constexpr const char* kExtension = "KHR_materials_variants";

/// The extension's object of a primitive or of the document; null when there is none.
const nlohmann::json* extension_of(const nlohmann::json& object) {
    const auto extensions = object.find("extensions");
    if (extensions == object.end()) return nullptr;
    const auto found = extensions->find(kExtension);
    return found == extensions->end() ? nullptr : &*found;
}

}  // namespace

std::vector<std::string> read_variants(const GltfDocument& document) {
    std::vector<std::string> names;
    if (const nlohmann::json* extension = extension_of(document.json()))
        for (const nlohmann::json& variant : (*extension)["variants"]) names.push_back(variant["name"].get<std::string>());
    return names;
}

std::vector<VariantMapping> read_variant_mappings(const GltfDocument& document, std::size_t mesh, std::size_t primitive) {
    std::vector<VariantMapping> result;
    const nlohmann::json* extension = extension_of(document.json()["meshes"][mesh]["primitives"][primitive]);
    if (!extension) return result;
    std::set<int> taken;
    for (const nlohmann::json& mapping : (*extension)["mappings"]) {
        result.push_back({mapping["material"].get<int>(), mapping["variants"].get<std::vector<int>>()});
        for (const int variant : result.back().variants)
            if (!taken.insert(variant).second)
                document.fail(fmt::format("/meshes/{}/primitives/{}/extensions/{}/mappings/{}/variants", mesh, primitive, kExtension, result.size() - 1),
                              fmt::format("names variant {} again", variant), "expected one material for each variant");
    }
    return result;
}

}  // namespace kadr
