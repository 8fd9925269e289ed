#pragma once

#include "kernels/scene/scene_view.h"

namespace kadr {

/// What the filter functions need of a geometry; Embree holds a pointer to it.
struct GeometryUser {
    const kernels::SceneView* view = nullptr;
    unsigned geometry = 0, material = 0;  ///< indices into the view's tables
    bool cull = false;
};

}  // namespace kadr
