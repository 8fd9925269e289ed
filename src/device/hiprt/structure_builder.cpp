#include "device/hiprt/structure_builder.h"

#include <algorithm>

#include "device/hiprt/hiprt_error.h"

namespace kadr {
namespace {

std::vector<hiprt::GeometryBuildInput> inputs_of(std::span<const StructureJob> jobs) {
    std::vector<hiprt::GeometryBuildInput> inputs;
    for (const StructureJob& job : jobs) inputs.push_back(job.input);
    return inputs;
}

}  // namespace

hiprt::BuildOptions build_options(StructureQuality quality, bool filtered) {
    constexpr std::uint32_t kFlags[] = {hiprt::build_flag::kFast, hiprt::build_flag::kBalanced,
                                        hiprt::build_flag::kHighQuality};
    hiprt::BuildOptions options;
    options.flags = kFlags[static_cast<int>(quality)];
    // With splits a triangle lies in several leaves, and a shadow ray would be dimmed by it more than once.
    if (filtered) options.flags |= hiprt::build_flag::kNoSpatialSplits;
    return options;
}

void StructureBuilder::reserve_scratch(std::size_t bytes) {
    scratch_.reserve(memory_, std::max<std::size_t>(bytes, 1), MemoryUse::scratch);
}

void StructureBuilder::build(std::span<const StructureJob> jobs, const hiprt::BuildOptions& options) {
    if (jobs.empty()) return;
    const hiprt::Api& api = context_.api();
    const auto count = static_cast<std::uint32_t>(jobs.size());
    const std::vector<hiprt::GeometryBuildInput> inputs = inputs_of(jobs);
    std::size_t scratch = 0;
    check(api.geometries_temporary_size(context_.handle(), count, inputs.data(), options, scratch),
          "ask how much scratch memory a structure takes");
    reserve_scratch(scratch);
    std::vector<hiprt::Geometry> handles(count, nullptr);
    std::vector<hiprt::Geometry*> places;
    for (hiprt::Geometry& handle : handles) places.push_back(&handle);
    const std::size_t before = memory_.free_bytes();
    check_created(api.create_geometries(context_.handle(), count, inputs.data(), options, places.data()),
                  "the structures of meshes", memory_);
    std::vector<HiprtGeometry> made;
    for (const hiprt::Geometry handle : handles) made.emplace_back(context_, memory_, handle);
    const std::size_t after = memory_.free_bytes();
    for (HiprtGeometry& structure : made) structure.note_bytes(before > after ? (before - after) / count : 0);
    check(api.build_geometries(context_.handle(), hiprt::BuildOperation::build, count, inputs.data(), options,
                               scratch_.pointer(), stream_.handle(), handles.data()),
          "build the structures of meshes");
    for (std::size_t i = 0; i < jobs.size(); ++i) *jobs[i].result = std::move(made[i]);
}

void StructureBuilder::compact(std::span<HiprtGeometry* const> structures) {
    if (structures.empty()) return;
    // HIPRT reads the structures' headers at once, whatever is on the stream.
    stream_.synchronize("build the structures of meshes");
    const auto count = static_cast<std::uint32_t>(structures.size());
    std::vector<hiprt::Geometry> before, after(count, nullptr);
    std::vector<hiprt::Geometry*> places;
    for (const HiprtGeometry* structure : structures) before.push_back(structure->handle());
    for (hiprt::Geometry& handle : after) places.push_back(&handle);
    const std::size_t free_before = memory_.free_bytes();
    const hiprt::Error compacted =
        context_.api().compact_geometries(context_.handle(), count, stream_.handle(), before.data(), places.data());
    // For a while both are there. Where there is no room for that, the large ones stay: they fit.
    if (compacted == hiprt::Error::internal || compacted == hiprt::Error::out_of_device_memory) return;
    check(compacted, "make the structures of meshes smaller");
    for (std::size_t i = 0; i < structures.size(); ++i) structures[i]->replace(after[i]);
    const std::size_t free_after = memory_.free_bytes();
    const std::size_t gained = free_after > free_before ? (free_after - free_before) / count : 0;
    for (HiprtGeometry* structure : structures)
        structure->note_bytes(structure->bytes() - std::min(gained, structure->bytes()));
}

void StructureBuilder::update(const StructureJob& job, const hiprt::BuildOptions& options) {
    hiprt::Geometry handle = job.result->handle();
    check(context_.api().build_geometries(context_.handle(), hiprt::BuildOperation::update, 1, &job.input, options,
                                          nullptr, stream_.handle(), &handle),
          "update the structure of a bending mesh");
}

void StructureBuilder::build_top_level(HiprtTopLevel& level, const hiprt::SceneBuildInput& input,
                                       const hiprt::BuildOptions& options) {
    const hiprt::Api& api = context_.api();
    std::size_t scratch = 0;
    check(api.scene_temporary_size(context_.handle(), input, options, scratch),
          "ask how much scratch memory the structure of all instances takes");
    reserve_scratch(scratch);
    if (!level.fits(input, options)) {
        level = {};
        level = HiprtTopLevel(context_, memory_, input, options);
    }
    check(api.build_scene(context_.handle(), hiprt::BuildOperation::build, input, options, scratch_.pointer(),
                          stream_.handle(), level.handle()),
          "build the structure of all instances");
}

}  // namespace kadr
