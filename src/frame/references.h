#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "shot/shot.h"

namespace kadr {

/// What a reference of the shot names: a node, or a scene's own root (node -1).
struct ResolvedReference {
    int file = -1;
    int node = -1;
};

/// "scene/Parent/Node" of a node, from the root of its file down.
std::string node_path(const Scene& scene, int file, int node);

/// Resolves "scene", "scene/Node" and "scene/Parent/Node"; the parents given may skip levels.
/// @throws InputError  unknown scene or node ("did you mean"), or a name that several nodes have (their paths)
ResolvedReference resolve(const Scene& scene, const NodeReference& reference);

/// The node whose camera a reference means: the node itself, a node below it (exporters hang cameras under a turned
/// helper), or a camera of that name.
/// @throws InputError  where there is no camera, with those that there are
int resolve_camera(const Scene& scene, const NodeReference& reference);

/// The node of a scene entry that a name of its `nodes` or `hide` means: "Node" or "Parent/Node", where levels may be
/// left out.
/// @throws InputError  for no such node ("did you mean"), or several (their paths)
int resolve_node(const Scene& scene, int file, const NamedAt& name);
/// All nodes of a name or path; where there is none as resolve_node.
std::vector<int> resolve_nodes(const Scene& scene, int file, const NamedAt& name);

/// The clips that a layer of a scene entry plays, as indices into Scene::clips.
/// @throws InputError  for a clip that the file does not have, that several share the name of, or that animates nothing
std::vector<int> playing_clips(const Scene& scene, int file, const ClipLayer& layer);

}  // namespace kadr
