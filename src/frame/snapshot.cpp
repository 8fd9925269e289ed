#include "frame/snapshot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <tbb/parallel_for.h>

#include "base/hash.h"
#include "base/text.h"
#include "frame/bindings.h"
#include "frame/camera_keys.h"
#include "frame/camera_start.h"
#include "frame/deform.h"
#include "frame/environment_at.h"
#include "frame/key_grid.h"
#include "frame/light_keys.h"
#include "frame/motion_frames.h"
#include "frame/problem.h"
#include "frame/reach.h"
#include "frame/render_origin.h"
#include "frame/seen_distance.h"
#include "frame/shutter_part.h"

namespace kadr {

namespace {

constexpr std::size_t kMostParts = 64;
constexpr int kDeepestChange = 4;  // what changes fast is followed in up to 2^4 steps
constexpr int kDeepestError = 5;   // what strays is followed in up to 2^5 parts
static_assert(1 << kDeepestError == kMostPartsForError);
constexpr int kDeepestSplit = 6;  // 2^6 parts of 128 steps of 10 degrees: more than 200 turns in one shutter

constexpr double kRounding = 1e-9;  // of shares of the shutter

/// A part of the shutter within which everything is continuous.
struct Part {
    double open_s, close_s;
    bool jump_at_open, jump_at_close;
};

/// The times that a part is evaluated at: just inside of jumps, where step keys still have the part's own value.
Part inside_of(const Part& part) {
    const double length = part.close_s - part.open_s;
    const double ulps = 8192 * std::numeric_limits<double>::epsilon() * std::max(std::abs(part.open_s), std::abs(part.close_s));
    const double inset = std::min(std::max(1e-7 * length, ulps), 0.25 * length);
    return {part.open_s + (part.jump_at_open ? inset : 0), part.close_s - (part.jump_at_close ? inset : 0), false, false};
}

/// Copies that play their clips at other times jump at other times.
std::vector<double> node_discontinuities(const Bindings& bindings, double begin_s, double end_s) {
    if (!bindings.rig.clips_jump()) return bindings.rig.discontinuities(begin_s, end_s);
    std::vector<std::vector<double>> of_offset(bindings.clip_offsets_s.size());
    tbb::parallel_for(std::size_t{0}, of_offset.size(), [&](std::size_t i) { of_offset[i] = bindings.rig.discontinuities(begin_s, end_s, bindings.clip_offsets_s[i]); });
    std::vector<double> all;
    for (const std::vector<double>& times : of_offset) all.insert(all.end(), times.begin(), times.end());
    return all;
}

std::vector<double> morph_discontinuities(const Bindings& bindings, double begin_s, double end_s) {
    std::vector<double> all = bindings.morphs.discontinuities(begin_s, end_s);
    if (!bindings.morphs.clips_jump()) return all;
    for (const double offset : bindings.clip_offsets_s) {
        const std::vector<double> times = bindings.morphs.discontinuities(begin_s, end_s, offset);
        all.insert(all.end(), times.begin(), times.end());
    }
    return all;
}

/// Jumps in an interval. One that is near an end, by the rounding of times, or by less than a part is worth, counts as at it.
struct Jumps {
    std::vector<double> inside;  ///< ascending
    bool at_begin = false, at_end = false;
};

Jumps jumps_in(const BoundShot& shot, double begin_s, double end_s) {
    // Jumps of different tracks that fall together differ by the rounding of their clips' times.
    const double together = std::max(1e-9 * (end_s - begin_s), 4096 * std::numeric_limits<double>::epsilon() * std::max(std::abs(begin_s), std::abs(end_s)));
    const double from = begin_s - together, to = end_s + together;
    std::vector<double> all;
    for (const std::vector<double>& times : {node_discontinuities(shot.bindings(), from, to), morph_discontinuities(shot.bindings(), from, to), camera_discontinuities(shot, from, to),
                                             light_discontinuities(shot, from, to), environment_discontinuities(shot.shot().environment, from, to),
                                             shot.bindings().visibility.discontinuities(from, to, shot.bindings().entry_offsets_s), shot.bindings().materials.discontinuities(from, to)})
        all.insert(all.end(), times.begin(), times.end());
    std::sort(all.begin(), all.end());
    Jumps jumps;
    for (const double time : all) {
        if (time - begin_s <= together) jumps.at_begin = true;
        else if (end_s - time <= together) jumps.at_end = true;
        else if (jumps.inside.empty() || time - jumps.inside.back() > together) jumps.inside.push_back(time);
    }
    return jumps;
}

std::vector<Part> split(const BoundShot& shot, const FrameTime& frame) {
    Jumps jumps;
    if (frame.close_s > frame.open_s) jumps = jumps_in(shot, frame.open_s, frame.close_s);
    if (jumps.inside.size() >= kMostParts)
        throw InputError(problem_at({shot.shot().file.string(), 0, 0}, fmt::format("the shutter of frame {} holds {} jumps: step keys, loops that start again", frame.number, jumps.inside.size()),
                                    fmt::format("expected fewer than {}; close the shutter earlier", kMostParts)));
    std::vector<Part> parts;
    double open = frame.open_s;
    for (const double jump : jumps.inside) {
        parts.push_back({open, jump, jumps.at_begin || !parts.empty(), true});
        open = jump;
    }
    parts.push_back({open, frame.close_s, jumps.at_begin || !parts.empty(), jumps.at_end});
    return parts;
}

/// Masks out what is hidden. Switches do not change within a part; what the list shares is never hidden.
void hide_instances(const BoundShot& shot, double time_s, SharedList<SnapshotInstance>& instances) {
    const Bindings& bindings = shot.bindings();
    if (bindings.visibility.idle()) return;
    const VisibilityRig::States states = bindings.visibility.at(time_s);
    for (std::size_t i = instances.shared_size(); i < instances.size(); ++i)
        if (const Instance instance = bindings.instances[instances[i].id]; !states.visible(instance.seed->mesh_node, instance.clip_offset_s())) instances.edit(i).mask = 0;
}

/// Whether the middle of an interval cannot stand for what is evaluated there: materials and the environment.
bool changes_fast(const BoundShot& shot, double begin_s, double end_s) {
    return end_s > begin_s && (shot.bindings().materials.changes_fast(begin_s, end_s) || environment_changes_fast(shot, begin_s, end_s));
}

unsigned mixed_seed(std::uint32_t seed, int frame) {
    Hasher hasher;
    hasher.add(static_cast<std::int64_t>(seed));
    hasher.add(static_cast<std::int64_t>(frame));
    return static_cast<unsigned>(hasher.finish().low);
}

kernels::Settings settings_of(const Shot& shot, int frame) {
    const RenderSpec& render = shot.render;
    kernels::Settings settings;
    settings.integrator = static_cast<kernels::IntegratorKind>(render.integrator);
    settings.filter = static_cast<kernels::FilterKind>(render.filter);
    settings.filter_radius = static_cast<float>(0.5 * render.filter_width_px);
    settings.width = shot.image.width;
    settings.height = shot.image.height;
    settings.max_bounces = render.bounces.total;
    settings.max_diffuse = render.bounces.diffuse;
    settings.max_glossy = render.bounces.glossy;
    settings.seed = render.seed_animated ? mixed_seed(render.seed, frame) : render.seed;
    settings.clamp_direct = static_cast<float>(render.clamp_direct.value_or(0));
    settings.clamp_indirect = static_cast<float>(render.clamp_indirect.value_or(0));
    settings.cull_backfaces = render.cull_backfaces;
    settings.exact_fresnel = render.fresnel == FresnelKind::exact;
    settings.transparent_background = !shot.environment.visible;
    return settings;
}

static_assert(static_cast<int>(Integrator::path) == static_cast<int>(kernels::IntegratorKind::path));
static_assert(static_cast<int>(FilterKind::blackman_harris) == static_cast<int>(kernels::FilterKind::blackman_harris));
static_assert(static_cast<int>(LightKind::area) == static_cast<int>(kernels::LightKind::area));
static_assert(static_cast<int>(SpotFalloff::blender) == static_cast<int>(kernels::SpotFalloff::blender));

/// @param hasher  knows what the list shares with other snapshots
template <class T>
void add_own(Hasher& hasher, const SharedList<T>& list) {
    static_assert(std::is_trivially_copyable_v<T>);
    hasher.add(std::string_view(reinterpret_cast<const char*>(list.own().data()), list.own().size() * sizeof(T)));
}

std::uint64_t key_of(const SceneSnapshot& snapshot) {
    Hasher hasher;
    hasher.add(static_cast<std::int64_t>(snapshot.still_key));
    add_own(hasher, snapshot.instances);
    add_own(hasher, snapshot.fixed_places);
    add_own(hasher, snapshot.motion.headers);
    add_own(hasher, snapshot.motion.types);
    add_own(hasher, snapshot.motion.srt);
    add_own(hasher, snapshot.motion.matrices);
    add_own(hasher, snapshot.motion.linear);
    for (const auto& mesh : snapshot.deformed) hasher.add(static_cast<std::int64_t>(mesh->version));
    for (int i = 0; i < 3; ++i) hasher.add(snapshot.render_origin[i]);
    hasher.add(snapshot.unit_m);
    return hasher.finish().low;
}

[[noreturn]] void refuse_spin(const BoundShot& shot, const FrameTime& frame) {
    throw InputError(problem_at({shot.shot().file.string(), 0, 0}, fmt::format("something turns more than 200 times within the shutter of frame {}", frame.number),
                                "expected a slower rotation or a shorter shutter"));
}

/// Places of the snapshot's own instances and of the camera one frame before `frame`.
PreviousPlaces places_before(const BoundShot& shot, const FrameTime& frame, const SceneSnapshot& snapshot) {
    const double time_s = frame.open_s - 1 / shot.timing().fps.value();
    const std::vector<glm::dmat4> nodes = shot.node_transforms(time_s);
    const Bindings& bindings = shot.bindings();
    PreviousPlaces places;
    for (const SnapshotInstance& seen : snapshot.instances.own()) {
        const Instance instance = bindings.instances[seen.id];
        const int node = instance.seed->node;
        const glm::dmat4 world_from_node = instance.copy ? bindings.node_transform(node, instance.copy, time_s) : nodes[static_cast<std::size_t>(node)];
        places.space_from_geometry.push_back(snapshot.space().from_world(world_from_node * bindings.copied_from_geometry(shot.scene(), instance)));
    }
    places.deformed = deformed_positions(shot, snapshot, time_s);
    places.camera = fit_camera(shot, time_s, time_s, snapshot.space(), snapshot.camera_keys.front().start * snapshot.unit_m).keys.front();
    return places;
}

class FrameSnapshots {
public:
    FrameSnapshots(const BoundShot& shot, const FrameTime& frame) : shot_(shot), frame_(frame) {
        CameraState camera = camera_at(shot, frame.open_s);
        camera.subject_distance = seen_distance(shot, camera, frame.open_s);
        space_ = render_space(camera);
    }

