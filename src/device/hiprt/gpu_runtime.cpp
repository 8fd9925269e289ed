#include "device/hiprt/gpu_runtime.h"

#include <filesystem>

#include <fmt/format.h>

namespace kadr {

std::string place_of(const std::source_location& where) {
    return fmt::format("{}:{}", std::filesystem::path(where.file_name()).filename().string(), where.line());
}

void check(const GpuResult& result, std::string_view action, std::source_location where) {
    if (result.kind == GpuResult::Kind::success) return;
    const std::string message =
        fmt::format("cannot {}: the GPU runtime reports {} ({})", action, result.text, place_of(where));
    if (result.kind == GpuResult::Kind::out_of_memory) throw GpuOutOfMemory(message);
    throw RenderError(message);
}

}  // namespace kadr
