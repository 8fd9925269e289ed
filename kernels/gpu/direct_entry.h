// The analytic model, for the set KADR_REQUIREMENTS.
#pragma once

#include "kernels/gpu/entry.h"

extern "C" __global__ void __launch_bounds__(kadr::kernels::kBlockWidth* kadr::kernels::kBlockHeight)
    kadr_direct(KADR_KERNEL_ARGUMENT kadr::kernels::LaunchParams params) {
    kadr::kernels::render_thread<KADR_REQUIREMENTS, kadr::kernels::IntegratorKind::direct>(params);
}
