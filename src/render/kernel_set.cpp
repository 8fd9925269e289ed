#include "render/kernel_set.h"

#include <algorithm>
#include <initializer_list>

#include "kernels/scene/scene_view.h"
#include "render/requirements.h"

namespace kadr {
namespace {

using namespace kernels::requirement;

/// What asks for a requirement. On a GPU every instance has its transform: what is shown asks for that.
struct Asker {
    unsigned requirements;
    std::initializer_list<Feature> features;
};
const Asker kAskers[] = {
    {kMaps, {Feature::texture_base_color, Feature::texture_metallic_roughness, Feature::texture_normal, Feature::texture_emissive}},
    {kMaps | kSpecials, {Feature::vertex_colors, Feature::second_uv_set, Feature::unlit, Feature::alpha_mask, Feature::alpha_blend}},
    {kEmitters, {Feature::light_sun, Feature::light_sphere, Feature::light_area, Feature::light_mesh, Feature::environment_image}},
    {kDeformation, {Feature::blur_vertices}},
    {kMirrors, {Feature::mirror}},
    {kIor, {Feature::index_of_refraction}},
    {kFresnel, {Feature::exact_fresnel}},
};

constexpr Feature kAskFunctions[] = {Feature::alpha_mask, Feature::alpha_blend, Feature::back_face_culling, Feature::blur_vertices};

}  // namespace

KernelSet kernel_set_of(const BoundShot& shot) {
    const RequirementSet needs = requirements_of(shot);
    const auto any = [&](const auto& features) { return std::any_of(std::begin(features), std::end(features), [&](Feature f) { return needs.needs(f); }); };
    KernelSet set;
    set.integrator = needs.needs(Feature::integrator_direct) ? kernels::IntegratorKind::direct : kernels::IntegratorKind::path;
    set.requirements = kTransforms;
    for (const Asker& asker : kAskers)
        if (any(asker.features)) set.requirements |= asker.requirements;
    set.asks_functions = any(kAskFunctions);
    return set;
}

}  // namespace kadr
