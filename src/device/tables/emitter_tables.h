#pragma once

#include <vector>

#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// The triangles that emit, as next-event estimation chooses among them: in proportion to luminance times world area at
/// the shutter's opening.
class EmitterTables {
public:
    /// @param view  of the host: geometries, instances, motions, matrices, keys, materials and textures are read
    void set(const SceneSnapshot& snapshot, const kernels::SceneView& view);

    const std::vector<kernels::EmissiveTriangle>& triangles() const { return triangles_; }
    const std::vector<float>& cdf() const { return cdf_; }
    const std::vector<float>& instance_density() const { return instance_density_; }
    /// Fills in what is known of the triangles; points to the tables.
    void fill(kernels::LightSet& lights) const;

private:
    struct Place {
        glm::dvec3 centre;
        double power;
    };
    void add_instance(const SceneSnapshot& snapshot, const kernels::SceneView& view, std::size_t index, double strength,
                      std::vector<double>& cumulative, std::vector<Place>& places);
    void normalise(const std::vector<double>& cumulative, const std::vector<Place>& places);

    std::vector<kernels::EmissiveTriangle> triangles_;
    std::vector<float> cdf_, instance_density_;
    float emitted_power_ = 0;
    kernels::Vec3f centre_{0, 0, 0};
    float radius_squared_ = 0;
};

}  // namespace kadr
