#pragma once

// What we use of the library HIPRT, API version 3001: its structs, byte for byte, and its entry points. The library is
// opened when the program runs, so its own header is not needed to build; where HIPRT_ROOT is given, a test compares
// the two (tests/hiprt/abi_test.cpp). Pointers in the structs are device addresses unless they say otherwise. Source:
// HIPRT 3.1, hiprt.h and hiprt_types.h.

#include <cstddef>
#include <cstdint>

#include "kernels/scene/motion_types.h"

namespace kadr::hiprt {

inline constexpr std::uint32_t kApiVersion = 3001;
inline constexpr std::uint32_t kInvalidValue = 0xffffffffu;
inline constexpr std::uint32_t kFullRayMask = 0xffffffffu;
/// Instances of a scene are counted in 24 bits.
inline constexpr std::uint32_t kMostInstances = (1u << 24) - 1;
/// Vertex buffers are addressed in 32 bits.
inline constexpr std::uint64_t kMostVertexBytes = (std::uint64_t{1} << 32) - 1;

// Handles. They point to device memory, but for the context.
struct ContextHandle;
struct GeometryHandle;
struct SceneHandle;
struct FunctionTableHandle;
using Context = ContextHandle*;
using Geometry = GeometryHandle*;
using Scene = SceneHandle*;
using FunctionTable = FunctionTableHandle*;

using DevicePointer = void*;
using Stream = void*;    ///< hipStream_t or CUstream
using Function = void*;  ///< hipFunction_t or CUfunction
using Module = void*;    ///< hipModule_t or CUmodule

enum class Error : int {
    success = 0,
    not_implemented = 1,
    internal = 2,  ///< whatever failed inside, an exhausted memory among it
    out_of_host_memory = 3,
    out_of_device_memory = 4,
    invalid_api_version = 5,
    invalid_parameter = 6,
};

enum class BuildOperation : int { build = 1, update = 2 };
enum class PrimitiveType : int { triangle_mesh = 0, aabb_list = 1 };
enum class InstanceType : int { geometry = 0, scene = 1 };
enum class FrameType : int { srt = 0, matrix = 1 };
enum class DeviceType : int { amd = 0, nvidia = 1 };

namespace build_flag {
inline constexpr std::uint32_t kFast = 0;         ///< LBVH
inline constexpr std::uint32_t kBalanced = 1;     ///< PLOC
inline constexpr std::uint32_t kHighQuality = 2;  ///< SBVH
inline constexpr std::uint32_t kQualityMask = 3;
inline constexpr std::uint32_t kNoSpatialSplits = 4;  ///< a triangle lies in one leaf, so a filter sees it once a ray
}  // namespace build_flag

namespace log_level {
inline constexpr std::uint32_t kWarnings = 2;
inline constexpr std::uint32_t kErrors = 4;
}  // namespace log_level

struct ContextCreationInput {
    void* context = nullptr;  ///< hipCtx_t or CUcontext
    int device = 0;           ///< hipDevice_t or CUdevice
    DeviceType device_type = DeviceType::amd;
};

struct BuildOptions {
    std::uint32_t flags = build_flag::kFast;
    std::uint32_t batch_max_primitives = 0;  ///< 0: no batch builder, which would be one more long compilation
    bool operator==(const BuildOptions&) const = default;
};

struct TriangleMesh {
    DevicePointer vertices = nullptr;  ///< three floats each
    std::uint32_t vertex_count = 0, vertex_stride = 0;
    DevicePointer indices = nullptr;  ///< three std::uint32_t each
    std::uint32_t triangle_count = 0, triangle_stride = 0;
    DevicePointer pair_indices = nullptr;
    std::uint32_t pair_count = 0;
};

/// Boxes of custom primitives, met by an intersection function.
struct AabbList {
    DevicePointer boxes;  ///< two corners of three floats each, half a stride apart
    std::uint32_t box_count, box_stride;
};

/// A tree to import; unused.
struct NodeList {
    DevicePointer internal_nodes = nullptr, leaf_nodes = nullptr;
    std::uint32_t node_count = 0;
};

struct alignas(64) GeometryBuildInput {
    PrimitiveType type = PrimitiveType::triangle_mesh;
    std::uint32_t geometry_type = kInvalidValue;  ///< row of the function table; invalid: no function is asked
    union {
        TriangleMesh mesh{};
        AabbList list;
    };
    NodeList nodes;
};

struct alignas(16) Instance {
    InstanceType type = InstanceType::geometry;
    Geometry geometry = nullptr;  ///< in HIPRT a union with a scene
};

struct alignas(16) SceneBuildInput {
    DevicePointer instances = nullptr;  ///< Instance[instance_count]
    DevicePointer headers = nullptr;    ///< kernels::TransformHeader[instance_count]
    DevicePointer frames = nullptr;     ///< kernels::FrameSrt or FrameMatrix [frame_count]
    DevicePointer masks = nullptr;      ///< std::uint32_t[instance_count]
    NodeList nodes;
    std::uint32_t instance_count = 0, frame_count = 0;
    FrameType frame_type = FrameType::srt;
};

struct FunctionNames {
    const char *intersect = nullptr, *filter = nullptr;
};

/// What functions of a table get, beside the ray's payload; unused.
struct FunctionData {
    const void *intersect = nullptr, *filter = nullptr;
};

static_assert(sizeof(ContextCreationInput) == 16 && offsetof(ContextCreationInput, device) == 8 &&
              offsetof(ContextCreationInput, device_type) == 12);
static_assert(sizeof(BuildOptions) == 8 && offsetof(BuildOptions, batch_max_primitives) == 4);
static_assert(sizeof(TriangleMesh) == 48 && offsetof(TriangleMesh, vertex_count) == 8 &&
              offsetof(TriangleMesh, vertex_stride) == 12 && offsetof(TriangleMesh, indices) == 16 &&
              offsetof(TriangleMesh, triangle_count) == 24 && offsetof(TriangleMesh, triangle_stride) == 28 &&
              offsetof(TriangleMesh, pair_indices) == 32 && offsetof(TriangleMesh, pair_count) == 40);
static_assert(sizeof(AabbList) == 16 && offsetof(AabbList, box_count) == 8 && offsetof(AabbList, box_stride) == 12);
static_assert(sizeof(NodeList) == 24);
static_assert(sizeof(GeometryBuildInput) == 128 && offsetof(GeometryBuildInput, geometry_type) == 4 &&
              offsetof(GeometryBuildInput, mesh) == 8 && offsetof(GeometryBuildInput, list) == 8 &&
              offsetof(GeometryBuildInput, nodes) == 56);
static_assert(sizeof(Instance) == 16 && offsetof(Instance, geometry) == 8);
static_assert(sizeof(SceneBuildInput) == 80 && offsetof(SceneBuildInput, headers) == 8 &&
              offsetof(SceneBuildInput, frames) == 16 && offsetof(SceneBuildInput, masks) == 24 &&
              offsetof(SceneBuildInput, nodes) == 32 && offsetof(SceneBuildInput, instance_count) == 56 &&
              offsetof(SceneBuildInput, frame_count) == 60 && offsetof(SceneBuildInput, frame_type) == 64);
static_assert(sizeof(FunctionNames) == 16 && sizeof(FunctionData) == 16);

/// The entry points that we use, as the library exports them (hiprtCreateContext, ...). C linkage; references are
/// passed as pointers. Calls with one context have to be made one at a time.
struct Api {
    Error (*create_context)(std::uint32_t api_version, const ContextCreationInput& input, Context& context) = nullptr;
    Error (*destroy_context)(Context) = nullptr;
    Error (*set_log_level)(Context, std::uint32_t level) = nullptr;
    Error (*set_cache_path)(Context, const char* path) = nullptr;
    /// Several geometries share one allocation, which is freed with the last of them.
    Error (*create_geometries)(Context, std::uint32_t count, const GeometryBuildInput*, BuildOptions,
                               Geometry** created) = nullptr;
    Error (*destroy_geometry)(Context, Geometry) = nullptr;
    Error (*geometries_temporary_size)(Context, std::uint32_t count, const GeometryBuildInput*, BuildOptions,
                                       std::size_t& bytes) = nullptr;
    Error (*build_geometries)(Context, BuildOperation, std::uint32_t count, const GeometryBuildInput*, BuildOptions,
                              DevicePointer temporary, Stream, Geometry*) = nullptr;
    /// Synchronises, and destroys the geometries that come in.
    Error (*compact_geometries)(Context, std::uint32_t count, Stream, Geometry* in, Geometry** out) = nullptr;
    Error (*create_scene)(Context, const SceneBuildInput&, BuildOptions, Scene& created) = nullptr;
    Error (*destroy_scene)(Context, Scene) = nullptr;
    Error (*scene_temporary_size)(Context, const SceneBuildInput&, BuildOptions, std::size_t& bytes) = nullptr;
    Error (*build_scene)(Context, BuildOperation, const SceneBuildInput&, BuildOptions, DevicePointer temporary, Stream,
                         Scene) = nullptr;
    Error (*create_function_table)(Context, std::uint32_t geometry_types, std::uint32_t ray_types,
                                   FunctionTable& created) = nullptr;
    Error (*set_function_table)(Context, FunctionTable, std::uint32_t geometry_type, std::uint32_t ray_type,
                                FunctionData) = nullptr;
    Error (*destroy_function_table)(Context, FunctionTable) = nullptr;
    /// Compiles for the GPU at hand; what fails to compile is printed by HIPRT, as its log level tells.
    Error (*build_trace_kernels)(Context, std::uint32_t function_count, const char** function_names, const char* source,
                                 const char* module_name, std::uint32_t header_count, const char** headers,
                                 const char** include_names, std::uint32_t option_count, const char** options,
                                 std::uint32_t geometry_types, std::uint32_t ray_types, FunctionNames*,
                                 Function* functions, Module* module, bool cache) = nullptr;
};

}  // namespace kadr::hiprt
