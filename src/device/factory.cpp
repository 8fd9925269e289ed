#include <charconv>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <variant>

#include <fmt/format.h>

#include "base/error.h"
#include "device/device.h"
#include "device/embree/embree_device.h"
#include "device/gpu_choice.h"
#include "device/hiprt/gpu_access.h"

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

/// Kernels by request or KADR_KERNEL_SET; never by_environment.
/// @throws InputError  for a value that is none
KernelChoice choose_kernels(KernelChoice requested) {
    if (requested != KernelChoice::by_environment) return requested;
    const char* text = std::getenv("KADR_KERNEL_SET");
    const std::string value = text ? text : "";
    if (value == "all") return KernelChoice::all;
    if (value.empty() || value == "needed") return KernelChoice::needed;
    throw InputError(fmt::format("KADR_KERNEL_SET is '{}'", value),
                     "expected needed (the kernels that a frame can do with) or all (those that can render anything)");
}

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return "unknown processor";
}

/// The GPU of "hiprt" or "hiprt:2"; none for other names.
/// @throws InputError  for a list of GPUs, or what is no number
std::optional<int> gpu_number(const std::string& name) {
    if (name == "hiprt") return 0;
    if (!name.starts_with("hiprt:")) return std::nullopt;
    const std::string number = name.substr(6);
    if (number.find(',') != std::string::npos)
        throw InputError(fmt::format("--device {}: frames are not dealt out to several GPUs yet", name), "name one, as in hiprt:0");
    int value = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (error != std::errc() || end != number.data() + number.size() || value < 0)
        throw InputError(fmt::format("--device is '{}'", name), "expected the number of a GPU, as in hiprt:0; see kadr devices");
    return value;
}

/// The GPU where it works, else the CPU; and why.
DeviceChoice make_best_device(const DeviceRequest& request) {
    const KernelChoice kernels = choose_kernels(request.kernels);
    return take_best(try_gpu(0, kernels), fault_of, [&] { return make_embree_device(request.threads, choose_width(request.width), kernels); });
}

/// What the self-check says of the GPU that `auto` would take.
std::string check_of_first_gpu() {
    const Found<StartedGpu> gpu = try_gpu(0, KernelChoice::needed);
    if (const std::string* missing = std::get_if<std::string>(&gpu)) return *missing;
    const std::string fault = fault_of(std::get<StartedGpu>(gpu));
    return fault.empty() ? "" : fault + " in its self-check; --device hiprt takes it all the same";
}

std::string names_of(const std::vector<GpuProperties>& gpus) {
    std::string names;
    for (std::size_t i = 0; i < gpus.size(); ++i)
        names += fmt::format("{}{}: {} ({})", i == 0 ? "" : ", ", i, gpus[i].name, gpus[i].architecture);
    return names;
}

}  // namespace

DeviceChoice make_device(const DeviceRequest& request) {
    if (const std::optional<int> gpu = gpu_number(request.name))
        return take_gpu(try_gpu(*gpu, choose_kernels(request.kernels)), request.name, fault_of);
    if (request.name == "auto") return make_best_device(request);
    if (request.name != "cpu")
        throw InputError(fmt::format("--device is '{}'", request.name), "expected auto, cpu, hiprt or hiprt:NUMBER");
    return {make_embree_device(request.threads, choose_width(request.width), choose_kernels(request.kernels)),
            "asked for by --device cpu", ""};
}

std::vector<DeviceReport> list_devices() {
    const int width = choose_width(0);
    const GpuList gpus = list_gpus();
    const std::string fault = gpus.missing.empty() ? check_of_first_gpu() : gpus.missing;
    return {{"cpu",
             fmt::format("{}, {} threads, {} lane{}", processor_name(), std::thread::hardware_concurrency(), width,
                         width == 1 ? "" : "s"),
             true, ""},
            {"hiprt", gpus.gpus.empty() ? "AMD and NVIDIA GPUs through HIPRT and Orochi" : names_of(gpus.gpus),
             fault.empty(), fault}};
}

}  // namespace kadr
