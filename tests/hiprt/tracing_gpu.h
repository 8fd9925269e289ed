#pragma once

#include <cstring>
#include <string>

#include "brute_force_tracer.h"
#include "fake_gpu.h"
#include "kernels/gpu/entry_points.h"

namespace kadr::test {

/// What kernels are compiled for here: all that a scene may require.
template <kernels::IntegratorKind kIntegrator>
inline constexpr unsigned kSet = kernels::kernel_requirements(kIntegrator, kernels::requirement::kAll);

template <kernels::IntegratorKind kIntegrator>
double trace(const FakeHiprt& hiprt, const kernels::LaunchParams& params) {
    kernels::LaunchCounters counters{};
    for (int y = params.y0; y < params.y1; ++y)
        for (int x = params.x0; x < params.x1; ++x) {
            if (!kernels::is_wanted(params, x, y)) continue;
            BruteForceTracer tracer(hiprt, params, kIntegrator == kernels::IntegratorKind::direct);
            kernels::PixelDriver<float, kSet<kIntegrator>, kIntegrator, BruteForceTracer>(params, tracer, x, y)
                .render(counters);
        }
    params.counters->rays += counters.rays;
    params.counters->samples += counters.samples;
    params.counters->dropped += counters.dropped;
    return 1e-6;
}

/// A GPU whose kernels render.
struct TracingGpu : FakeGpu {
    TracingGpu() {
        runtime->on_launch = [this](const std::string& function, const std::byte* argument) {
            kernels::LaunchParams params;
            std::memcpy(static_cast<void*>(&params), argument, sizeof params);
            return function == "kadr_path" ? trace<kernels::IntegratorKind::path>(hiprt, params)
                                           : trace<kernels::IntegratorKind::direct>(hiprt, params);
        };
    }
};

}  // namespace kadr::test
