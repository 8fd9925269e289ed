#pragma once

#include <vector>

#include "frame/snapshot.h"

namespace kadr {

/// Which instances of a snapshot go into the flat scene: what stands still for the whole shot and is not repeated beyond
/// measure, is not hidden, and is large enough against its distance from the render origin.
std::vector<bool> choose_flattened(const Scene& scene, const SceneSnapshot& snapshot);

}  // namespace kadr
