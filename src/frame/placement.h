#pragma once

#include <cstdint>
#include <vector>

#include "anim/placement.h"
#include "shot/instances_spec.h"

namespace kadr {

/// Copies of a list or of a grid, x fastest.
/// @pre spec has no scatter
std::vector<Placement> place_copies(const InstancesSpec& spec);

/// What the random ranges of a spec make of the copy of this number: a function of seed and number alone.
void vary(const InstancesSpec& spec, std::uint32_t number, Placement& placement);

/// A random number in [0, 1), a function of its arguments alone.
double random_unit(std::uint32_t seed, std::uint32_t number, std::uint32_t dimension);

}  // namespace kadr
