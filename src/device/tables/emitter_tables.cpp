#include "device/tables/emitter_tables.h"

#include <algorithm>
#include <map>

#include <glm/glm.hpp>

#include "kernels/integrator/interaction.h"
#include "kernels/scene/motion.h"
#include "kernels/texture/texture.h"

namespace kadr {
namespace {

template <class T>
kernels::Vec3<T> rounded(const glm::dvec3& v) {
    return {static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
}

/// Mean luminance of a texture, as an estimate of what a textured emitter sends out.
float average_luminance(const kernels::Texture* textures, const kernels::TextureSlot& slot) {
    if (slot.texture < 0) return 1.0f;
    constexpr int kSteps = 32;
    float sum = 0;
    for (int y = 0; y < kSteps; ++y)
        for (int x = 0; x < kSteps; ++x) {
            const kernels::Vec4f t = kernels::sample_texture<float>(
                textures, slot.texture,
                {(static_cast<float>(x) + 0.5f) / kSteps, (static_cast<float>(y) + 0.5f) / kSteps}, true);
            sum += kernels::luminance(kernels::Vec3f{t.x, t.y, t.z});
        }
    return sum / (kSteps * kSteps);
}

bool emits(const kernels::Material& m) { return !m.unlit && kernels::luminance(m.emission) > 0; }

/// A vertex of an instance in the world, relative to the render origin.
template <class T>
glm::dvec3 world_vertex(const kernels::AffineOf<T>& at, const kernels::Vec3f& v) {
    const glm::dvec3 p(v.x, v.y, v.z);
    glm::dvec3 r;
    for (int c = 0; c < 3; ++c) r[c] = at.m[c][0] * p.x + at.m[c][1] * p.y + at.m[c][2] * p.z + at.m[c][3];
    return r;
}

/// Of the whole triangle: coordinates are largest in a corner.
template <class T>
T largest_clearance(const kernels::AffineOf<T>& at, const kernels::Vec3<T> (&corners)[3]) {
    T largest = 0;
    for (const kernels::Vec3<T>& corner : corners) largest = std::max(largest, kernels::emitter_clearance(at, corner, corners));
    return largest;
}

}  // namespace

template <class T>
void EmitterTablesOf<T>::set(const SceneSnapshot& snapshot, const kernels::SceneViewOf<T>& view) {
    triangles_.clear();
    cdf_.clear();
    instance_density_.clear();
    std::map<int, float> texture_means;
    std::vector<double> cumulative{0.0};
    std::vector<Place> places;
    for (std::size_t i = 0; i < snapshot.instances.size(); ++i) {
        const kernels::Material& material = view.materials[snapshot.instances[i].material];
        if (!emits(material) || snapshot.instances[i].mask == 0) continue;
        const int texture = material.emissive_texture.texture;
        if (!texture_means.count(texture))
            texture_means[texture] = average_luminance(view.textures, material.emissive_texture);
        const double strength = kernels::luminance(material.emission) * texture_means[texture];
        if (!(strength > 0)) continue;
        if (instance_density_.empty()) instance_density_.assign(snapshot.instances.size(), T(0));
        instance_density_[i] = static_cast<T>(strength);
        add_instance(snapshot, view, i, strength, cumulative, places);
    }
    emitted_power_ = static_cast<T>(cumulative.back());
    if (cumulative.back() > 0)
        normalise(cumulative, places);
    else
        instance_density_.clear();
}

template <class T>
void EmitterTablesOf<T>::add_instance(const SceneSnapshot& snapshot, const kernels::SceneViewOf<T>& view,
                                      std::size_t index, double strength, std::vector<double>& cumulative,
                                      std::vector<Place>& places) {
    const kernels::Material& material = view.materials[snapshot.instances[index].material];
    const kernels::Geometry& geometry = view.geometries[view.instances[index].geometry];
    const kernels::AffineOf<T> at = kernels::transform_at(view, static_cast<unsigned>(index), T(0));
    const bool varies = material.emissive_texture.texture >= 0 || geometry.key_count > 1 ||
                        view.motions[index].kind != kernels::InstanceMotion::Kind::still;
    const auto vertex = [&](unsigned corner) { return geometry.vertices[geometry.indices[corner]].position; };
    const auto place = [&](unsigned corner) { return world_vertex(at, vertex(corner)); };
    for (unsigned t = 0; t < geometry.triangle_count; ++t) {
        const glm::dvec3 a = place(3 * t), b = place(3 * t + 1), c = place(3 * t + 2);
        const double power = 0.5 * glm::length(glm::cross(b - a, c - a)) * strength;
        if (!(power > 0)) continue;
        const kernels::Vec3<T> own[3] = {kernels::splat<T>(vertex(3 * t)), kernels::splat<T>(vertex(3 * t + 1)), kernels::splat<T>(vertex(3 * t + 2))};
        triangles_.push_back({rounded<T>(a), rounded<T>(b - a), rounded<T>(c - a), kernels::splat<T>(material.emission), 0,
                              largest_clearance(at, own), static_cast<unsigned>(index), varies ? t : kernels::EmissiveTriangleOf<T>::kStands});
        cumulative.push_back(cumulative.back() + power);
        places.push_back({(a + b + c) / 3.0, power});
    }
}

template <class T>
void EmitterTablesOf<T>::normalise(const std::vector<double>& cumulative, const std::vector<Place>& places) {
    const double total = cumulative.back();
    for (double c : cumulative) cdf_.push_back(static_cast<float>(c / total));
    for (T& d : instance_density_) d = static_cast<T>(d / total);
    for (kernels::EmissiveTriangleOf<T>& t : triangles_) t.density = instance_density_[t.instance];
    glm::dvec3 centre(0);
    for (const Place& p : places) centre += p.centre * p.power;
    centre /= total;
    double radius_squared = 1e-12;
    for (const Place& p : places) radius_squared += p.power / total * glm::dot(p.centre - centre, p.centre - centre);
    centre_ = rounded<T>(centre);
    radius_squared_ = static_cast<T>(radius_squared);
}

template <class T>
void EmitterTablesOf<T>::fill(kernels::LightSetOf<T>& lights) const {
    lights.triangle_count = static_cast<int>(triangles_.size());
    lights.emitted_power = emitted_power_;
    lights.emitter_centre = centre_;
    lights.emitter_radius_squared = radius_squared_;
    lights.triangles = triangles_.data();
    lights.triangle_cdf = cdf_.data();
    lights.instance_density = instance_density_.data();
}

template class EmitterTablesOf<float>;
template class EmitterTablesOf<double>;

}  // namespace kadr
