#pragma once

#include <cstdint>
#include <vector>

#include "device/hiprt/device_table.h"
#include "device/hiprt/rigid_meshes.h"
#include "device/hiprt/gpu_bender.h"
#include "device/tables/environment_tables.h"
#include "film/film.h"

namespace kadr {

/// What all frames of a scene share on the GPU: meshes that keep their shape with their structures, textures, the
/// environment. What is there never changes, so that a frame may be made while another renders.
struct SharedTables {
    /// @param image  the linear R, G, B of the environment's image; null: none  @throws GpuOutOfMemory
    SharedTables(const Scene& scene, const Image* image, StructureBuilder& builder, UploadQueue& uploads,
                 GpuBender::KernelOf bending_kernel);

    const Scene& scene;
    StructureBuilder& builder;
    UploadQueue& uploads;
    const GpuBender::KernelOf bending_kernel;
    RigidMeshes rigid;
    EnvironmentTables environment;
    std::vector<kernels::Texture> host_textures;  ///< with addresses of the host

    std::vector<DeviceBuffer<std::uint8_t>> texels;
    DeviceTable<kernels::Texture> textures;
    DeviceTable<kernels::Vec3f> environment_texels{MemoryUse::textures};
    DeviceTable<float> environment_marginal, environment_conditional;
};

}  // namespace kadr
