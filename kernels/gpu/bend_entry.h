// Vertices of meshes that bend.
#pragma once

#include "kernels/deform/bend.h"

extern "C" __global__ void __launch_bounds__(kadr::kernels::kBendBlock) kadr_bend(const kadr::kernels::BendParams params) {
    const unsigned long i = static_cast<unsigned long>(blockIdx.x) * blockDim.x + threadIdx.x;
    if (i < static_cast<unsigned long>(params.rest.vertex_count) * params.poses.key_count)
        kadr::kernels::bend_vertex(params, i);
}
