#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "device/hiprt/hiprt_abi.h"
#include "recording_runtime.h"

namespace kadr::test {

/// A libhiprt that traces nothing and checks everything: each argument as the library would if it did check, and the
/// rules that it does not state but lives by (design notes: motion frames, builds). Structures take device memory of
/// the recording runtime, so that leaks and early frees show there.
class FakeHiprt {
public:
    explicit FakeHiprt(RecordingRuntime& runtime);
    ~FakeHiprt();

    static hiprt::Api api();

    // What a test reads.
    struct GeometryRecord {
        hiprt::GeometryBuildInput input;
        hiprt::BuildOptions options;
        std::size_t bytes = 0;
        bool built = false, compacted = false;
        int updates = 0;
        std::vector<std::uint32_t> indices;  ///< when it was built
    };
    struct SceneRecord {
        hiprt::SceneBuildInput created_for;
        hiprt::BuildOptions options;
        std::size_t bytes = 0;
        bool built = false;
        std::vector<hiprt::Instance> instances;
        std::vector<kernels::TransformHeader> headers;
        std::vector<kernels::FrameSrt> srt;
        std::vector<kernels::FrameMatrix> matrices;
        std::vector<std::uint32_t> masks;
    };
    struct ModuleRecord {
        std::string source;
        std::vector<std::string> options, functions;  ///< functions: intersect, filter of each geometry type
    };
    std::map<hiprt::Geometry, GeometryRecord> geometries;
    std::map<hiprt::Scene, SceneRecord> scenes;
    std::map<std::string, ModuleRecord> modules;
    std::set<hiprt::FunctionTable> tables;
    std::uint32_t log_level = 0;
    std::string cache_path;
    bool has_context = false;
    std::vector<std::string> leaks() const;
    /// The one scene that there is. @pre there is one
    const SceneRecord& scene() const { return scenes.begin()->second; }

    // What a test sets.
    std::vector<std::size_t> bytes_per_triangle_of = {64, 64, 64};  ///< by quality
    std::size_t bytes_per_instance = 128, temporary_per_primitive = 32;
    std::function<void()> while_compiling;  ///< called by the thread that compiles
    double most_degrees_a_step = 10.01;  ///< 10, and what floats add

private:
    friend struct FakeEntryPoints;
    struct SizeAnswer {
        hiprt::BuildOptions options;
        std::size_t bytes;
    };
    void fault(const std::string& text) { runtime_.fault("hiprt: " + text); }
    void check_options(const hiprt::BuildOptions& options);
    void check_boxes(const hiprt::GeometryBuildInput& input);
    void check_mesh(const hiprt::GeometryBuildInput& input, const hiprt::BuildOptions& options);
    void run_box_build(GeometryRecord& record, const hiprt::GeometryBuildInput& input);
    void run_geometry_build(hiprt::Geometry geometry, const hiprt::GeometryBuildInput& input,
                            hiprt::BuildOperation operation);
    void run_scene_build(hiprt::Scene scene, const hiprt::SceneBuildInput& input);
    void check_frames(const SceneRecord& scene, const kernels::TransformHeader& header, hiprt::FrameType type);
    DeviceAddress take(std::size_t bytes);  ///< 0: full
    void give_back(const void* structure);

    RecordingRuntime& runtime_;
    std::recursive_mutex inside_;  ///< a call that uses the context
    std::map<std::pair<void*, std::size_t>, SizeAnswer> geometry_sizes_;         ///< by vertices and triangle count
    std::map<std::pair<std::uint32_t, std::uint32_t>, SizeAnswer> scene_sizes_;  ///< by instances and frames
};

}  // namespace kadr::test
