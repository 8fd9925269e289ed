#pragma once

#include <vector>

#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// The triangles that emit, as next-event estimation chooses among them: in proportion to luminance times world area at
/// the shutter's opening.
template <class T>
class EmitterTablesOf {
public:
    /// @param view  of the host: geometries, instances, motions, matrices, keys, materials and textures are read
    void set(const SceneSnapshot& snapshot, const kernels::SceneViewOf<T>& view);

    const std::vector<kernels::EmissiveTriangleOf<T>>& triangles() const { return triangles_; }
    const std::vector<float>& cdf() const { return cdf_; }
    const std::vector<T>& instance_density() const { return instance_density_; }
    /// Fills in what is known of the triangles; points to the tables.
    void fill(kernels::LightSetOf<T>& lights) const;

private:
    struct Place {
        glm::dvec3 centre;
        double power;
    };
    void add_instance(const SceneSnapshot& snapshot, const kernels::SceneViewOf<T>& view, std::size_t index,
                      double strength, std::vector<double>& cumulative, std::vector<Place>& places);
    void normalise(const std::vector<double>& cumulative, const std::vector<Place>& places);

    std::vector<kernels::EmissiveTriangleOf<T>> triangles_;
    std::vector<float> cdf_;
    std::vector<T> instance_density_;
    T emitted_power_ = 0;
    kernels::Vec3<T> centre_{0, 0, 0};
    T radius_squared_ = 0;
};
using EmitterTables = EmitterTablesOf<float>;

}  // namespace kadr
