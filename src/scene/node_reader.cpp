#include "scene/node_reader.h"

#include <fmt/format.h>

#include <cmath>

namespace kadr {

namespace {

glm::dvec3 vector3(const std::vector<double>& v, glm::dvec3 otherwise) { return v.size() == 3 ? glm::dvec3(v[0], v[1], v[2]) : otherwise; }

glm::dmat4 read_matrix(const GltfDocument& document, const std::string& pointer, const std::vector<double>& v) {
    glm::dmat4 matrix;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) matrix[column][row] = v[static_cast<std::size_t>(4 * column + row)];
    constexpr double kTolerance = 1e-5;  // of exporters that multiply in single precision
    for (int column = 0; column < 4; ++column)
        if (std::abs(matrix[column][3] - (column == 3 ? 1 : 0)) > kTolerance)
            document.fail(pointer + "/matrix", fmt::format("has {} as element {}", matrix[column][3], 4 * column + 3), "expected 0, 0, 0, 1 in the last row: an affine transform");
    for (int column = 0; column < 4; ++column) matrix[column][3] = column == 3 ? 1 : 0;
    return matrix;
}

glm::dquat read_rotation(const GltfDocument& document, const std::string& pointer, const std::vector<double>& v) {
    if (v.size() != 4) return {1, 0, 0, 0};
    const glm::dquat rotation(v[3], v[0], v[1], v[2]);
    const double length = glm::length(rotation);
    if (!(length > 1e-6)) document.fail(pointer + "/rotation", "is a quaternion of length 0", "expected a unit quaternion, x y z w");
    return rotation / length;
}

int light_of(const tinygltf::Node& node) {
    const auto found = node.extensions.find("KHR_lights_punctual");
    return found != node.extensions.end() && found->second.Has("light") ? found->second.Get("light").GetNumberAsInt() : -1;
}

bool visibility_of(const tinygltf::Node& node) {
    const auto found = node.extensions.find("KHR_node_visibility");
    return found == node.extensions.end() || !found->second.Has("visible") || found->second.Get("visible").Get<bool>();
}

Node read_node(const GltfDocument& document, std::size_t index) {
    const tinygltf::Node& source = document.model().nodes[index];
    const std::string pointer = fmt::format("/nodes/{}", index);
    Node node;
    node.name = source.name;
    if (source.matrix.size() == 16) {
        if (!source.translation.empty() || !source.rotation.empty() || !source.scale.empty())
            document.fail(pointer, "has a matrix and also translation, rotation or scale", "expected one or the other");
        node.matrix = read_matrix(document, pointer, source.matrix);
    }
    node.translation = vector3(source.translation, glm::dvec3(0));
    node.rotation = read_rotation(document, pointer, source.rotation);
    node.scale = vector3(source.scale, glm::dvec3(1));
    node.children = source.children;
    node.light = light_of(source);
    node.visible = visibility_of(source);
    node.camera = source.camera;
    return node;
}

void set_parents(const GltfDocument& document, std::vector<Node>& nodes) {
    for (std::size_t i = 0; i < nodes.size(); ++i)
        for (const int child : nodes[i].children) {
            Node& node = nodes[static_cast<std::size_t>(child)];
            if (node.parent >= 0)
                document.fail(fmt::format("/nodes/{}/children", i), fmt::format("names node {}, which node {} has already", child, node.parent),
                              "expected a tree: one parent for each node");
            node.parent = static_cast<int>(i);
        }
}

/// With one parent each, nodes that no root reaches are on cycles or hang below them.
void refuse_cycles(const GltfDocument& document, const std::vector<Node>& nodes) {
    std::vector<bool> reached(nodes.size());
    std::vector<int> open;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (nodes[i].parent < 0) open.push_back(static_cast<int>(i));
    while (!open.empty()) {
        const auto index = static_cast<std::size_t>(open.back());
        open.pop_back();
        reached[index] = true;
        open.insert(open.end(), nodes[index].children.begin(), nodes[index].children.end());
    }
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (!reached[i]) document.fail(fmt::format("/nodes/{}", i), "is its own ancestor, or hangs below a node that is", "expected a tree without cycles");
}

}  // namespace

