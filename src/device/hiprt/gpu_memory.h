#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "device/hiprt/gpu_runtime.h"

namespace kadr {

/// What device memory is taken for.
enum class MemoryUse : std::uint8_t { vertices, structures, motion, textures, tables, film, scratch };
inline constexpr std::size_t kMemoryUses = 7;

std::string_view name_of(MemoryUse use);

/// "1.5 GiB", "12 KiB", "100 B"
std::string bytes_text(std::size_t bytes);

/// The memory of a GPU and what of it is taken for what. Outlives everything that is allocated from it; used by one
/// thread at a time.
class GpuMemory {
public:
    explicit GpuMemory(GpuRuntime& runtime) : runtime_(runtime) {}

    GpuRuntime& runtime() const { return runtime_; }
    /// @throws GpuOutOfMemory  with the figures of summary()
    DeviceAddress allocate(std::size_t bytes, MemoryUse use);
    /// Waits for all work first, so that none can still use it. Reports on standard error, never throws.
    void release(DeviceAddress address, std::size_t bytes, MemoryUse use) noexcept;

    // What others allocate (HIPRT its structures) is noted here.
    void note_taken(std::size_t bytes, MemoryUse use) { taken_[static_cast<std::size_t>(use)] += bytes; }
    void note_given_back(std::size_t bytes, MemoryUse use) { taken_[static_cast<std::size_t>(use)] -= bytes; }

    /// What was given up because memory was short.
    void note_step(const std::string& step);
    void forget_steps() { steps_.clear(); }
    const std::string& steps() const { return steps_; }  ///< "frames are no longer made ahead, the film comes in parts"

    std::size_t taken(MemoryUse use) const { return taken_[static_cast<std::size_t>(use)]; }
    std::size_t taken() const;
    std::size_t free_bytes();  ///< as the runtime reports
    /// "vertices 1.2 GiB, film 64 MiB; 3.1 GiB of 16.0 GiB are free"
    std::string summary();

private:
    GpuRuntime& runtime_;
    std::array<std::size_t, kMemoryUses> taken_{};
    std::string steps_;
};

}  // namespace kadr
