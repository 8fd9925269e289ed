// Boxes around triangles whose corners move while the shutter is open.
#pragma once

#include "kernels/deform/bend.h"

extern "C" __global__ void __launch_bounds__(kadr::kernels::kBendBlock) kadr_boxes(const kadr::kernels::BoxParams params) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i < params.geometry.triangle_count) params.boxes[i] = kadr::kernels::box_of(params.geometry, i);
}
