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

/// The clips that an entry of the shot plays, as indices into Scene::clips.
/// @throws InputError  for a clip that the file does not have
std::vector<int> playing_clips(const Scene& scene, std::size_t file, const SceneSpec& spec);

}  // namespace kadr
