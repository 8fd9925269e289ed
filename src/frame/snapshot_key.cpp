#include "frame/snapshot_key.h"

#include "base/feed.h"

namespace kadr {

namespace {

// Every struct is taken apart by a structured binding: a member that is added to one does not compile until somebody
// decides whether it belongs into the key.
class SnapshotFeed : public Feed<SnapshotFeed> {
public:
    using Feed::Feed;
    using Feed::add;

    void add(const glm::dvec3& v) { (*this)(v.x, v.y, v.z); }
    void add(const kernels::Vec3f& v) { (*this)(v.x, v.y, v.z); }
    void add(const std::vector<kernels::CameraKey>& keys) { bytes(keys); }
    void add(const std::vector<glm::dmat4>& matrices) { bytes(matrices); }
    void add(const std::vector<kernels::Vec3f>& positions) { bytes(positions); }
    void add(const LightKeys& light) { (*this)(light.first, light.count); }
    void add(const kernels::CameraKey& key) { add_bytes(&key, 1); }
    void add(const kernels::Light& light) {
        const auto& [radiance, kind, falloff, position, direction, axis_u, axis_v, cos_inner, cos_outer, inner, outer, range, radius, angular] = light;
        (*this)(radiance, kind, falloff, position, direction, axis_u, axis_v, cos_inner, cos_outer, inner, outer, range, radius, angular);
    }
    void add(const kernels::TextureSlot& slot) {
        const auto& [texture, uv_set, m00, m01, m02, m10, m11, m12] = slot;
        (*this)(texture, uv_set, m00, m01, m02, m10, m11, m12);
    }
    void add(const kernels::Material& material) {
        const auto& [base_color, metallic, emission, roughness, dielectric_f0, alpha, cutoff, normal_scale, occlusion, mode, double_sided, unlit,
                     color_map, roughness_map, normal_map, emissive_map, occlusion_map] = material;
        (*this)(base_color, metallic, emission, roughness, dielectric_f0, alpha, cutoff, normal_scale, occlusion, mode, double_sided, unlit, color_map,
                roughness_map, normal_map, emissive_map, occlusion_map);
    }
    void add(const kernels::Camera& camera) {
        [[maybe_unused]] const auto& [keys, count, orthographic, blades, near_clip, far_clip] = camera;
        (*this)(count, orthographic, blades, near_clip, far_clip);
    }
    void add(const EnvironmentSnapshot& environment) {
        const auto& [radiance, image, rotate_rad, visible] = environment;
        (*this)(radiance, image ? image->string() : std::string(), rotate_rad, visible);
    }
    void add(const PreviousPlaces& previous) {
        const auto& [places, camera, deformed] = previous;
        (*this)(places, camera, deformed);
    }
    void add(const kernels::Settings& settings) {
        const auto& [integrator, filter, radius, width, height, bounces, diffuse, glossy, seed, direct, indirect, cull, fresnel, transparent] = settings;
        (*this)(integrator, filter, radius, width, height, bounces, diffuse, glossy, seed, direct, indirect, cull, fresnel, transparent);
    }
    void add(const kernels::Shutter& shutter) {
        const auto& [plain, direction, weight, first_open, delay, length, passed] = shutter;
        (*this)(plain, direction, weight, first_open, delay, length);
        if (!plain) add_bytes(passed, std::size(passed));
    }
    void add(const SceneSnapshot& part) {
        // Instances, motion and bent vertices by geometry_key, which is made of them.
        [[maybe_unused]] const auto& [frame, open_s, close_s, weight, shutter, origin, unit_m, instances, fixed_places, motion, materials, deformed, camera_keys, camera_error_px, camera, lights,
                                      light_keys, light_error, environment, previous, settings, still_key, geometry_key] = part;
        (*this)(weight, shutter, origin, unit_m, materials, camera_keys, camera, lights, light_keys, environment, previous, settings, geometry_key);
    }

private:
    template <class T>
    void bytes(const std::vector<T>& values) {
        add_bytes(values.data(), values.size());
    }
};

}  // namespace

Hash content_key(const std::vector<SceneSnapshot>& parts) {
    Hasher hasher;
    SnapshotFeed feed(hasher);
    for (const SceneSnapshot& part : parts) feed(part);
    return hasher.finish();
}

}  // namespace kadr
