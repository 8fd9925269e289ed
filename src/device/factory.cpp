#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "base/error.h"
#include "device/device.h"
#include "device/embree/embree_device.h"
#include "device/hiprt/gpu_probe.h"
#include "device/hiprt/orochi_runtime.h"

namespace kadr {
namespace {

/// Lanes by request, KADR_WIDTH or the processor. @throws InputError for a width that cannot run here
int choose_width(int requested) {
    int width = requested;
    if (width == 0) {
        const char* text = std::getenv("KADR_WIDTH");
        if (!text || !*text) return best_width();
        char* end = nullptr;
        const long value = std::strtol(text, &end, 10);
        if (*end != '\0' || (value != 1 && value != 8))
            throw InputError(fmt::format("KADR_WIDTH is '{}'", text), "expected 1 (the portable form) or 8 (AVX2)");
        width = static_cast<int>(value);
    }
    if (width > best_width())
        throw InputError("KADR_WIDTH is 8, but this processor has no AVX2", "use KADR_WIDTH=1, or leave it unset");
    return width;
}

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return "unknown processor";
}

/// Why there is no GPU to render on, in one sentence.
std::string why_no_gpu() {
    const GpuProbe probe = probe_gpu(this_machine(), built_with_orochi());
    return probe.complete() ? "this build cannot render on a GPU yet" : probe.missing();
}

}  // namespace

DeviceChoice make_device(const DeviceRequest& request) {
    if (request.name == "hiprt")
        throw InputError(fmt::format("--device hiprt: {}", why_no_gpu()),
                         "use --device cpu, or --device auto, which takes the best that works");
    if (request.name != "auto" && request.name != "cpu")
        throw InputError(fmt::format("--device is '{}'", request.name), "expected auto, cpu or hiprt");
    DeviceChoice choice;
    choice.device = make_embree_device(request.threads, choose_width(request.width));
    choice.why = request.name == "cpu" ? "asked for by --device cpu" : why_no_gpu();
    return choice;
}

std::vector<DeviceReport> list_devices() {
    const int width = choose_width(0);
    return {{"cpu",
             fmt::format("{}, {} threads, {} lane{}", processor_name(), std::thread::hardware_concurrency(), width,
                         width == 1 ? "" : "s"),
             true, ""},
            {"hiprt", "AMD and NVIDIA GPUs through HIPRT and Orochi", false, why_no_gpu()}};
}

}  // namespace kadr