    std::vector<SceneSnapshot> make() {
        for (const Part& part : split(shot_, frame_)) add(part, 0);
        if (shot_.shot().output.has(Aov::motion))
            for (SceneSnapshot& snapshot : snapshots_) snapshot.previous = places_before(shot_, frame_, snapshot);
        return std::move(snapshots_);
    }

private:
    void add(const Part& part, int depth) {
        const Part inside = inside_of(part);
        SceneSnapshot snapshot;
        snapshot.render_origin = space_.origin;
        snapshot.unit_m = space_.unit_m;
        snapshot.open_s = part.open_s;
        snapshot.close_s = part.close_s;
        if (depth < kDeepestChange && changes_fast(shot_, inside.open_s, inside.close_s)) return split_at(middle(part), part, depth);
        const MotionFit fit = add_motion_frames(shot_, inside.open_s, inside.close_s, snapshot);
        if (fit.too_fast) return split_at(middle(part), part, depth);
        const bool may_split = depth < kDeepestError && shot_.shot().render.samples * share(part) >= 2 * (1 - kRounding);
        if (may_split && fit.missed) return split_at(best_of(fit.corners_s, part), part, depth);
        const double enough_px = kMotionMargin * shot_.shot().render.motion_tolerance_px;
        const std::vector<double> camera_corners_s = add_camera(inside, snapshot);
        check_reach(shot_, snapshot, fit.reach);
        if (may_split && snapshot.camera_error_px > enough_px) return split_at(best_of(camera_corners_s, part), part, depth);
        const std::vector<double> light_corners_s = add_light_keys(shot_, inside.open_s, inside.close_s, snapshot);
        if (may_split && snapshot.light_error > kLightTolerance) return split_at(best_of(light_corners_s, part), part, depth);
        if (const double bent_px = add_bending(inside, snapshot); may_split && bent_px > kDeformationShare * enough_px)
            return split_at(middle(part), part, depth);
        add_rest(inside, snapshot);
        start_ahead(inside, snapshot);
        snapshots_.push_back(std::move(snapshot));
    }

