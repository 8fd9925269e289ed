// What kernels are compiled for.
#pragma once

namespace kadr::kernels {

/// What a shot asks of the kernels beyond the plain case; they are compiled once a set, so a shot pays for what it
/// uses.
namespace requirement {
inline constexpr unsigned kMaps = 1;        ///< textures, normal maps
inline constexpr unsigned kTransforms = 2;  ///< instances that are not flattened, moving ones
inline constexpr unsigned kEmitters =
    4;  ///< lights that rays can hit: MIS with area lights, triangles, environment maps
inline constexpr unsigned kDeformation = 8;  ///< meshes that bend while the shutter is open
/// Vertex colours, a second set of texture coordinates, partial coverage, unlit materials; never without kMaps.
inline constexpr unsigned kSpecials = 16;
inline constexpr unsigned kMirrors = 32;  ///< lobes narrower than kMinAlpha (bsdf/ggx.h), down to deltas; only by `path`
inline constexpr unsigned kIor = 64;      ///< dielectrics of another index of refraction than 1.5
inline constexpr unsigned kFresnel = 128;  ///< Settings::exact_fresnel, and a dielectric to see it on (bsdf/fresnel.h)
inline constexpr unsigned kAll = kMaps | kTransforms | kEmitters | kDeformation | kSpecials | kMirrors | kIor | kFresnel;
}  // namespace requirement

}  // namespace kadr::kernels
