#include "device/hiprt/gpu_access.h"

#include <cstdlib>

#include <fmt/format.h>

#include "base/cache_folder.h"
#include "base/error.h"
#include "base/hash.h"
#include "device/hiprt/gpu_probe.h"
#include "device/hiprt/hiprt_device.h"
#include "device/hiprt/hiprt_library.h"
#include "device/hiprt/kernel_cache.h"
#include "device/hiprt/orochi_runtime.h"
#include "device/hiprt/trace_kernels.h"

namespace kadr {
namespace {

constexpr const char* kNoneFound =
    "the driver finds no GPU; is one built in, and may this machine or container use it?";

std::filesystem::path kernel_cache() {
    const std::optional<std::filesystem::path> folder = cache_folder();
    return folder ? prepare_kernel_cache(*folder / "kernels") : std::filesystem::path();
}

/// Named after what the outcome of a self-check depends on: the GPU, its driver, HIPRT, and our kernels.
std::filesystem::path check_file(const GpuProbe& probe, const GpuProperties& gpu, const std::filesystem::path& folder) {
    if (folder.empty()) return {};
    const HostSystem& machine = this_machine();
    Hasher hasher;
    for (const std::string& text : {gpu.name, gpu.architecture, machine.text_of("/proc/driver/nvidia/version"),
                                    machine.text_of("/sys/module/amdgpu/srcversion"), machine.text_of("/proc/version"), probe.needs.front().found})
        hasher.add(text);
    hasher.add(hash_file(probe.hiprt_library).hex());
    hasher.add(hash_of_kernels(probe.kernel_folder));
    return folder.parent_path() / "gpu-checks" / hasher.finish().hex();
}

/// @throws InputError, RenderError  with what went wrong on the way
StartedGpu start(const GpuProbe& probe, int number, KernelChoice kernels) {
    // HIPRT reads it when it compiles.
    setenv("HIPRT_PATH", probe.hiprt_headers.c_str(), 1);
    HiprtParts parts;
    parts.api = HiprtLibrary::open(probe.hiprt_library).api();
    parts.runtime = make_orochi_runtime(probe.vendor, number);
    parts.kernel_folder = probe.kernel_folder;
    parts.cache_folder = kernel_cache();
    parts.kernels = kernels;
    StartedGpu gpu;
    gpu.name = parts.runtime->properties().name;
    gpu.check_file = check_file(probe, parts.runtime->properties(), parts.cache_folder);
    gpu.device = make_hiprt_device(std::move(parts));
    return gpu;
}

}  // namespace

GpuList list_gpus() {
    const GpuProbe probe = probe_gpu(this_machine(), built_with_orochi());
    if (!probe.complete()) return {{}, probe.missing()};
    GpuList list;
    try {
        const int count = count_gpus(probe.vendor);
        for (int i = 0; i < count; ++i) list.gpus.push_back(make_orochi_runtime(probe.vendor, i)->properties());
    } catch (const RenderError& error) {
        return {{}, error.what()};
    }
    if (list.gpus.empty()) list.missing = kNoneFound;
    return list;
}

Found<StartedGpu> try_gpu(int number, KernelChoice kernels) {
    const GpuProbe probe = probe_gpu(this_machine(), built_with_orochi());
    if (!probe.complete()) return probe.missing();
    try {
        const int count = count_gpus(probe.vendor);
        if (count == 0) return kNoneFound;
        if (number >= count)
            return fmt::format("there is no GPU {}, only 0 to {}; see kadr devices", number, count - 1);
        return start(probe, number, kernels);
    } catch (const InputError& error) {
        return error.diagnostics().front().found;
    } catch (const RenderError& error) {
        return error.what();
    }
}

}  // namespace kadr
