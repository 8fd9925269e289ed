#include "device/hiprt/gpu_memory.h"

#include <cstdio>
#include <numeric>

#include <fmt/format.h>

namespace kadr {
namespace {

constexpr std::string_view kNames[kMemoryUses] = {"vertices", "structures", "motion", "textures",
                                                  "tables",   "film",       "scratch"};

}  // namespace

std::string_view name_of(MemoryUse use) { return kNames[static_cast<std::size_t>(use)]; }

std::string bytes_text(std::size_t bytes) {
    constexpr const char* kUnits[] = {"KiB", "MiB", "GiB", "TiB"};
    if (bytes < 1024) return fmt::format("{} B", bytes);
    double value = static_cast<double>(bytes) / 1024;
    int unit = 0;
    for (; value >= 1024 && unit < 3; ++unit) value /= 1024;
    return fmt::format("{:.1f} {}", value, kUnits[unit]);
}

DeviceAddress GpuMemory::allocate(std::size_t bytes, MemoryUse use) {
    DeviceAddress address = 0;
    const GpuResult result = runtime_.allocate(bytes, address);
    const std::string action = fmt::format("allocate {} for {}", bytes_text(bytes), name_of(use));
    if (result.kind == GpuResult::Kind::out_of_memory)
        throw GpuOutOfMemory(fmt::format("cannot {}: the memory of the GPU is full ({})", action, summary()));
    check(result, action);
    note_taken(bytes, use);
    return address;
}

void GpuMemory::release(DeviceAddress address, std::size_t bytes, MemoryUse use) noexcept {
    const GpuResult waited = runtime_.synchronize_all();
    const GpuResult result = runtime_.release(address);
    note_given_back(bytes, use);
    for (const GpuResult& r : {waited, result})
        if (r.kind != GpuResult::Kind::success)
            fmt::print(stderr, "kadr: cannot free {} of the GPU's memory: {}\n", bytes_text(bytes), r.text);
}

void GpuMemory::note_step(const std::string& step) {
    if (steps_.find(step) == std::string::npos) steps_ += (steps_.empty() ? "" : ", ") + step;
}

std::size_t GpuMemory::taken() const { return std::accumulate(taken_.begin(), taken_.end(), std::size_t{0}); }

std::size_t GpuMemory::free_bytes() {
    std::size_t free = 0, total = 0;
    check(runtime_.memory(free, total), "ask how much memory is free");
    return free;
}

std::string GpuMemory::summary() {
    std::string text;
    for (std::size_t i = 0; i < kMemoryUses; ++i)
        if (taken_[i] > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", kNames[i], bytes_text(taken_[i]));
    if (text.empty()) text = "nothing of it is ours";
    std::size_t free = 0, total = 0;
    if (runtime_.memory(free, total).kind != GpuResult::Kind::success) return text;
    return text + fmt::format("; {} of {} are free", bytes_text(free), bytes_text(total));
}

}  // namespace kadr
