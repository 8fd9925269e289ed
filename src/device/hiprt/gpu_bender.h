#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "device/hiprt/device_table.h"
#include "device/hiprt/gpu_mesh.h"
#include "device/hiprt/hiprt_abi.h"
#include "frame/snapshot.h"
#include "kernels/gpu/entry_points.h"
#include "scene/scene.h"

namespace kadr {

/// What of a geometry its morph targets change, as the kernel reads it: of each vertex, by ascending target.
struct MorphTable {
    std::vector<unsigned> first;               ///< [vertex + 1] into entries; empty: there are no targets
    std::vector<kernels::MorphEntry> entries;
    std::vector<unsigned char> parts;          ///< [target]
};
MorphTable make_morph_table(const GeometryData& geometry);

/// The poses of all keys, one after another.
struct PoseTable {
    std::vector<kernels::Affine> matrices;                      ///< [key][joint]
    std::vector<kernels::DualQuaternionJoint> dual_quaternions; ///< [key][joint]; empty: linear skinning
    std::vector<float> weights;                                 ///< [key][target]
    std::vector<unsigned char> stretches;                       ///< [key]
    unsigned joint_count = 0, target_count = 0;
};
/// @pre mesh.poses is there
PoseTable make_pose_table(const DeformedMesh& mesh, const GeometryData& geometry);

/// Makes the vertices of bending meshes on the GPU: meshes at rest are copied there once, poses in every frame.
class GpuBender {
public:
    using KernelOf = std::function<hiprt::Function(kernels::Kernel)>;
    GpuBender(const Scene& scene, GpuMemory& memory, UploadQueue& uploads, const GpuStream& stream, KernelOf kernel)
        : scene_(scene), memory_(memory), uploads_(uploads), stream_(stream), kernel_(std::move(kernel)) {}

    /// Puts launches on the stream that write the vertices, the tangents and the boxes of `data`.
    /// @param host  the mesh as the kernels fetch it on the host @pre mesh.poses is there; data has room
    void bend(const DeformedMesh& mesh, const kernels::Geometry& host, const GpuMesh& data);

private:
    /// A geometry at rest.
    struct Rest {
        DeviceBuffer<kernels::Vec3f> positions, normals;
        DeviceBuffer<kernels::Vec4f> tangents;
        DeviceBuffer<kernels::Vec2f> uv;
        DeviceBuffer<unsigned short> joints;
        DeviceBuffer<float> joint_weights;
        DeviceBuffer<unsigned> morph_first;
        DeviceBuffer<kernels::MorphEntry> morphs;
        DeviceBuffer<unsigned char> morph_parts;
        kernels::RestMesh view{};
    };
    const Rest& rest_of(unsigned geometry);
    template <class T>
    DeviceBuffer<T> copy(const std::vector<T>& values);
    void launch(kernels::Kernel kernel, std::size_t threads, void* argument);

    const Scene& scene_;
    GpuMemory& memory_;
    UploadQueue& uploads_;
    const GpuStream& stream_;
    KernelOf kernel_;
    std::map<unsigned, Rest> rest_;  ///< by geometry
    DeviceTable<kernels::Affine> matrices_{MemoryUse::motion};
    DeviceTable<kernels::DualQuaternionJoint> dual_quaternions_{MemoryUse::motion};
    DeviceTable<float> weights_{MemoryUse::motion};
    DeviceTable<unsigned char> stretches_{MemoryUse::motion};
};

}  // namespace kadr
