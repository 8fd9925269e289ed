#include "device/tables/kernel_needs.h"

namespace kadr {

unsigned kernel_requirements_of(const MaterialTable& materials, bool instances, bool bends, const kernels::LightSet& lights) {
    unsigned requirements = materials.requirements();
    if (instances) requirements |= kernels::requirement::kTransforms;
    if (bends) requirements |= kernels::requirement::kDeformation;
    if (lights.visible_count > 0 || lights.triangle_count > 0 || lights.has_map) requirements |= kernels::requirement::kEmitters;
    return requirements;
}

}  // namespace kadr
