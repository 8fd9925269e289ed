#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "device/hiprt/hiprt_handles.h"

namespace kadr {

/// How much time a structure takes to build, for how fast rays are in it.
enum class StructureQuality : std::uint8_t { fast, balanced, high };

/// What the size query, the creation, the build and every update of a structure are given alike.
hiprt::BuildOptions build_options(StructureQuality quality, bool filtered);

/// One mesh whose structure is to be built.
struct StructureJob {
    hiprt::GeometryBuildInput input;
    HiprtGeometry* result;
};

/// Builds structures on a stream, with one scratch buffer that all builds share, one after another.
class StructureBuilder {
public:
    StructureBuilder(HiprtContext& context, GpuMemory& memory, const GpuStream& stream)
        : context_(context), memory_(memory), stream_(stream) {}

    HiprtContext& context() const { return context_; }
    GpuMemory& memory() const { return memory_; }
    const GpuStream& stream() const { return stream_; }

    /// All in one call of HIPRT each for room, scratch and building; they share one allocation, freed with the last.
    /// Inputs have to be on the stream already. Their results are replaced.
    /// @throws GpuOutOfMemory  results are then what they were
    void build(std::span<const StructureJob> jobs, const hiprt::BuildOptions& options);
    /// Makes structures as small as they can be, where there is room to do so. Waits for them to be built.
    void compact(std::span<HiprtGeometry* const> structures);
    /// New bounds for moved vertices of the same triangles. @param options  those that it was built with
    void update(const StructureJob& job, const hiprt::BuildOptions& options);

    /// In the memory that it has where that is of the right size, else in new memory.
    void build_top_level(HiprtTopLevel& level, const hiprt::SceneBuildInput& input, const hiprt::BuildOptions& options);
    void give_scratch_back() { scratch_ = {}; }

private:
    void reserve_scratch(std::size_t bytes);

    HiprtContext& context_;
    GpuMemory& memory_;
    const GpuStream& stream_;
    DeviceBuffer<std::byte> scratch_;
};

}  // namespace kadr
