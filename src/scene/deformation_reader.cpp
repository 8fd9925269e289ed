#include "scene/deformation_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/accessor.h"

namespace kadr {

namespace {

using kernels::Vec3f;

const tinygltf::Accessor& accessor_of(const GltfDocument& document, int index) { return document.model().accessors[static_cast<std::size_t>(index)]; }

bool is_unsigned_small(int type) { return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT; }
bool is_signed_small(int type) { return type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_SHORT; }

void check_count(const GltfDocument& document, const std::string& pointer, const tinygltf::Accessor& accessor, std::size_t elements) {
    if (accessor.count != elements)
        document.fail(pointer, fmt::format("has {} elements, POSITION has {}", accessor.count, elements), "expected as many elements in every attribute");
}

void check_finite(const GltfDocument& document, const std::string& pointer, const std::vector<float>& values, std::size_t components) {
    const auto bad = std::find_if(values.begin(), values.end(), [](float f) { return !std::isfinite(f); });
    if (bad != values.end())
        document.fail(pointer, fmt::format("element {} is not finite", static_cast<std::size_t>(bad - values.begin()) / components),
                      "expected finite numbers; export the mesh anew");
}

/// One JOINTS_n or WEIGHTS_n, four numbers a vertex.
std::vector<float> read_set(const GltfDocument& document, const tinygltf::Primitive& primitive, const VertexSource& vertices, const std::string& name, bool joints) {
    const int index = primitive.attributes.at(name);
    const tinygltf::Accessor& accessor = accessor_of(document, index);
    const std::string pointer = fmt::format("{}/attributes/{}", vertices.pointer, name);
    const bool small = is_unsigned_small(accessor.componentType);
    const bool fits = joints ? small && !accessor.normalized : accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT || (small && accessor.normalized);
    if (accessor.type != TINYGLTF_TYPE_VEC4 || !fits)
        document.fail(pointer, "is " + describe_accessor(accessor),
                      joints ? "expected VEC4 of unsigned byte or unsigned short" : "expected VEC4 of float, normalized unsigned byte or normalized unsigned short");
    check_count(document, pointer, accessor, vertices.elements);
    std::vector<float> values = read_floats(document, index);
    check_finite(document, pointer, values, 4);
    return values;
}

/// The influences of one vertex, before they are packed.
struct Influence {
    std::uint16_t joint;
    float weight;
};

/// Sorts by weight, drops what weighs nothing and makes the rest add up to 1. @return whether there was anything to repair
bool tidy(std::vector<Influence>& influences) {
    const bool negative = std::any_of(influences.begin(), influences.end(), [](const Influence& i) { return i.weight < 0; });
    const std::uint16_t first = influences.front().joint;
    std::erase_if(influences, [](const Influence& i) { return !(i.weight > 0); });
    std::stable_sort(influences.begin(), influences.end(), [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
    double sum = 0;
    for (const Influence& i : influences) sum += i.weight;
    for (Influence& i : influences) i.weight = static_cast<float>(i.weight / sum);
    if (!influences.empty()) return negative;
    influences.push_back({first, 1.0f});
    return true;
}

SkinWeights pack(const std::vector<std::vector<Influence>>& vertices, std::size_t most) {
    SkinWeights skin;
    skin.per_vertex = static_cast<int>(most);
    skin.joints.assign(vertices.size() * most, 0);
    skin.weights.assign(vertices.size() * most, 0.0f);
    for (std::size_t v = 0; v < vertices.size(); ++v)
        for (std::size_t i = 0; i < vertices[v].size(); ++i) {
            skin.joints[v * most + i] = vertices[v][i].joint;
            skin.weights[v * most + i] = vertices[v][i].weight;
        }
    return skin;
}

std::size_t element_of(const VertexSource& vertices, std::size_t vertex) { return vertices.source.empty() ? vertex : vertices.source[vertex]; }
std::size_t vertex_count(const VertexSource& vertices) { return vertices.source.empty() ? vertices.elements : vertices.source.size(); }

/// The component types of a morph target's differences.  Source: glTF 2.0, 3.7.2.2; KHR_mesh_quantization.
std::vector<float> read_differences(const GltfDocument& document, int index, const std::string& pointer, std::string_view name, std::size_t elements) {
    const tinygltf::Accessor& accessor = accessor_of(document, index);
    const int type = accessor.componentType;
    const bool quantized = document.uses("KHR_mesh_quantization") && (is_signed_small(type) || (name == "POSITION" && is_unsigned_small(type))) &&
                           (name == "POSITION" || accessor.normalized);
    if (accessor.type != TINYGLTF_TYPE_VEC3 || !(type == TINYGLTF_COMPONENT_TYPE_FLOAT || quantized))
        document.fail(pointer, "is " + describe_accessor(accessor), "expected VEC3 of float, or with KHR_mesh_quantization of byte or short");
    check_count(document, pointer, accessor, elements);
    std::vector<float> values = read_floats(document, index);
    check_finite(document, pointer, values, 3);
    return values;
}

Vec3f element(const std::vector<float>& values, std::size_t at, float factor) {
    return values.empty() ? Vec3f{0, 0, 0} : Vec3f{values[3 * at] * factor, values[3 * at + 1] * factor, values[3 * at + 2] * factor};
}
bool is_zero(Vec3f v) { return v.x == 0 && v.y == 0 && v.z == 0; }

glm::dmat4 bind_matrix(const GltfDocument& document, const std::string& pointer, const float* values, std::size_t joint) {
    glm::dmat4 matrix;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) {
            const double value = values[4 * column + row];
            if (!std::isfinite(value)) document.fail(pointer, fmt::format("matrix {} is not finite", joint), "expected finite numbers; export the skin anew");
            matrix[column][row] = value;
        }
    constexpr double kTolerance = 1e-4;  // of exporters that invert in single precision
    for (int column = 0; column < 4; ++column) {
        const double wanted = column == 3 ? 1 : 0;
        if (std::abs(matrix[column][3] - wanted) > kTolerance)
            document.fail(pointer, fmt::format("matrix {} has {} as element {}", joint, matrix[column][3], 4 * column + 3),
                          "expected 0, 0, 0, 1 in the last row: an affine transform");
        matrix[column][3] = wanted;
    }
    return matrix;
}

/// From a root down to the node.
std::vector<int> chain_to(const std::vector<Node>& nodes, int node) {
    std::vector<int> chain;
    for (; node >= 0; node = nodes[static_cast<std::size_t>(node)].parent) chain.push_back(node);
    std::reverse(chain.begin(), chain.end());
    return chain;
}

int common_root(const std::vector<Node>& nodes, const std::vector<int>& joints) {
    std::vector<int> common = chain_to(nodes, joints.front());
    for (const int joint : joints) {
        const std::vector<int> chain = chain_to(nodes, joint);
        const auto [end, unused] = std::mismatch(common.begin(), common.end(), chain.begin(), chain.end());
        common.erase(end, common.end());
        if (common.empty()) return -1;
    }
    return common.back();
}

}  // namespace

std::vector<glm::dmat4> read_bind_matrices(const GltfDocument& document, std::size_t index) {
    const tinygltf::Skin& skin = document.model().skins[index];
    if (skin.inverseBindMatrices < 0) return std::vector<glm::dmat4>(skin.joints.size(), glm::dmat4(1));
    const tinygltf::Accessor& accessor = accessor_of(document, skin.inverseBindMatrices);
    const std::string pointer = fmt::format("/skins/{}/inverseBindMatrices", index);
    if (accessor.type != TINYGLTF_TYPE_MAT4 || accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
        document.fail(pointer, "is " + describe_accessor(accessor), "expected MAT4 of float");
    if (accessor.count < skin.joints.size())
        document.fail(pointer, fmt::format("has {} matrices for {} joints", accessor.count, skin.joints.size()), "expected one for each joint");
    const std::vector<float> values = read_floats(document, skin.inverseBindMatrices);
    std::vector<glm::dmat4> matrices;
    for (std::size_t j = 0; j < skin.joints.size(); ++j) matrices.push_back(bind_matrix(document, pointer, &values[16 * j], j));
    return matrices;
}

SkinWeights read_skin_weights(const GltfDocument& document, const tinygltf::Primitive& primitive, const VertexSource& vertices,
                              std::vector<Diagnostic>& warnings) {
    std::vector<std::vector<Influence>> influences;
    for (int set = 0;; ++set) {
        const std::string joints_name = fmt::format("JOINTS_{}", set), weights_name = fmt::format("WEIGHTS_{}", set);
        const bool has_joints = primitive.attributes.count(joints_name) > 0, has_weights = primitive.attributes.count(weights_name) > 0;
        if (!has_joints && !has_weights) break;
        if (has_joints != has_weights)
            document.fail(vertices.pointer + "/attributes", fmt::format("has {} without {}", has_joints ? joints_name : weights_name, has_joints ? weights_name : joints_name),
                          "expected joints and weights in pairs");
        const std::vector<float> joints = read_set(document, primitive, vertices, joints_name, true);
        const std::vector<float> weights = read_set(document, primitive, vertices, weights_name, false);
        influences.resize(vertices.elements);
        for (std::size_t i = 0; i < weights.size(); ++i) influences[i / 4].push_back({static_cast<std::uint16_t>(joints[i]), weights[i]});
    }
    if (influences.empty()) return {};
    std::size_t most = 1, repaired = 0;
    for (std::vector<Influence>& vertex : influences) {
        repaired += tidy(vertex) ? 1 : 0;
        most = std::max(most, vertex.size());
    }
    if (repaired > 0)
        warnings.push_back(document.warning(vertices.pointer + "/attributes/WEIGHTS_0", fmt::format("leaves {} of {} vertices without a positive sum of weights, or with negative ones", repaired, influences.size()),
                                            "negative weights count as 0; a vertex without any follows the first joint it names"));
    if (vertices.source.empty()) return pack(influences, most);
    std::vector<std::vector<Influence>> expanded;
    for (const std::uint32_t from : vertices.source) expanded.push_back(influences[from]);
    return pack(expanded, most);
}

std::vector<MorphTarget> read_morph_targets(const GltfDocument& document, const tinygltf::Primitive& primitive, const VertexSource& vertices,
                                            double scale, std::vector<Diagnostic>& warnings) {
    std::vector<MorphTarget> targets;
    bool ignored = false;
    for (std::size_t t = 0; t < primitive.targets.size(); ++t) {
        const auto values_of = [&](const char* name) {
            const auto found = primitive.targets[t].find(name);
            if (found == primitive.targets[t].end()) return std::vector<float>{};
            return read_differences(document, found->second, fmt::format("{}/targets/{}/{}", vertices.pointer, t, name), name, vertices.elements);
        };
        const std::vector<float> positions = values_of("POSITION"), normals = values_of("NORMAL"), tangents = values_of("TANGENT");
        MorphTarget target;
        for (std::size_t v = 0; v < vertex_count(vertices); ++v) {
            const std::size_t from = element_of(vertices, v);
            const Vec3f p = element(positions, from, static_cast<float>(1 / scale)), n = element(normals, from, 1), d = element(tangents, from, 1);
            if (is_zero(p) && is_zero(n) && is_zero(d)) continue;
            target.vertices.push_back(static_cast<std::uint32_t>(v));
            if (!positions.empty()) target.positions.push_back(p);
            if (!normals.empty()) target.normals.push_back(n);
            if (!tangents.empty()) target.tangents.push_back(d);
        }
        targets.push_back(std::move(target));
        for (const auto& [name, accessor] : primitive.targets[t]) ignored = ignored || (name != "POSITION" && name != "NORMAL" && name != "TANGENT");
    }
    if (ignored) warnings.push_back(document.warning(vertices.pointer + "/targets", "morph more than POSITION, NORMAL and TANGENT; the rest does not move"));
    return targets;
}

std::vector<Skin> read_skins(const GltfDocument& document, const std::vector<Node>& nodes) {
    std::vector<Skin> skins;
    for (std::size_t i = 0; i < document.model().skins.size(); ++i) {
        const tinygltf::Skin& source = document.model().skins[i];
        Skin skin;
        skin.name = source.name;
        skin.joints = source.joints;
        if (skin.joints.empty()) document.fail(fmt::format("/skins/{}/joints", i), "is empty", "expected at least one joint");
        if (skin.joints.size() > std::numeric_limits<std::uint16_t>::max() + std::size_t{1})
            document.fail(fmt::format("/skins/{}/joints", i), fmt::format("has {} joints", skin.joints.size()), "expected at most 65536");
        skin.root = common_root(nodes, skin.joints);
        skins.push_back(std::move(skin));
    }
    return skins;
}

std::size_t target_count(const tinygltf::Mesh& mesh) { return mesh.primitives.empty() ? 0 : mesh.primitives.front().targets.size(); }

void read_morph_weights(const GltfDocument& document, std::vector<Node>& nodes) {
    const tinygltf::Model& model = document.model();
    for (std::size_t m = 0; m < model.meshes.size(); ++m) {
        const std::size_t count = target_count(model.meshes[m]);
        for (std::size_t p = 0; p < model.meshes[m].primitives.size(); ++p)
            if (model.meshes[m].primitives[p].targets.size() != count)
                document.fail(fmt::format("/meshes/{}/primitives/{}/targets", m, p), fmt::format("has {} morph targets, primitive 0 has {}", model.meshes[m].primitives[p].targets.size(), count),
                              "expected the same number in all primitives of a mesh");
        if (!model.meshes[m].weights.empty() && model.meshes[m].weights.size() != count)
            document.fail(fmt::format("/meshes/{}/weights", m), fmt::format("has {} weights for {} morph targets", model.meshes[m].weights.size(), count), "expected one for each target");
    }
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const tinygltf::Node& source = model.nodes[n];
        if (source.mesh < 0) continue;
        const tinygltf::Mesh& mesh = model.meshes[static_cast<std::size_t>(source.mesh)];
        const std::size_t count = target_count(mesh);
        if (!source.weights.empty() && source.weights.size() != count)
            document.fail(fmt::format("/nodes/{}/weights", n), fmt::format("has {} weights for the {} morph targets of its mesh", source.weights.size(), count), "expected one for each target");
        nodes[n].weights = !source.weights.empty() ? source.weights : mesh.weights;
        nodes[n].weights.resize(count, 0.0);
    }
}

}  // namespace kadr
