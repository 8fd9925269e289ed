#pragma once

#include <string>

#include "kernels/scene/scene_view.h"

namespace kadr {

/// A bit of kernels::requirement for people.
struct RequirementName {
    unsigned bit;
    const char* name;
    const char* meaning;  ///< what a frame shows that needs it
};

inline constexpr RequirementName kRequirementNames[] = {
    {kernels::requirement::kMaps, "maps", "textures and normal maps"},
    {kernels::requirement::kTransforms, "transforms", "meshes that move, or whose copies are not flattened"},
    {kernels::requirement::kEmitters, "emitters", "lights that rays can meet: areas, spheres, wide suns, glowing meshes, an image of the sky"},
    {kernels::requirement::kDeformation, "deformation", "meshes that bend while the shutter is open"},
    {kernels::requirement::kSpecials, "specials",
     "vertex colours, a second set of texture coordinates, partial coverage, unlit materials"},
    {kernels::requirement::kMirrors, "mirrors", "surfaces smoother than roughness 0.032"},
    {kernels::requirement::kIor, "ior", "dielectrics of another index of refraction than 1.5"},
    {kernels::requirement::kFresnel, "fresnel", "dielectrics by Fresnel's equations"},
};

/// "maps emitters"; "nothing" for an empty set.
std::string names_of_requirements(unsigned set);

}  // namespace kadr
