#include "device/gpu_choice.h"

#include <variant>

#include <fmt/format.h>

#include "base/error.h"
#include "device/embree/embree_device.h"
#include "device/self_check.h"

namespace kadr {

std::string fault_of(const StartedGpu& gpu) {
    const std::string fault = kept_fault(gpu.check_file, [&] { return find_fault(*gpu.device, *make_embree_device(1, 1, KernelChoice::needed)); });
    return fault.empty() ? fault : fmt::format("the GPU {} {}", gpu.name, fault);
}

DeviceChoice take_best(Found<StartedGpu> found, const FaultOf& fault, const std::function<std::unique_ptr<Device>()>& make_cpu) {
    if (std::string* missing = std::get_if<std::string>(&found)) return {make_cpu(), std::move(*missing), ""};
    StartedGpu& gpu = std::get<StartedGpu>(found);
    if (const std::string wrong = fault(gpu); !wrong.empty()) {
        gpu.device.reset();  // its memory is free before the CPU begins
        return {make_cpu(), fmt::format("{} in its self-check; --device hiprt takes it all the same", wrong), ""};
    }
    return {std::move(gpu.device), "the GPU works, its self-check included; --device cpu takes the CPU", ""};
}

DeviceChoice take_gpu(Found<StartedGpu> found, const std::string& name, const FaultOf& fault) {
    if (const std::string* missing = std::get_if<std::string>(&found))
        throw InputError(fmt::format("--device {}: {}", name, *missing), "use --device cpu, or --device auto, which takes the best that works");
    StartedGpu& gpu = std::get<StartedGpu>(found);
    const std::string wrong = fault(gpu);
    return {std::move(gpu.device), fmt::format("asked for by --device {}", name),
            wrong.empty() ? "" : fmt::format("{} in its self-check: its pictures may be wrong; --device cpu does without it", wrong)};
}

}  // namespace kadr
