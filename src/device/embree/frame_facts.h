#pragma once

#include <string>

#include "frame/snapshot.h"

namespace kadr {

/// What a frame asks of the kernels: a set of kernels::requirement bits, as EmbreeScene finds it, but without building
/// anything and without texels.
unsigned requirements_of(const Scene& scene, const SceneSnapshot& snapshot);

/// "textures + instances"; "plain" where there is nothing to name.
std::string name_of_requirements(unsigned requirements);

}  // namespace kadr
