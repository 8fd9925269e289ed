// Our header of HIPRT's structs and entry points against HIPRT's own, where HIPRT_ROOT is given to CMake.

#include <gtest/gtest.h>

#include "device/hiprt/hiprt_abi.h"

#ifdef KADR_HAVE_HIPRT_HEADERS
#include <hiprt/hiprt.h>

#include <type_traits>

namespace kadr {
namespace {

/// Whether a value is passed alike: a pointer or reference for one of them, a number of the same size, a struct of the
/// same size.
template <class Ours, class Theirs>
constexpr bool passed_alike() {
    constexpr bool ours_points = std::is_pointer_v<Ours> || std::is_reference_v<Ours>;
    constexpr bool theirs_points = std::is_pointer_v<Theirs> || std::is_reference_v<Theirs>;
    if constexpr (ours_points || theirs_points)
        return ours_points == theirs_points;
    else
        return sizeof(Ours) == sizeof(Theirs) && std::is_class_v<Ours> == std::is_class_v<Theirs>;
}

template <class A, class B>
struct Alike : std::false_type {};
template <class R1, class... P1, class R2, class... P2>
requires(sizeof...(P1) == sizeof...(P2)) struct Alike<R1 (*)(P1...), R2 (*)(P2...)>
    : std::bool_constant<sizeof(R1) == sizeof(R2) && (passed_alike<P1, P2>() && ...)> {
};

#define EXPECT_ALIKE(ours, theirs) EXPECT_TRUE((Alike<decltype(hiprt::Api::ours), decltype(&theirs)>::value)) << #theirs
#define EXPECT_MEMBER(Ours, ours, Theirs, theirs) \
    EXPECT_EQ(offsetof(hiprt::Ours, ours), offsetof(Theirs, theirs)) << #Theirs "." #theirs

TEST(HiprtAbi, Version) { EXPECT_EQ(hiprt::kApiVersion, static_cast<unsigned>(HIPRT_API_VERSION)); }

TEST(HiprtAbi, Sizes) {
    EXPECT_EQ(sizeof(hiprt::ContextCreationInput), sizeof(hiprtContextCreationInput));
    EXPECT_EQ(sizeof(hiprt::BuildOptions), sizeof(hiprtBuildOptions));
    EXPECT_EQ(sizeof(hiprt::TriangleMesh), sizeof(hiprtTriangleMeshPrimitive));
    EXPECT_EQ(sizeof(hiprt::AabbList), sizeof(hiprtAABBListPrimitive));
    EXPECT_EQ(sizeof(hiprt::NodeList), sizeof(hiprtBvhNodeList));
    EXPECT_EQ(sizeof(hiprt::GeometryBuildInput), sizeof(hiprtGeometryBuildInput));
    EXPECT_EQ(sizeof(hiprt::Instance), sizeof(hiprtInstance));
    EXPECT_EQ(sizeof(hiprt::SceneBuildInput), sizeof(hiprtSceneBuildInput));
    EXPECT_EQ(sizeof(hiprt::FunctionNames), sizeof(hiprtFuncNameSet));
    EXPECT_EQ(sizeof(hiprt::FunctionData), sizeof(hiprtFuncDataSet));
    EXPECT_EQ(sizeof(kernels::FrameSrt), sizeof(hiprtFrameSRT));
    EXPECT_EQ(sizeof(kernels::FrameMatrix), sizeof(hiprtFrameMatrix));
    EXPECT_EQ(sizeof(kernels::TransformHeader), sizeof(hiprtTransformHeader));
    EXPECT_EQ(alignof(hiprt::GeometryBuildInput), alignof(hiprtGeometryBuildInput));
    EXPECT_EQ(alignof(hiprt::SceneBuildInput), alignof(hiprtSceneBuildInput));
    EXPECT_EQ(alignof(hiprt::Instance), alignof(hiprtInstance));
}

TEST(HiprtAbi, Offsets) {
    EXPECT_MEMBER(ContextCreationInput, context, hiprtContextCreationInput, ctxt);
    EXPECT_MEMBER(ContextCreationInput, device, hiprtContextCreationInput, device);
    EXPECT_MEMBER(ContextCreationInput, device_type, hiprtContextCreationInput, deviceType);
    EXPECT_MEMBER(BuildOptions, flags, hiprtBuildOptions, buildFlags);
    EXPECT_MEMBER(BuildOptions, batch_max_primitives, hiprtBuildOptions, batchBuildMaxPrimCount);
    EXPECT_MEMBER(TriangleMesh, vertices, hiprtTriangleMeshPrimitive, vertices);
    EXPECT_MEMBER(TriangleMesh, vertex_count, hiprtTriangleMeshPrimitive, vertexCount);
    EXPECT_MEMBER(TriangleMesh, vertex_stride, hiprtTriangleMeshPrimitive, vertexStride);
    EXPECT_MEMBER(TriangleMesh, indices, hiprtTriangleMeshPrimitive, triangleIndices);
    EXPECT_MEMBER(TriangleMesh, triangle_count, hiprtTriangleMeshPrimitive, triangleCount);
    EXPECT_MEMBER(TriangleMesh, triangle_stride, hiprtTriangleMeshPrimitive, triangleStride);
    EXPECT_MEMBER(TriangleMesh, pair_indices, hiprtTriangleMeshPrimitive, trianglePairIndices);
    EXPECT_MEMBER(TriangleMesh, pair_count, hiprtTriangleMeshPrimitive, trianglePairCount);
    EXPECT_MEMBER(AabbList, boxes, hiprtAABBListPrimitive, aabbs);
    EXPECT_MEMBER(AabbList, box_count, hiprtAABBListPrimitive, aabbCount);
    EXPECT_MEMBER(AabbList, box_stride, hiprtAABBListPrimitive, aabbStride);
    EXPECT_MEMBER(GeometryBuildInput, list, hiprtGeometryBuildInput, primitive.aabbList);
    EXPECT_MEMBER(NodeList, node_count, hiprtBvhNodeList, nodeCount);
    EXPECT_MEMBER(GeometryBuildInput, type, hiprtGeometryBuildInput, type);
    EXPECT_MEMBER(GeometryBuildInput, geometry_type, hiprtGeometryBuildInput, geomType);
    EXPECT_MEMBER(GeometryBuildInput, mesh, hiprtGeometryBuildInput, primitive.triangleMesh);
    EXPECT_MEMBER(GeometryBuildInput, nodes, hiprtGeometryBuildInput, nodeList);
    EXPECT_MEMBER(Instance, type, hiprtInstance, type);
    EXPECT_MEMBER(Instance, geometry, hiprtInstance, geometry);
    EXPECT_MEMBER(SceneBuildInput, instances, hiprtSceneBuildInput, instances);
    EXPECT_MEMBER(SceneBuildInput, headers, hiprtSceneBuildInput, instanceTransformHeaders);
    EXPECT_MEMBER(SceneBuildInput, frames, hiprtSceneBuildInput, instanceFrames);
    EXPECT_MEMBER(SceneBuildInput, masks, hiprtSceneBuildInput, instanceMasks);
    EXPECT_MEMBER(SceneBuildInput, nodes, hiprtSceneBuildInput, nodeList);
    EXPECT_MEMBER(SceneBuildInput, instance_count, hiprtSceneBuildInput, instanceCount);
    EXPECT_MEMBER(SceneBuildInput, frame_count, hiprtSceneBuildInput, frameCount);
    EXPECT_MEMBER(SceneBuildInput, frame_type, hiprtSceneBuildInput, frameType);
    EXPECT_MEMBER(FunctionNames, filter, hiprtFuncNameSet, filterFuncName);
    EXPECT_MEMBER(FunctionData, filter, hiprtFuncDataSet, filterFuncData);
    EXPECT_EQ(offsetof(kernels::FrameSrt, angle), offsetof(hiprtFrameSRT, rotation.w));
    EXPECT_EQ(offsetof(kernels::FrameSrt, scale), offsetof(hiprtFrameSRT, scale));
    EXPECT_EQ(offsetof(kernels::FrameSrt, translation), offsetof(hiprtFrameSRT, translation));
    EXPECT_EQ(offsetof(kernels::FrameSrt, time), offsetof(hiprtFrameSRT, time));
    EXPECT_EQ(offsetof(kernels::FrameMatrix, time), offsetof(hiprtFrameMatrix, time));
    EXPECT_EQ(offsetof(kernels::TransformHeader, frame_count), offsetof(hiprtTransformHeader, frameCount));
}

TEST(HiprtAbi, Constants) {
    EXPECT_EQ(hiprt::kInvalidValue, static_cast<unsigned>(hiprtInvalidValue));
    EXPECT_EQ(hiprt::kFullRayMask, static_cast<unsigned>(hiprtFullRayMask));
    EXPECT_EQ(static_cast<int>(hiprt::Error::success), hiprtSuccess);
    EXPECT_EQ(static_cast<int>(hiprt::Error::not_implemented), hiprtErrorNotImplemented);
    EXPECT_EQ(static_cast<int>(hiprt::Error::internal), hiprtErrorInternal);
    EXPECT_EQ(static_cast<int>(hiprt::Error::out_of_host_memory), hiprtErrorOutOfHostMemory);
    EXPECT_EQ(static_cast<int>(hiprt::Error::out_of_device_memory), hiprtErrorOutOfDeviceMemory);
    EXPECT_EQ(static_cast<int>(hiprt::Error::invalid_api_version), hiprtErrorInvalidApiVersion);
    EXPECT_EQ(static_cast<int>(hiprt::Error::invalid_parameter), hiprtErrorInvalidParameter);
    EXPECT_EQ(static_cast<int>(hiprt::BuildOperation::build), hiprtBuildOperationBuild);
    EXPECT_EQ(static_cast<int>(hiprt::BuildOperation::update), hiprtBuildOperationUpdate);
    EXPECT_EQ(static_cast<int>(hiprt::PrimitiveType::triangle_mesh), hiprtPrimitiveTypeTriangleMesh);
    EXPECT_EQ(static_cast<int>(hiprt::PrimitiveType::aabb_list), hiprtPrimitiveTypeAABBList);
    EXPECT_EQ(static_cast<int>(hiprt::InstanceType::geometry), hiprtInstanceTypeGeometry);
    EXPECT_EQ(static_cast<int>(hiprt::FrameType::srt), hiprtFrameTypeSRT);
    EXPECT_EQ(static_cast<int>(hiprt::FrameType::matrix), hiprtFrameTypeMatrix);
    EXPECT_EQ(static_cast<int>(hiprt::DeviceType::amd), hiprtDeviceAMD);
    EXPECT_EQ(static_cast<int>(hiprt::DeviceType::nvidia), hiprtDeviceNVIDIA);
    EXPECT_EQ(hiprt::build_flag::kFast, static_cast<unsigned>(hiprtBuildFlagBitPreferFastBuild));
    EXPECT_EQ(hiprt::build_flag::kBalanced, static_cast<unsigned>(hiprtBuildFlagBitPreferBalancedBuild));
    EXPECT_EQ(hiprt::build_flag::kHighQuality, static_cast<unsigned>(hiprtBuildFlagBitPreferHighQualityBuild));
    EXPECT_EQ(hiprt::build_flag::kNoSpatialSplits, static_cast<unsigned>(hiprtBuildFlagBitDisableSpatialSplits));
    EXPECT_EQ(hiprt::log_level::kWarnings, static_cast<unsigned>(hiprtLogLevelWarn));
    EXPECT_EQ(hiprt::log_level::kErrors, static_cast<unsigned>(hiprtLogLevelError));
}

TEST(HiprtAbi, EntryPoints) {
    EXPECT_ALIKE(create_context, hiprtCreateContext);
    EXPECT_ALIKE(destroy_context, hiprtDestroyContext);
    EXPECT_ALIKE(set_log_level, hiprtSetLogLevel);
    EXPECT_ALIKE(set_cache_path, hiprtSetCacheDirPath);
    EXPECT_ALIKE(create_geometries, hiprtCreateGeometries);
    EXPECT_ALIKE(destroy_geometry, hiprtDestroyGeometry);
    EXPECT_ALIKE(geometries_temporary_size, hiprtGetGeometriesBuildTemporaryBufferSize);
    EXPECT_ALIKE(build_geometries, hiprtBuildGeometries);
    EXPECT_ALIKE(compact_geometries, hiprtCompactGeometries);
    EXPECT_ALIKE(create_scene, hiprtCreateScene);
    EXPECT_ALIKE(destroy_scene, hiprtDestroyScene);
    EXPECT_ALIKE(scene_temporary_size, hiprtGetSceneBuildTemporaryBufferSize);
    EXPECT_ALIKE(build_scene, hiprtBuildScene);
    EXPECT_ALIKE(create_function_table, hiprtCreateFuncTable);
    EXPECT_ALIKE(set_function_table, hiprtSetFuncTable);
    EXPECT_ALIKE(destroy_function_table, hiprtDestroyFuncTable);
    EXPECT_ALIKE(build_trace_kernels, hiprtBuildTraceKernels);
}

}  // namespace
}  // namespace kadr

#else

TEST(HiprtAbi, AgainstTheRealHeader) {
    GTEST_SKIP() << "no HIPRT headers: configure with -DHIPRT_ROOT=FOLDER to compare our header with HIPRT's own";
}

#endif
