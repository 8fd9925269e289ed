// Single rays, for the set KADR_REQUIREMENTS.
#pragma once

#include "kernels/gpu/entry.h"
#include "kernels/gpu/probe.h"

extern "C" __global__ void __launch_bounds__(kadr::kernels::kProbeBlock)
    kadr_probe(KADR_KERNEL_ARGUMENT kadr::kernels::ProbeParams params) {
    const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= params.count) return;
    kadr::kernels::LaunchCounters counters{};
    kadr::kernels::HiprtTracer tracer(params.frame, true, counters);
    kadr::kernels::answer_probe<KADR_REQUIREMENTS>(params, tracer, i);
}