    static double middle(const Part& part) { return 0.5 * (part.open_s + part.close_s); }
    /// Of the whole shutter.
    double share(const Part& part) const { return frame_.close_s > frame_.open_s ? (part.close_s - part.open_s) / (frame_.close_s - frame_.open_s) : 1; }

    /// The corner that lies nearest to the middle: a path is straight or smooth on both sides of it. The middle where there
    /// is none with a sample's worth of time on either side: a part that gets no sample would not be seen at all, which is
    /// worse than a path that strays.
    double best_of(const std::vector<double>& corners_s, const Part& part) const {
        const double sample_s = (1 - kRounding) * (frame_.close_s - frame_.open_s) / shot_.shot().render.samples;
        std::optional<double> best;
        const auto from_middle = [&](double time) { return std::abs(time - middle(part)); };
        for (const double time : corners_s)
            if (std::min(time - part.open_s, part.close_s - time) >= sample_s && (!best || from_middle(time) < from_middle(*best))) best = time;
        return best.value_or(middle(part));
    }

    /// @return the times of its keys
    std::vector<double> add_camera(const Part& inside, SceneSnapshot& snapshot) const {
        CameraFit camera = fit_camera(shot_, inside.open_s, inside.close_s, space_);
        snapshot.camera_keys = std::move(camera.keys);
        snapshot.camera_error_px = camera.error_px;
        snapshot.camera = make_camera(shot_, 0.5 * (inside.open_s + inside.close_s));
        snapshot.camera.key_count = static_cast<int>(snapshot.camera_keys.size());
        return camera.corners_s;
    }

