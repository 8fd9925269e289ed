#include "shot/shot_hash.h"

#include "base/feed.h"

namespace kadr {

namespace {

/// Feeds values of any of the shot's types.
class ShotFeed : public Feed<ShotFeed> {
public:
    using Feed::Feed;
    using Feed::add;

    void add(const Rational& value) { (*this)(value.numerator, value.denominator); }
    void add(const glm::dvec2& v) { (*this)(v.x, v.y); }
    void add(const glm::dvec3& v) { (*this)(v.x, v.y, v.z); }
    void add(const glm::dquat& q) { (*this)(q.x, q.y, q.z, q.w); }
    void add(const NodeReference& node) { add(node.text); }
    void add(const Spin& spin) { (*this)(spin.turns, spin.axis); }
    void add(const Ease& ease) { (*this)(ease[0], ease[1], ease[2], ease[3]); }
    template <class T>
    void add(const Track<T>& track) {
        (*this)(track.interpolation, track.before, track.after, track.overshoot, track.keys.size());
        for (const Key<T>& key : track.keys) {
            (*this)(key.time_s, key.value, key.ease, key.in_tangent, key.out_tangent);
            if constexpr (kIsRotation<T>) add(key.spin);
        }
    }
    void add(const ShutterCurve::Key& key) { (*this)(key.fraction, key.efficiency); }
    void add(const Shutter& s) {
        (*this)(s.open_frames, s.close_frames, s.open_s, s.close_s, s.curve.shape, s.curve.keys, s.rolling.direction,
                s.rolling.duration_s, s.physical);
    }
    void add(const PathMotion& m) { (*this)(m.path.points(), m.path.closed(), m.at, m.along, m.up); }
    void add(const OrbitMotion& o) { (*this)(o.around, o.radius_m, o.height_m, o.turns, o.start_rad); }
    void add(const PositionTrack& p) { (*this)(p.keyed, p.path, p.orbit); }
    void add(const Shake& s) { (*this)(s.amplitude_m, s.angle_rad, s.frequency_hz, s.seed); }
    void add(const RotationTrack::AxisAngle& rotation) { (*this)(rotation.axis, rotation.angle_rad); }
    void add(const TransformTrack& t) { (*this)(t.translate, t.rotate.orientation, t.rotate.axis_angle, t.scale); }
    void add(const PlacementSpec& p) { (*this)(p.translate_m, p.rotate, p.scale, p.offset_s); }
    void add(const GridSpec& g) { (*this)(g.counts[0], g.counts[1], g.counts[2], g.spacing_m, g.jitter); }
    void add(const ScatterSpec& s) { (*this)(s.target, s.count, s.align, s.distance_m); }
    void add(const InstancesSpec& i) {
        (*this)(i.list, i.grid, i.scatter, i.seed, i.random_yaw_rad, i.random_scale, i.random_offset_s, i.offset_steps);
    }
    // The id, because node references name it. Not the path: the content counts, wherever it lies.
    void add(const SceneSpec& s) { (*this)(s.id, s.transform, s.layers, s.nodes, s.hide, s.visible, s.variant, s.materials, s.skinning, s.instances); }
    void add(const ClipLayer& l) {
        (*this)(l.clips, l.clip_name, l.clip_index, l.at_s, l.start_s, l.speed, l.in_s, l.out_s, l.loop, l.weight);
    }
    void add(const MaterialSpec& m) {
        (*this)(m.name, m.base_color, m.emissive, m.metallic, m.roughness, m.ior, m.emissive_strength, m.alpha, m.alpha_cutoff,
                m.normal_scale);
    }
    void add(const NodeOverride& n) { (*this)(n.name, n.transform, n.translates, n.rotates, n.scales, n.visible, n.weights); }
    void add(const NamedAt& named) { add(named.name); }
    void add(const CameraSpec& c) {
        (*this)(c.gltf, c.position, c.around, c.look_at, c.up, c.up_given, c.dolly_m, c.shake, c.focal_length_mm, c.vertical_fov_rad, c.sensor_mm, c.fit,
                c.f_stop, c.focus, c.blades);
    }
    void add(const LightSpec& l) {
        (*this)(l.kind, l.strength, l.color, l.position, l.look_at, l.direction, l.inner_rad, l.outer_rad, l.range_m,
                l.falloff, l.radius_m, l.angular_diameter_rad, l.size_m, l.visible);
    }
    void add(const EnvironmentSpec& e) {
        (*this)(e.image.has_value(), e.color, e.strength, e.rotate_rad, e.visible, e.given);
    }
    void add(const RenderSpec& r) {
        (*this)(r.integrator, r.samples, r.at_least, r.max_error, r.time_budget_s, r.time_budget_shot_s, r.bounces.total, r.bounces.diffuse, r.bounces.glossy, r.bounces.transmission,
                r.filter, r.filter_width_px, r.motion_tolerance_px, r.clamp_direct, r.clamp_indirect, r.seed,
                r.seed_animated, r.cull_backfaces, r.denoise, r.build, r.robust, r.texture_limit_px);
        // Only where it is given: frames that were rendered without it stay.
        if (r.motion_frames) (*this)(std::string("motion_frames"), r.motion_frames->count, r.motion_frames->mix);
        if (r.fresnel != FresnelKind::schlick) (*this)(std::string("fresnel"), r.fresnel);
    }
};

}  // namespace

void hash_shot(const Shot& shot, Hasher& hasher) {
    ShotFeed feed(hasher);
    feed(shot.timing.fps, shot.timing.first, shot.image.width, shot.image.height, shot.image.pixel_aspect);
    feed(shot.scenes, shot.camera, shot.shutter, shot.lights, shot.environment, shot.use_scene_lights);
    feed(shot.render, shot.output.aovs);
}

void hash_view(const Shot& shot, Hasher& hasher) {
    ShotFeed feed(hasher);
    feed(shot.view.transform, shot.view.exposure_stops, shot.view.automatic, shot.output.png_bits);
    feed(shot.view.exposure_keys);
}

}  // namespace kadr
