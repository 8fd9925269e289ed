#include "scene/geometry_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string_view>

#include "scene/accessor.h"
#include "scene/deformation_reader.h"
#include "scene/tangents.h"

namespace kadr {

namespace {

using kernels::Vec2f;
using kernels::Vec3f;
using kernels::Vec4f;

/// Component types that an attribute may have, as bits over the distance from 5120.
constexpr unsigned bit(int component_type) { return 1u << (component_type - TINYGLTF_COMPONENT_TYPE_BYTE); }
constexpr unsigned kFloat = bit(TINYGLTF_COMPONENT_TYPE_FLOAT);
constexpr unsigned kUnsigned = bit(TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) | bit(TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
constexpr unsigned kSigned = bit(TINYGLTF_COMPONENT_TYPE_BYTE) | bit(TINYGLTF_COMPONENT_TYPE_SHORT);

/// Source: glTF 2.0 specification, 3.7.2.1 (meshes), and KHR_mesh_quantization.
struct AttributeRule {
    std::string_view name;
    int components;          ///< smallest and, but for colours, largest
    unsigned plain;          ///< without extension; integers must be normalised
    unsigned quantized;      ///< with KHR_mesh_quantization
    std::string_view expected;
};
constexpr AttributeRule kRules[] = {
    {"POSITION", 3, kFloat, kFloat | kSigned | kUnsigned, "VEC3 of float, or with KHR_mesh_quantization of byte or short"},
    {"NORMAL", 3, kFloat, kFloat | kSigned, "VEC3 of float, or with KHR_mesh_quantization of normalized byte or short"},
    {"TANGENT", 4, kFloat, kFloat | kSigned, "VEC4 of float, or with KHR_mesh_quantization of normalized byte or short"},
    {"TEXCOORD", 2, kFloat | kUnsigned, kFloat | kUnsigned | kSigned, "VEC2 of float, normalized unsigned byte or normalized unsigned short"},
    {"COLOR", 3, kFloat | kUnsigned, kFloat | kUnsigned, "VEC3 or VEC4 of float, normalized unsigned byte or normalized unsigned short"},
};

class Builder {
public:
    Builder(const GltfDocument& document, std::size_t mesh, std::size_t primitive)
        : document_(document), primitive_(document.model().meshes[mesh].primitives[primitive]),
          pointer_(fmt::format("/meshes/{}/primitives/{}", mesh, primitive)) {
        result_.data.name = geometry_name(document, mesh, primitive);
    }

    BuiltGeometry build(int normal_uv_set, const GeometryNeeds& needs) {
        if (!needs.tangents) normal_uv_set = -1;
        if (!is_triangles() || !has_positions()) return std::move(result_);
        GeometryData& g = result_.data;
        read("POSITION", 0, g.positions);
        require_finite(g.positions, "POSITION");
        build_triangles();
        if (g.indices.empty()) {
            warn({}, "holds no complete triangle and is skipped");
            return std::move(result_);
        }
        read("NORMAL", 1, g.normals);
        if (needs.uv[0] || normal_uv_set == 0) read("TEXCOORD_0", 3, g.uv[0]);
        if (needs.uv[1] || normal_uv_set == 1) read("TEXCOORD_1", 3, g.uv[1]);
        if (needs.colors) read_colors();
        repair_normals();
        normalise_positions();
        VertexSource vertices{pointer_, g.positions.size(), {}};
        if (g.normals.empty() && normal_uv_set >= 0) vertices.source = g.indices;  // tangents of flat meshes unshare the vertices
        build_tangents(normal_uv_set);
        if (needs.skin) g.skin = read_skin_weights(document_, primitive_, vertices, result_.warnings);
        if (needs.targets) g.targets = read_morph_targets(document_, primitive_, vertices, g.scale, result_.warnings);
        return std::move(result_);
    }

private:
    void warn(std::string_view member, std::string_view found, std::string expected = {}) {
        result_.warnings.push_back(document_.warning(pointer_ + std::string(member), found, std::move(expected)));
    }

    int mode() const { return primitive_.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive_.mode; }

    bool is_triangles() {
        if (mode() >= TINYGLTF_MODE_TRIANGLES) return true;
        warn("/mode", fmt::format("is {} ({}); the primitive is skipped", mode(), mode() == TINYGLTF_MODE_POINTS ? "points" : "lines"),
             "Kadr draws triangles, strips and fans");
        return false;
    }

    bool has_positions() {
        if (primitive_.attributes.count("POSITION")) return true;
        warn("/attributes", "has no POSITION; the primitive is skipped");
        return false;
    }

    const tinygltf::Accessor* find(const std::string& name, int& index) const {
        const auto found = primitive_.attributes.find(name);
        if (found == primitive_.attributes.end()) return nullptr;
        index = found->second;
        return &document_.model().accessors[static_cast<std::size_t>(index)];
    }

    void check_type(const std::string& name, const tinygltf::Accessor& accessor, const AttributeRule& rule) const {
        const int components = accessor.type <= 4 ? component_count(accessor.type) : 0;
        const bool shape = components == rule.components || (rule.name == "COLOR" && components == 4);
        const bool quantized = document_.uses("KHR_mesh_quantization");
        const unsigned allowed = quantized ? rule.quantized : rule.plain;
        const bool is_float = accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT;
        const bool scaled = is_float || accessor.normalized || quantized;
        if (!shape || !(allowed & bit(accessor.componentType)) || !scaled)
            document_.fail(fmt::format("{}/attributes/{}", pointer_, name), "is " + describe_accessor(accessor), fmt::format("expected {}", rule.expected));
    }

    /// The accessor of an attribute, checked; null where the primitive has none.
    const tinygltf::Accessor* checked(const std::string& name, std::size_t rule, int& index) const {
        const tinygltf::Accessor* accessor = find(name, index);
        if (!accessor) return nullptr;
        check_type(name, *accessor, kRules[rule]);
        const auto& positions = result_.data.positions;
        if (!positions.empty() && accessor->count != positions.size())
            document_.fail(fmt::format("{}/attributes/{}", pointer_, name), fmt::format("has {} elements, POSITION has {}", accessor->count, positions.size()),
                           "expected as many elements in every attribute");
        return accessor;
    }

    template <class V>
    void read(const std::string& name, std::size_t rule, std::vector<V>& out) const {
        int index = -1;
        const tinygltf::Accessor* accessor = checked(name, rule, index);
        if (!accessor) return;
        out.resize(accessor->count);
        read_floats(document_, index, reinterpret_cast<float*>(out.data()));
        require_finite(out, name);
    }

    template <class V>
    void require_finite(const std::vector<V>& values, std::string_view name) const {
        const auto* floats = reinterpret_cast<const float*>(values.data());
        const std::size_t count = values.size() * sizeof(V) / sizeof(float);
        // A sum of products by zero is NaN exactly when some value is not finite; the loop vectorises.
        float probe = 0;
        for (std::size_t i = 0; i < count; ++i) probe += floats[i] * 0.0f;
        if (probe == 0.0f) return;
        const auto bad = std::find_if(floats, floats + count, [](float f) { return !std::isfinite(f); });
        document_.fail(fmt::format("{}/attributes/{}", pointer_, name), fmt::format("element {} is not finite", static_cast<std::size_t>(bad - floats) * sizeof(float) / sizeof(V)),
                       "expected finite numbers; export the mesh anew");
    }

    void read_colors() {
        int index = -1;
        const tinygltf::Accessor* accessor = checked("COLOR_0", 4, index);
        if (!accessor) return;
        std::vector<Vec4f>& colors = result_.data.colors;
        if (accessor->type == TINYGLTF_TYPE_VEC4) {
            read("COLOR_0", 4, colors);
        } else {
            const std::vector<float> rgb = read_floats(document_, index);
            for (std::size_t i = 0; i < accessor->count; ++i) colors.push_back({rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2], 1.0f});
            require_finite(colors, "COLOR_0");
        }
        for (Vec4f& c : colors) c = {std::max(c.x, 0.0f), std::max(c.y, 0.0f), std::max(c.z, 0.0f), std::clamp(c.w, 0.0f, 1.0f)};
        // Exporters write white for want of another colour, and one times anything is that.
        if (std::all_of(colors.begin(), colors.end(), [](const Vec4f& c) { return c.x == 1 && c.y == 1 && c.z == 1 && c.w == 1; })) colors = {};
    }

    std::vector<std::uint32_t> vertex_order() const {
        if (primitive_.indices < 0) {
            std::vector<std::uint32_t> order(result_.data.positions.size());
            std::iota(order.begin(), order.end(), 0u);
            return order;
        }
        const tinygltf::Accessor& accessor = document_.model().accessors[static_cast<std::size_t>(primitive_.indices)];
        const int type = accessor.componentType;
        if (accessor.type != TINYGLTF_TYPE_SCALAR || (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
                                                      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
            document_.fail(pointer_ + "/indices", "is " + describe_accessor(accessor), "expected SCALAR of unsigned byte, unsigned short or unsigned int");
        std::vector<std::uint32_t> order = read_indices(document_, primitive_.indices);
        check_order(order, type);
        return order;
    }

    void check_order(const std::vector<std::uint32_t>& order, int type) const {
        const std::size_t vertices = result_.data.positions.size();
        const std::uint32_t largest = *std::max_element(order.begin(), order.end());
        // The largest value of the type restarts primitives in some interfaces: glTF forbids it even where a vertex has that number.
        const std::uint32_t restart = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ? 0xFFu : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 0xFFFFu : 0xFFFFFFFFu;
        if (largest < vertices && largest != restart) return;
        const auto at = std::max_element(order.begin(), order.end()) - order.begin();
        const std::string found = largest == restart ? fmt::format("element {} is the primitive restart value {}", at, largest) : fmt::format("element {} is {}", at, largest);
        document_.fail(pointer_ + "/indices", found, fmt::format("expected vertices 0 to {}", std::min<std::size_t>(vertices, restart) - 1));
    }

    void build_triangles() {
        std::vector<std::uint32_t> order = vertex_order();
        std::vector<std::uint32_t>& indices = result_.data.indices;
        if (mode() == TINYGLTF_MODE_TRIANGLES) {
            if (order.size() % 3) {
                warn({}, fmt::format("has {} vertices; the last {} make no triangle", order.size(), order.size() % 3));
                order.resize(order.size() / 3 * 3);
            }
            indices = std::move(order);
            return;
        }
        const bool fan = mode() == TINYGLTF_MODE_TRIANGLE_FAN;
        for (std::size_t i = 0; i + 2 < order.size(); ++i) {
            // Every second triangle of a strip turns the other way round.
            const std::uint32_t a = fan ? order[i + 1] : order[i], b = fan ? order[i + 2] : order[i + 1 + i % 2], c = fan ? order[0] : order[i + 2 - i % 2];
            if (a != b && b != c && a != c) indices.insert(indices.end(), {a, b, c});  // strips turn corners by empty triangles
        }
    }

    /// Unit length; where a normal has none, the average of the faces around the vertex.
    void repair_normals() {
        GeometryData& g = result_.data;
        std::vector<Vec3f> faces;
        for (std::size_t i = 0; i < g.normals.size(); ++i) {
            Vec3f& n = g.normals[i];
            float squared = dot(n, n);
            if (!(squared > 1e-30f && squared < 1e30f)) {
                if (faces.empty()) {
                    faces = face_sums();
                    warn("/attributes/NORMAL", fmt::format("element {} has no length; such normals are taken from the faces", i));
                }
                n = faces[i];
                squared = dot(n, n);
            }
            n = squared > 0 ? n * (1.0f / std::sqrt(squared)) : Vec3f{0, 0, 1};
        }
    }

    std::vector<Vec3f> face_sums() const {
        const GeometryData& g = result_.data;
        std::vector<glm::dvec3> sums(g.positions.size(), glm::dvec3(0));
        const auto at = [&](std::uint32_t i) { return glm::dvec3(g.positions[i].x, g.positions[i].y, g.positions[i].z); };
        for (std::size_t t = 0; t + 2 < g.indices.size(); t += 3) {
            const glm::dvec3 n = glm::cross(at(g.indices[t + 1]) - at(g.indices[t]), at(g.indices[t + 2]) - at(g.indices[t]));
            for (int c = 0; c < 3; ++c) sums[g.indices[t + static_cast<std::size_t>(c)]] += n;
        }
        std::vector<Vec3f> result;
        for (const glm::dvec3& sum : sums) {
            const double l = glm::length(sum);
            const glm::dvec3 n = l > 0 ? sum / l : glm::dvec3(0);
            result.push_back({static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)});
        }
        return result;
    }

    void normalise_positions() {
        GeometryData& g = result_.data;
        Vec3f low = g.positions[0], high = low;
        for (const Vec3f& p : g.positions) {
            low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
        }
        const glm::dvec3 from(low.x, low.y, low.z), to(high.x, high.y, high.z);
        g.centre = (from + to) * 0.5;
        const glm::dvec3 half = (to - from) * 0.5;
        g.scale = std::max({half.x, half.y, half.z});
        if (!(g.scale > 0)) g.scale = 1;  // all points equal
        const double inverse = 1 / g.scale;
        const auto mapped = [&](float value, double centre) { return static_cast<float>((value - centre) * inverse); };
        for (Vec3f& p : g.positions) p = {mapped(p.x, g.centre.x), mapped(p.y, g.centre.y), mapped(p.z, g.centre.z)};
    }

    void build_tangents(int uv_set) {
        GeometryData& g = result_.data;
        if (uv_set < 0) return;
        // Without normals, tangents of the file mean nothing (specification, 3.7.2.1).
        if (!g.normals.empty()) read("TANGENT", 2, g.tangents);
        if (g.tangents.empty()) return add_tangents(g, uv_set);
        for (Vec4f& t : g.tangents) {
            const float squared = t.x * t.x + t.y * t.y + t.z * t.z;
            if (!(squared > 1e-30f)) return add_tangents(g, uv_set);
            const float factor = 1.0f / std::sqrt(squared);
            t = {t.x * factor, t.y * factor, t.z * factor, t.w < 0 ? -1.0f : 1.0f};
        }
    }

    const GltfDocument& document_;
    const tinygltf::Primitive& primitive_;
    std::string pointer_;
    BuiltGeometry result_;
};

}  // namespace

GeometryOutline outline_of(const GltfDocument& document, std::size_t mesh, std::size_t primitive) {
    const tinygltf::Primitive& source = document.model().meshes[mesh].primitives[primitive];
    const auto has = [&](const char* name) { return source.attributes.count(name) > 0; };
    const auto count_of = [&](int accessor) { return document.model().accessors[static_cast<std::size_t>(accessor)].count; };
    GeometryOutline outline;
    if (has("POSITION")) outline.vertices = count_of(source.attributes.at("POSITION"));
    outline.corners = source.indices >= 0 ? count_of(source.indices) : outline.vertices;
    if (source.mode > TINYGLTF_MODE_TRIANGLES) outline.corners = 3 * (std::max<std::size_t>(outline.corners, 2) - 2);
    outline.normals = has("NORMAL");
    outline.tangents = has("TANGENT");
    outline.colors = has("COLOR_0");
    outline.skin = has("JOINTS_0");
    outline.uv = {has("TEXCOORD_0"), has("TEXCOORD_1")};
    outline.targets = source.targets.size();
    return outline;
}

std::string geometry_name(const GltfDocument& document, std::size_t mesh, std::size_t primitive) {
    const std::string& name = document.model().meshes[mesh].name;
    return fmt::format("{}/{}", name.empty() ? fmt::format("mesh {}", mesh) : name, primitive);
}

BuiltGeometry build_geometry(const GltfDocument& document, std::size_t mesh, std::size_t primitive, int normal_uv_set, const GeometryNeeds& needs) {
    return Builder(document, mesh, primitive).build(normal_uv_set, needs);
}

}  // namespace kadr
