#include "tracing_gpu.h"

#include "brute_force_tracer.h"
#include "kernels/gpu/entry_points.h"

namespace kadr::test {
namespace {

using kernels::IntegratorKind;
using kernels::Kernel;

/// What kernels are compiled for here: all that a scene may require.
constexpr unsigned set_of(Kernel kernel) { return kernels::kernel_requirements(kernel, kernels::requirement::kAll); }

template <IntegratorKind kIntegrator>
double trace(const FakeHiprt& hiprt, const kernels::LaunchParams& params) {
    constexpr unsigned kSet = set_of(kernels::kernel_of(kIntegrator));
    kernels::LaunchCounters counters{};
    for (int y = params.y0; y < params.y1; ++y)
        for (int x = params.x0; x < params.x1; ++x) {
            if (!kernels::is_wanted(params, x, y)) continue;
            BruteForceTracer tracer(hiprt, params, kIntegrator == IntegratorKind::direct);
            kernels::PixelDriver<float, kSet, kIntegrator, BruteForceTracer>(params, tracer, x, y).render(counters);
        }
    params.counters->rays += counters.rays;
    params.counters->samples += counters.samples;
    params.counters->dropped += counters.dropped;
    return 1e-6;
}

double probe(const FakeHiprt& hiprt, const kernels::ProbeParams& params) {
    BruteForceTracer tracer(hiprt, params.frame, true);
    for (unsigned i = 0; i < params.count; ++i) kernels::answer_probe<set_of(Kernel::probe)>(params, tracer, i);
    return 1e-6;
}

}  // namespace

TracingGpu::TracingGpu() {
    runtime->on_launch = [this](const std::string& function, const std::byte* argument) {
        if (const std::optional<double> other = run_other(function, argument)) {
            if (function != kernels::entry_point(Kernel::probe).name) return *other;
            return probe(hiprt, argument_of<kernels::ProbeParams>(argument));
        }
        const auto params = argument_of<kernels::LaunchParams>(argument);
        return function == kernels::entry_point(Kernel::path).name ? trace<IntegratorKind::path>(hiprt, params)
                                                                   : trace<IntegratorKind::direct>(hiprt, params);
    };
}

}  // namespace kadr::test
