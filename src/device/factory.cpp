#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
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

[[noreturn]] void refuse_number(const std::string& name) {
    throw InputError(fmt::format("--device is '{}'", name), "expected the number of a GPU, as in hiprt:0, or several, as in hiprt:0,1; see kadr devices");
}

int number_of(std::string_view text, const std::string& name) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < 0) refuse_number(name);
    return value;
}

/// The GPUs of "hiprt", "hiprt:2" or "hiprt:0,1"; none for other names.
/// @throws InputError  for what is no number, or is there twice
std::vector<int> gpu_numbers(const std::string& name) {
    constexpr std::string_view kPrefix = "hiprt:";
    if (name == "hiprt") return {0};
    if (!name.starts_with(kPrefix)) return {};
    std::vector<int> numbers;
    for (std::string_view rest = std::string_view(name).substr(kPrefix.size());;) {
        const std::size_t comma = rest.find(',');
        numbers.push_back(number_of(rest.substr(0, comma), name));
        if (std::count(numbers.begin(), numbers.end(), numbers.back()) > 1)
            throw InputError(fmt::format("--device {}: GPU {} is there twice", name, numbers.back()), "name every GPU once: one renders one frame at a time");
        if (comma == std::string_view::npos) return numbers;
        rest.remove_prefix(comma + 1);
    }
}

DeviceChoice make_gpu(const std::string& name, int number, KernelChoice kernels) { return take_gpu(try_gpu(number, kernels), name, fault_of); }

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
    const std::vector<int> gpus = gpu_numbers(request.name);
    if (gpus.size() > 1)
        throw InputError(fmt::format("--device {}: only kadr render deals out frames to several GPUs", request.name),
                         fmt::format("name one, as in hiprt:{}", gpus.front()));
    if (!gpus.empty()) return make_gpu(request.name, gpus.front(), choose_kernels(request.kernels));
    if (request.name == "auto") return make_best_device(request);
    if (request.name != "cpu")
        throw InputError(fmt::format("--device is '{}'", request.name), "expected auto, cpu, hiprt, hiprt:NUMBER or hiprt:NUMBER,NUMBER");
    return {make_embree_device(request.threads, choose_width(request.width), choose_kernels(request.kernels)),
            "asked for by --device cpu", ""};
}

std::vector<DeviceChoice> make_devices(const DeviceRequest& request) {
    const std::vector<int> gpus = gpu_numbers(request.name);
    std::vector<DeviceChoice> devices;
    for (const int gpu : gpus) devices.push_back(make_gpu(request.name, gpu, choose_kernels(request.kernels)));
    if (devices.empty()) devices.push_back(make_device(request));
    return devices;
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
