#include "device/hiprt/shared_tables.h"

#include <utility>

namespace kadr {

/// Textures as they are, so that the kernels filter them as on the CPU.
SharedTables::SharedTables(const Scene& all, const Image* image, StructureBuilder& builder_of_all, UploadQueue& queue,
                           GpuBender::KernelOf kernel)
    : scene(all), builder(builder_of_all), uploads(queue), bending_kernel(std::move(kernel)), rigid(all, builder_of_all, queue) {
    if (image) environment = EnvironmentTables(*image);
    GpuMemory& memory = builder.memory();
    std::vector<kernels::Texture> on_gpu;
    for (const TextureData& texture : scene.textures) {
        host_textures.push_back(texture.view());
        texels.emplace_back(memory, texture.texels.size(), MemoryUse::textures);
        uploads.add(texels.back(), texture.texels);
        on_gpu.push_back(host_textures.back());
        on_gpu.back().texels = texels.back().data();
    }
    textures.set(memory, uploads, on_gpu);
    environment_texels.set(memory, uploads, environment.texels());
    environment_marginal.set(memory, uploads, environment.marginal());
    environment_conditional.set(memory, uploads, environment.conditional());
}

}  // namespace kadr
