#pragma once

#include <memory>
#include <utility>

#include "device/hiprt/hiprt_frame.h"

namespace kadr {

/// A scene on the GPU, with the frame that renders and, where there is memory for it, the one that comes next.
class HiprtScene {
public:
    /// @param environment  the linear R, G, B of the environment's image; null: none
    /// @param bending_kernel  of the kernels that make the vertices of bending meshes; compiles them when asked first
    HiprtScene(const Scene& scene, const Image* environment, StructureBuilder& builder, UploadQueue& uploads,
               GpuBender::KernelOf bending_kernel)
        : shared_(scene, environment, builder, uploads, std::move(bending_kernel)), current_(std::make_unique<HiprtFrame>(shared_)) {}

    /// What is staged takes its turn where it is this snapshot, the very object; else the frame at hand becomes it, and
    /// what is staged stays. On the stream of the builder, without waiting. No launch may be on its way. After an
    /// exception the next call starts anew.
    /// @return whether it was staged
    /// @throws GpuOutOfMemory  drop_staged() or lower_quality() may help
    /// @throws InputError      for what the GPU cannot show, by name
    bool set_frame(const SceneSnapshot& snapshot);
    /// Makes the frame that comes next beside the one at hand, which launches may look at meanwhile.
    /// @throws as set_frame; nothing is staged then
    void stage(std::shared_ptr<const SceneSnapshot> next);
    bool is_staged(const SceneSnapshot& snapshot) const { return staged_.get() == &snapshot; }
    /// Frees what the frame to come takes. @return whether it took anything
    bool drop_staged();
    /// Drops the structures of all meshes; the next set_frame builds them at a lower quality. No launch may be on its
    /// way. @return whether there is a lower one
    bool lower_quality();

    const HiprtFrame& frame() const { return *current_; }
    StructureQuality quality() const { return shared_.rigid.quality(); }

private:
    SharedTables shared_;
    std::unique_ptr<HiprtFrame> current_, next_;   ///< next_: null until a frame is staged
    std::shared_ptr<const SceneSnapshot> staged_;  ///< what next_ shows; held, so that no other can have its address
};

}  // namespace kadr
