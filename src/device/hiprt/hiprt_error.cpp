#include "device/hiprt/hiprt_error.h"

#include <fmt/format.h>

#include "base/error.h"
#include "device/hiprt/gpu_runtime.h"

namespace kadr {

std::string_view text_of(hiprt::Error error) {
    switch (error) {
        case hiprt::Error::success:
            return "success";
        case hiprt::Error::not_implemented:
            return "not implemented";
        case hiprt::Error::internal:
            return "an internal error";
        case hiprt::Error::out_of_host_memory:
            return "out of host memory";
        case hiprt::Error::out_of_device_memory:
            return "out of device memory";
        case hiprt::Error::invalid_api_version:
            return "another API version";
        case hiprt::Error::invalid_parameter:
            return "an invalid parameter";
    }
    return "an unknown error";
}

void check(hiprt::Error result, std::string_view action, std::source_location where) {
    if (result == hiprt::Error::success) return;
    const std::string message =
        fmt::format("cannot {}: HIPRT reports {} ({})", action, text_of(result), place_of(where));
    if (result == hiprt::Error::out_of_device_memory) throw GpuOutOfMemory(message);
    throw RenderError(message);
}

}  // namespace kadr
