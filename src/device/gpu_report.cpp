#include "device/gpu_report.h"

#include <fmt/format.h>

#include "device/hiprt/gpu_probe.h"
#include "device/hiprt/orochi_runtime.h"

namespace kadr {

std::vector<std::string> describe_gpu_needs() {
    std::vector<std::string> lines;
    for (const GpuNeed& need : probe_gpu(this_machine(), built_with_orochi()).needs)
        lines.push_back(fmt::format("{}: {}", need.name, need.missing.empty() ? need.found : need.missing));
    return lines;
}

std::vector<std::string> unproven_on_gpu() {
    return {
        "every call of HIPRT and Orochi: they were made to fakes that check their arguments",
        "opening a real libhiprt, and the driver's libraries beside it",
        "compiling the kernels on the machine of a GPU, how long that takes, and the cache of what was compiled",
        "that pictures are those of the CPU but for their noise (kadr compare-devices SHOT finds out; the self-check of --device auto looks at a small part)",
        "speed: rays, building structures, what a frame costs beside its rays",
        "that launches stay below 0.1 s and that Ctrl-C is answered within 0.2 s",
        "the choice of build qualities: high and made small for rigid meshes, fast for bending ones and for all instances",
        "meshes that bend: vertices and boxes made by our own kernels; while the shutter is open they are boxes to HIPRT",
        "that the next frame is copied and built beside the launches of the one before, and what that gains",
        "compiling beside other calls of HIPRT, which its sources allow",
        "frames dealt out to several GPUs",
        "when memory runs out: one frame at a time, smaller tiles, structures of lower quality",
    };
}

}  // namespace kadr
