#include "device/hiprt/gpu_probe.h"

#include <optional>
#include <regex>
#include <span>

#include <fmt/format.h>

// Where kernels/ lies when the program runs where it was built.
#ifndef KADR_KERNEL_SOURCE_DIR
#define KADR_KERNEL_SOURCE_DIR ""
#endif

namespace kadr {
namespace {

namespace fs = std::filesystem;

// The names that HIPRT and Orochi try, in their order (hiprt_libpath.h, cuew.cpp): what only another name opens is
// missing for them.
constexpr const char* kAmdDriver[] = {
    "libamdhip64.so",   "/opt/rocm/lib/libamdhip64.so",   "/opt/rocm/hip/lib/libamdhip64.so",
    "libamdhip64.so.7", "/opt/rocm/lib/libamdhip64.so.7", "/opt/rocm/hip/lib/libamdhip64.so.7",
    "libamdhip64.so.6", "/opt/rocm/lib/libamdhip64.so.6", "/opt/rocm/hip/lib/libamdhip64.so.6",
    "libamdhip64.so.5", "/opt/rocm/lib/libamdhip64.so.5", "/opt/rocm/hip/lib/libamdhip64.so.5"};
constexpr const char* kAmdCompiler[] = {
    "/opt/rocm/hip/lib/libhiprtc.so",   "/opt/rocm/lib/libhiprtc.so",   "libhiprtc.so",
    "/opt/rocm/hip/lib/libhiprtc.so.7", "/opt/rocm/lib/libhiprtc.so.7", "libhiprtc.so.7",
    "/opt/rocm/hip/lib/libhiprtc.so.6", "/opt/rocm/lib/libhiprtc.so.6", "libhiprtc.so.6",
    "/opt/rocm/hip/lib/libhiprtc.so.5", "/opt/rocm/lib/libhiprtc.so.5", "libhiprtc.so.5"};
// What the kernel's part of the driver shows; under Windows' Linux it is dxg for both.
constexpr const char* kAmdNodes[] = {"/dev/kfd", "/dev/dxg"};
constexpr const char* kNvidiaNodes[] = {"/dev/nvidiactl", "/dev/nvhost-ctrl", "/dev/dxg"};
constexpr const char* kNvidiaDriver[] = {"libcuda.so", "libcuda.so.1"};
constexpr const char* kNvidiaRuntime[] = {"libcudart.so"};
constexpr const char* kNvidiaCompiler[] = {"libnvrtc.so", "/usr/local/cuda/lib64/libnvrtc.so",
                                           "/usr/local/cuda/lib/libnvrtc.so"};

std::optional<std::string> first_that_opens(const HostSystem& machine, std::span<const char* const> names) {
    for (const char* name : names)
        if (machine.can_open(name)) return name;
    return std::nullopt;
}

GpuNeed library_need(const char* name, const std::optional<std::string>& opened, const char* missing) {
    if (opened) return {name, *opened, ""};
    return {name, "", missing};
}

/// The node of a vendor's driver: libraries are not even opened where there is none, so looking costs nothing there.
std::optional<std::string> find_node(const HostSystem& machine, GpuVendor vendor) {
    const std::span<const char* const> nodes =
        vendor == GpuVendor::amd ? std::span<const char* const>(kAmdNodes) : std::span<const char* const>(kNvidiaNodes);
    for (const char* node : nodes)
        if (machine.exists(node)) return node;
    return std::nullopt;
}

GpuNeed need_driver(const HostSystem& machine, GpuProbe& probe) {
    std::string missing =
        "no GPU: neither /dev/kfd (AMD) nor /dev/nvidiactl (NVIDIA) is there; install the driver of your GPU, or let "
        "this "
        "machine or container use it";
    for (const GpuVendor vendor : {GpuVendor::nvidia, GpuVendor::amd}) {
        const std::optional<std::string> node = find_node(machine, vendor);
        if (!node) continue;
        const bool amd = vendor == GpuVendor::amd;
        const std::optional<std::string> library =
            amd ? first_that_opens(machine, kAmdDriver) : first_that_opens(machine, kNvidiaDriver);
        probe.vendor = vendor;
        if (library) return {"driver", fmt::format("{} and {}", *node, *library), ""};
        missing = fmt::format(
            "the library of the GPU's driver is missing: {} is there, but {} cannot be opened; install {}", *node,
            amd ? "libamdhip64.so" : "libcuda.so.1", amd ? "the HIP runtime (ROCm)" : "NVIDIA's driver");
    }
    return {"driver", "", missing};
}

GpuNeed need_runtime(const HostSystem& machine, GpuProbe& probe) {
    if (probe.vendor == GpuVendor::amd) return {"runtime", "in the driver's library", ""};
    const std::optional<std::string> opened = first_that_opens(machine, kNvidiaRuntime);
    // HIPRT 3.1 calls this function without looking whether it is there.
    if (opened && !machine.exports(*opened, "cudaGetDeviceProperties_v2"))
        return {
            "runtime", "",
            fmt::format(
                "{} is not the runtime of CUDA 12 (it has no cudaGetDeviceProperties_v2), which HIPRT 3.1 needs; let "
                "LD_LIBRARY_PATH name the folder of CUDA 12 first",
                *opened)};
    return library_need(
        "runtime", opened,
        "the CUDA runtime is missing: libcudart.so cannot be opened; install the runtime of CUDA 12, and let "
        "LD_LIBRARY_PATH name the folder that has it under exactly this name");
}

GpuNeed need_compiler(const HostSystem& machine, GpuProbe& probe) {
    if (probe.vendor == GpuVendor::amd)
        return library_need(
            "compiler", first_that_opens(machine, kAmdCompiler),
            "the run-time compiler is missing: libhiprtc.so cannot be opened; install the HIP SDK (ROCm)");
    return library_need(
        "compiler", first_that_opens(machine, kNvidiaCompiler),
        "the run-time compiler is missing: libnvrtc.so cannot be opened; install NVRTC of CUDA 12 or 13, and let "
        "LD_LIBRARY_PATH name the folder that has it under exactly this name");
}

GpuNeed need_orochi(bool has_runtime) {
    if (has_runtime) return {"Orochi", "built in", ""};
    return {"Orochi", "",
            "this program was built without Orochi; build Orochi, and configure with -DOROCHI_ROOT=FOLDER (see the "
            "README)"};
}

GpuNeed need_library(const HostSystem& machine, GpuProbe& probe) {
    const Found<fs::path> found = find_hiprt_library(machine);
    if (const std::string* missing = std::get_if<std::string>(&found)) return {"HIPRT", "", *missing};
    probe.hiprt_library = std::get<fs::path>(found);
    return {"HIPRT", probe.hiprt_library.string(), ""};
}

/// The API version that a folder of HIPRT's headers is of; none where its hiprt.h does not tell.
std::optional<unsigned> header_version(const HostSystem& machine, const fs::path& folder) {
    static const std::regex kVersion("#define\\s+HIPRT_API_VERSION\\s+([0-9]{1,6})");
    const std::string text = machine.text_of(folder / "hiprt/hiprt.h");
    std::smatch match;
    if (!std::regex_search(text, match, kVersion)) return std::nullopt;
    return static_cast<unsigned>(std::stoul(match[1].str()));
}

/// Where HIPRT's headers should be: HIPRT_PATH, which HIPRT itself reads, else what HIPRT_ROOT or the library's own
/// folder lead to.
std::vector<fs::path> header_folders(const HostSystem& machine, const fs::path& library) {
    if (const std::optional<std::string> path = machine.variable("HIPRT_PATH")) return {*path};
    std::vector<fs::path> folders;
    if (const std::optional<std::string> root = machine.variable("HIPRT_ROOT")) {
        folders.push_back(fs::path(*root) / "include");
        folders.emplace_back(*root);
    }
    folders.push_back(library.parent_path().parent_path() / "include");
    folders.push_back(library.parent_path().parent_path());
    return folders;
}

GpuNeed need_headers(const HostSystem& machine, GpuProbe& probe) {
    for (const fs::path& folder : header_folders(machine, probe.hiprt_library)) {
        if (!machine.is_file(folder / "hiprt/impl/hiprt_device_impl.h")) continue;
        const std::optional<unsigned> version = header_version(machine, folder);
        if (version && *version != hiprt::kApiVersion)
            return {"headers", "",
                    fmt::format(
                        "HIPRT's headers in {} are those of its API {}, but the library's is {}; set HIPRT_PATH to the "
                        "include folder of HIPRT 3.1",
                        folder.string(), *version, hiprt::kApiVersion)};
        probe.hiprt_headers = folder;
        return {"headers", folder.string(), ""};
    }
    const std::optional<std::string> path = machine.variable("HIPRT_PATH");
    return {"headers", "",
            path ? fmt::format(
                       "HIPRT_PATH is {}, which does not hold hiprt/impl/hiprt_device_impl.h; set it to the include "
                       "folder of HIPRT 3.1",
                       *path)
                 : "HIPRT's headers are missing, from which kernels are compiled; set HIPRT_PATH to the include folder "
                   "of HIPRT 3.1"};
}

GpuNeed need_kernels(const HostSystem& machine, GpuProbe& probe) {
    std::vector<fs::path> folders;
    const std::optional<std::string> given = machine.variable("KADR_KERNELS");
    if (given)
        folders = {*given};
    else
        folders = {machine.program_folder() / "../share/kadr", KADR_KERNEL_SOURCE_DIR};
    for (const fs::path& folder : folders) {
        if (!machine.is_file(folder / "kernels/gpu/launch_params.h")) continue;
        probe.kernel_folder = folder.lexically_normal();
        return {"kernels", (probe.kernel_folder / "kernels").string(), ""};
    }
    return {"kernels", "",
            given ? fmt::format(
                        "KADR_KERNELS is {}, which does not hold kernels/gpu; set it to the folder that holds Kadr's "
                        "kernels folder",
                        *given)
                  : fmt::format(
                        "Kadr's own kernels are missing: neither {} nor {} holds kernels/gpu; set KADR_KERNELS to the "
                        "folder that holds Kadr's kernels folder",
                        folders[0].lexically_normal().string(), folders[1].string())};
}

}  // namespace

GpuProbe probe_gpu(const HostSystem& machine, bool has_runtime) {
    GpuProbe probe;
    const auto there = [&](GpuNeed need) {
        probe.needs.push_back(std::move(need));
        return probe.needs.back().missing.empty();
    };
    // Each is looked for only when those before it are there.
    (void)(there(need_driver(machine, probe)) && there(need_runtime(machine, probe)) &&
           there(need_compiler(machine, probe)) && there(need_orochi(has_runtime)) &&
           there(need_library(machine, probe)) && there(need_headers(machine, probe)) &&
           there(need_kernels(machine, probe)));
    return probe;
}

}  // namespace kadr