std::vector<Node> read_nodes(const GltfDocument& document) {
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < document.model().nodes.size(); ++i) nodes.push_back(read_node(document, i));
    set_parents(document, nodes);
    refuse_cycles(document, nodes);
    return nodes;
}

std::vector<int> read_roots(const GltfDocument& document, const std::vector<Node>& nodes) {
    const tinygltf::Model& model = document.model();
    std::vector<int> roots;
    if (model.scenes.empty()) {
        for (std::size_t i = 0; i < nodes.size(); ++i)
            if (nodes[i].parent < 0) roots.push_back(static_cast<int>(i));
        return roots;
    }
    const std::size_t scene = model.defaultScene >= 0 ? static_cast<std::size_t>(model.defaultScene) : 0;
    std::vector<bool> listed(nodes.size());
    for (const int root : model.scenes[scene].nodes) {
        const auto index = static_cast<std::size_t>(root);
        if (nodes[index].parent >= 0)
            document.fail(fmt::format("/scenes/{}/nodes", scene), fmt::format("names node {}, which is a child of node {}", root, nodes[index].parent), "expected root nodes");
        if (listed[index]) document.fail(fmt::format("/scenes/{}/nodes", scene), fmt::format("names node {} twice", root), "expected each root node once");
        listed[index] = true;
        roots.push_back(root);
    }
    return roots;
}

std::vector<SceneLight> read_lights(const GltfDocument& document) {
    std::vector<SceneLight> lights;
    for (const tinygltf::Light& source : document.model().lights) {
        SceneLight light;
        light.name = source.name;
        light.kind = source.type == "directional" ? kernels::LightKind::directional : source.type == "spot" ? kernels::LightKind::spot : kernels::LightKind::point;
        light.color = vector3(source.color, glm::dvec3(1));
        light.intensity = source.intensity;
        light.range_m = source.range;
        light.inner_rad = source.spot.innerConeAngle;
        light.outer_rad = source.spot.outerConeAngle;
        if (light.kind == kernels::LightKind::spot && light.inner_rad >= light.outer_rad)
            document.fail(fmt::format("/extensions/KHR_lights_punctual/lights/{}/spot/innerConeAngle", lights.size()), fmt::format("is {}", light.inner_rad),
                          fmt::format("expected less than outerConeAngle, {}", light.outer_rad));
        lights.push_back(std::move(light));
    }
    return lights;
}

std::vector<SceneCamera> read_cameras(const GltfDocument& document) {
    std::vector<SceneCamera> cameras;
    for (const tinygltf::Camera& source : document.model().cameras) {
        const std::string pointer = fmt::format("/cameras/{}", cameras.size());
        SceneCamera camera;
        camera.name = source.name;
        camera.orthographic = source.type == "orthographic";
        const char* member = camera.orthographic ? "orthographic" : "perspective";
        if (!document.json()["cameras"][cameras.size()].contains(member))
            document.fail(fmt::format("{}/{}", pointer, member), "is missing", fmt::format("expected an object: the camera's type is {}", member));
        camera.yfov_rad = source.perspective.yfov;
        camera.aspect = source.perspective.aspectRatio;
        camera.xmag = std::abs(source.orthographic.xmag);
        camera.ymag = std::abs(source.orthographic.ymag);
        camera.znear = camera.orthographic ? source.orthographic.znear : source.perspective.znear;
        camera.zfar = camera.orthographic ? source.orthographic.zfar : source.perspective.zfar;
        if (camera.orthographic && !(camera.xmag > 0 && camera.ymag > 0))
            document.fail(pointer + "/orthographic", fmt::format("has xmag {} and ymag {}", camera.xmag, camera.ymag), "expected numbers other than 0");
        const bool finite_far = camera.orthographic || camera.zfar > 0;
        if (finite_far && !(camera.zfar > camera.znear))
            document.fail(fmt::format("{}/{}/zfar", pointer, member), fmt::format("is {}", camera.zfar), fmt::format("expected more than znear, {}", camera.znear));
        cameras.push_back(std::move(camera));
    }
    return cameras;
}

}  // namespace kadr