    /// Gives the rays of a long lens a plane to start on. Keys are then interpolated on it, and may have to be more.
    void start_ahead(const Part& inside, SceneSnapshot& snapshot) const {
        const double start_m = camera_start_m(shot_, inside.open_s, inside.close_s, snapshot);
        if (start_m == 0) return;
        CameraFit camera = fit_camera(shot_, inside.open_s, inside.close_s, space_, start_m);
        snapshot.camera_keys = std::move(camera.keys);
        snapshot.camera_error_px = camera.error_px;
        snapshot.camera.key_count = static_cast<int>(snapshot.camera_keys.size());
    }

    /// @return what the vertices of bending meshes miss; max_error_px then counts their places and vertices together
    double add_bending(const Part& inside, SceneSnapshot& snapshot) const {
        MotionFrames& motion = snapshot.motion;
        const double places_px = motion.max_error_px;
        motion.max_error_px = motion.bending_error_px;
        add_deformed(shot_, inside.open_s, inside.close_s, snapshot);
        double vertices_px = 0;
        int worst = -1;
        for (std::size_t d = 0; d < snapshot.deformed.size(); ++d)
            if (snapshot.deformed[d]->error_px > vertices_px) vertices_px = snapshot.deformed[d]->error_px, worst = static_cast<int>(d);
        for (std::size_t i = snapshot.instances.shared_size(); motion.max_error_px > places_px && i < snapshot.instances.size(); ++i)
            if (snapshot.instances[i].deformed == worst) motion.worst = static_cast<std::uint32_t>(i);
        motion.max_error_px = std::max(motion.max_error_px, places_px);
        return vertices_px;
    }

    void add_rest(const Part& inside, SceneSnapshot& snapshot) const {
        const double middle_s = 0.5 * (inside.open_s + inside.close_s);
        hide_instances(shot_, middle_s, snapshot.instances);
        snapshot.materials = shot_.bindings().materials.table(middle_s);
        snapshot.frame_number = frame_.number;
        set_shutter(shot_, frame_, snapshot);
        snapshot.environment = environment_over(shot_, inside.open_s, inside.close_s);
        snapshot.settings = settings_of(shot_.shot(), frame_.number);
        snapshot.geometry_key = key_of(snapshot);
    }

    void split_at(double time_s, const Part& part, int depth) {
        if (depth >= kDeepestSplit) refuse_spin(shot_, frame_);
        add({part.open_s, time_s, part.jump_at_open, false}, depth + 1);
        add({time_s, part.close_s, false, part.jump_at_close}, depth + 1);
    }

    const BoundShot& shot_;
    const FrameTime& frame_;
    RenderSpace space_;
    std::vector<SceneSnapshot> snapshots_;
};

}  // namespace

std::vector<double> shot_discontinuities(const BoundShot& shot, double begin_s, double end_s) { return jumps_in(shot, begin_s, end_s).inside; }

std::vector<SceneSnapshot> make_snapshots(const BoundShot& shot, const FrameTime& frame) { return FrameSnapshots(shot, frame).make(); }

}  // namespace kadr
