#include "frame/references.h"

#include <algorithm>
#include <numeric>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.h"
#include "frame/problem.h"

namespace kadr {

namespace {

constexpr std::size_t kMostListed = 6;

const Node& node_at(const Scene& scene, int node) { return scene.nodes[static_cast<std::size_t>(node)]; }

std::string listed(const std::vector<std::string>& names) {
    const std::vector<std::string> shown(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(std::min(names.size(), kMostListed)));
    return fmt::format("{}{}", fmt::join(shown, ", "), names.size() > kMostListed ? fmt::format(" and {} more", names.size() - kMostListed) : "");
}

std::string suggestion(std::string_view word, const std::vector<std::string>& names, std::string_view what) {
    if (const auto nearest = nearest_name(word, names)) return fmt::format("did you mean '{}'?", *nearest);
    if (names.empty()) return fmt::format("there are no {}", what);
    return fmt::format("expected one of the {}: {}", what, listed(names));
}

int file_named(const Scene& scene, const NodeReference& reference, std::string_view id) {
    std::vector<std::string> ids;
    for (std::size_t f = 0; f < scene.files.size(); ++f) {
        if (scene.files[f].id == id) return static_cast<int>(f);
        ids.push_back(scene.files[f].id);
    }
    throw InputError(problem_at(reference.where, fmt::format("'{}' names no scene", reference.text), suggestion(id, ids, "scenes")));
}

std::vector<std::string> split(std::string_view path) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t end = std::min(path.find('/', begin), path.size());
        parts.emplace_back(path.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

/// A node's name; "#" and its index in its file where it has none.
std::string label(const Scene& scene, const SceneFile& file, int node) {
    const std::string& name = node_at(scene, node).name;
    return name.empty() ? fmt::format("#{}", node - file.first_node) : name;
}

/// Whether a node's label is the last part and the others are labels above it, in this order.
bool matches(const Scene& scene, const SceneFile& file, int node, const std::vector<std::string>& parts) {
    if (label(scene, file, node) != parts.back()) return false;
    std::size_t left = parts.size() - 1;
    for (int above = node_at(scene, node).parent; left > 0 && above >= 0; above = node_at(scene, above).parent)
        if (label(scene, file, above) == parts[left - 1]) --left;
    return left == 0;
}

std::vector<int> nodes_named(const Scene& scene, const SceneFile& file, const std::string& path) {
    std::vector<int> found;
    for (const std::vector<std::string>& parts : {std::vector<std::string>{path}, split(path)}) {  // a name may hold a '/'
        for (int node = file.first_node; node < file.first_node + file.node_count; ++node)
            if (matches(scene, file, node, parts)) found.push_back(node);
        if (!found.empty()) break;
    }
    return found;
}

std::vector<std::string> node_names(const Scene& scene, const SceneFile& file) {
    std::set<std::string> names;
    for (int node = file.first_node; node < file.first_node + file.node_count; ++node)
        if (!node_at(scene, node).name.empty()) names.insert(file.id + "/" + node_at(scene, node).name);
    return {names.begin(), names.end()};
}

[[noreturn]] void refuse_ambiguous(const Scene& scene, const NodeReference& reference, int file, const std::vector<int>& nodes) {
    std::vector<std::string> paths;
    for (const int node : nodes) paths.push_back(node_path(scene, file, node));
    throw InputError(problem_at(reference.where, fmt::format("'{}' names {} nodes", reference.text, nodes.size()),
                                fmt::format("expected one; add a parent's name: {}", listed(paths))));
}

bool below(const Scene& scene, int node, int ancestor) {
    while (node >= 0 && node != ancestor) node = node_at(scene, node).parent;
    return node == ancestor;
}

/// Nodes with a camera at or below a node (-1: in the whole file).
std::vector<int> cameras_below(const Scene& scene, const SceneFile& file, int ancestor) {
    std::vector<int> found;
    for (int node = file.first_node; node < file.first_node + file.node_count; ++node)
        if (node_at(scene, node).camera >= 0 && (ancestor < 0 || below(scene, node, ancestor))) found.push_back(node);
    return found;
}

std::vector<int> cameras_named(const Scene& scene, const SceneFile& file, std::string_view name) {
    std::vector<int> found = cameras_below(scene, file, -1);
    std::erase_if(found, [&](int node) { return scene.cameras[static_cast<std::size_t>(node_at(scene, node).camera)].name != name; });
    return found;
}

}  // namespace

std::string node_path(const Scene& scene, int file, int node) {
    const SceneFile& source = scene.files[static_cast<std::size_t>(file)];
    std::string path;
    for (; node >= 0; node = node_at(scene, node).parent) path = "/" + label(scene, source, node) + path;
    return source.id + path;
}

ResolvedReference resolve(const Scene& scene, const NodeReference& reference) {
    const std::size_t slash = reference.text.find('/');
    const int file = file_named(scene, reference, std::string_view(reference.text).substr(0, slash));
    if (slash == std::string::npos) return {file, -1};
    const SceneFile& source = scene.files[static_cast<std::size_t>(file)];
    const std::vector<int> nodes = nodes_named(scene, source, reference.text.substr(slash + 1));
    if (nodes.size() > 1) refuse_ambiguous(scene, reference, file, nodes);
    if (nodes.empty())
        throw InputError(problem_at(reference.where, fmt::format("'{}' names no node", reference.text),
                                    suggestion(reference.text, node_names(scene, source), "nodes")));
    return {file, nodes.front()};
}

int resolve_camera(const Scene& scene, const NodeReference& reference) {
    const std::size_t slash = reference.text.find('/');
    const int file = file_named(scene, reference, std::string_view(reference.text).substr(0, slash));
    const SceneFile& source = scene.files[static_cast<std::size_t>(file)];
    const std::string name = slash == std::string::npos ? "" : reference.text.substr(slash + 1);
    const std::vector<int> named = name.empty() ? std::vector<int>{} : cameras_named(scene, source, name);
    const std::vector<int> nodes = name.empty() ? std::vector<int>{-1} : nodes_named(scene, source, name);
    std::vector<int> cameras;
    if (nodes.size() == 1) cameras = cameras_below(scene, source, nodes.front());
    if (nodes.size() == 1 && nodes.front() >= 0 && node_at(scene, nodes.front()).camera >= 0) cameras = nodes;
    if (cameras.empty()) cameras = named;
    if (cameras.size() > 1) refuse_ambiguous(scene, reference, file, cameras);
    if (!cameras.empty()) return cameras.front();
    std::vector<std::string> paths;
    for (const int node : cameras_below(scene, source, -1)) paths.push_back(node_path(scene, file, node));
    throw InputError(problem_at(reference.where, fmt::format("camera.gltf is '{}', which is no camera", reference.text),
                                suggestion(reference.text, paths, fmt::format("cameras of '{}'", source.id))));
}

std::vector<int> resolve_nodes(const Scene& scene, int file, const NamedAt& name) {
    const SceneFile& source = scene.files[static_cast<std::size_t>(file)];
    const std::vector<int> nodes = nodes_named(scene, source, name.name);
    if (!nodes.empty()) return nodes;
    std::vector<std::string> names;
    for (const std::string& path : node_names(scene, source)) names.push_back(path.substr(source.id.size() + 1));
    throw InputError(problem_at(name.where, fmt::format("'{}' names no node of scene '{}'", name.name, source.id), suggestion(name.name, names, "nodes")));
}

int resolve_node(const Scene& scene, int file, const NamedAt& name) {
    const std::vector<int> nodes = resolve_nodes(scene, file, name);
    if (nodes.size() == 1) return nodes.front();
    std::vector<std::string> paths;
    const std::size_t id = scene.files[static_cast<std::size_t>(file)].id.size() + 1;
    for (const int node : nodes) paths.push_back(node_path(scene, file, node).substr(id));
    throw InputError(problem_at(name.where, fmt::format("'{}' names {} nodes of scene '{}'", name.name, nodes.size(), scene.files[static_cast<std::size_t>(file)].id),
                                fmt::format("expected one; add a parent's name: {}", listed(paths))));
}

namespace {

[[noreturn]] void refuse_clip(const ClipLayer& layer, std::string found, std::string expected) {
    throw InputError(problem_at(layer.where, std::move(found), std::move(expected)));
}

int clip_by_index(const SceneFile& file, const ClipLayer& layer) {
    if (layer.clip_index < file.clip_count) return file.first_clip + layer.clip_index;
    refuse_clip(layer, fmt::format("scene '{}' has no clip {}", file.id, layer.clip_index),
                file.clip_count == 0 ? "the file has no clips; leave `clip` out" : fmt::format("expected 0 to {}", file.clip_count - 1));
}

int clip_by_name(const Scene& scene, const SceneFile& file, const ClipLayer& layer) {
    std::vector<int> found;
    std::vector<std::string> names;
    for (int clip = file.first_clip; clip < file.first_clip + file.clip_count; ++clip) {
        names.push_back(scene.clips[static_cast<std::size_t>(clip)].name);
        if (names.back() == layer.clip_name) found.push_back(clip);
    }
    if (found.empty())
        refuse_clip(layer, fmt::format("scene '{}' has no clip '{}'", file.id, layer.clip_name), suggestion(layer.clip_name, names, "clips of the file"));
    if (found.size() > 1)
        refuse_clip(layer, fmt::format("scene '{}' has {} clips '{}'", file.id, found.size(), layer.clip_name), "expected one; give its index");
    return found.front();
}

void check_clip(const Scene& scene, const SceneFile& file, const ClipLayer& layer, int index) {
    const Clip& clip = scene.clips[static_cast<std::size_t>(index)];
    const std::string name = clip.name.empty() ? fmt::format("clip {}", index - file.first_clip) : fmt::format("clip '{}'", clip.name);
    if (!clip.animates())
        refuse_clip(layer, fmt::format("{} of scene '{}' animates nothing", name, file.id),
                    clip.channel_count == 0 ? "it has no channels; leave it out"
                                            : fmt::format("its {} channels point to what Kadr does not animate; leave it out", clip.channel_count));
    if (layer.in_s.value_or(0) > clip.end_s && !layer.out_s)
        refuse_clip(layer, fmt::format("in is {} s, and {} of scene '{}' ends at {} s", format_number(*layer.in_s), name, file.id, format_number(clip.end_s)),
                    fmt::format("expected 0 to {} s", format_number(clip.end_s)));
}

}  // namespace

std::vector<int> playing_clips(const Scene& scene, int file, const ClipLayer& layer) {
    const SceneFile& source = scene.files[static_cast<std::size_t>(file)];
    if (layer.clips == ClipLayer::Clips::none) return {};
    if (layer.clips == ClipLayer::Clips::all) {
        std::vector<int> all(static_cast<std::size_t>(source.clip_count));
        std::iota(all.begin(), all.end(), source.first_clip);
        return all;
    }
    const int clip = layer.clip_index >= 0 ? clip_by_index(source, layer) : clip_by_name(scene, source, layer);
    check_clip(scene, source, layer, clip);
    return {clip};
}

}  // namespace kadr
