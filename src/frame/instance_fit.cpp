#include "frame/instance_fit.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "base/text.h"
#include "frame/bindings.h"
#include "frame/key_grid.h"
#include "frame/problem.h"
#include "frame/shared_transforms.h"

namespace kadr {

namespace {

constexpr double kWidestStep = 0.17453292519943295;  // 10 degrees: what bounds of moving instances are good for
constexpr double kHalfTurn = 3.1415926535897931, kWidestMixed = 2.9670597283903604;  // 180 and 170 degrees: of fixed frames
constexpr double kBesideCamera = 0.05;  // of an instance's radius: nearer corners stand for faces that are farther away
constexpr double kVanishing = 1e-5;     // of the scale near by: what stands for a scale of zero

/// The keys of a node that no even grid meets. Paths have corners there, and a corner strays farthest in itself, wherever
/// it lies between the times of the grid.
struct Corners {
    std::vector<double> u;  ///< in (0, 1)
    std::vector<PixelScale> scales;
    SharedTransforms transforms;
};

glm::dmat4 relative(glm::dmat4 world, const glm::dvec3& origin) {
    for (int i = 0; i < 3; ++i) world[3][i] -= origin[i];
    return world;
}

double radius_of(const glm::dmat4& m) {
    return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

/// Largest screen-space distance between two placements of [-1, 1]^3; a bound of it where that is below `negligible`.
double pixels_between(const glm::dmat4& is, const glm::dmat4& wanted, const PixelScale& scale, double negligible) {
    const double nearest = std::max(kBesideCamera * radius_of(wanted), 1e-30);
    // Most instances hardly stray: one bound for all corners spares looking at each.
    double apart = 0, radius = 0;
    for (int column = 0; column < 4; ++column) apart += glm::length(glm::dvec3(is[column] - wanted[column]));
    for (int column = 0; column < 3; ++column) radius += glm::length(glm::dvec3(wanted[column]));
    const double bound = scale.most_pixels(apart, glm::dvec3(wanted[3]), radius, nearest);
    if (bound <= negligible) return bound;
    double worst = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec4 at(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1, 1);
        const glm::dvec3 point(wanted * at);
        worst = std::max(worst, scale.pixels(glm::distance(glm::dvec3(is * at), point), point, nearest));
    }
    return worst;
}

bool nearly_same(const glm::dmat4& a, const glm::dmat4& b) {
    const double size = 1e-13 * (radius_of(a) + glm::length(glm::dvec3(a[3])));
    for (int column = 0; column < 4; ++column)
        if (!(glm::length(a[column] - b[column]) <= size)) return false;
    return true;
}

glm::dmat4 mixed(const glm::dmat4& a, const glm::dmat4& b, double u) { return a * (1 - u) + b * u; }

/// One moving instance and its true places at 4 * segments + 1 times.
class Fit {
public:
    Fit(std::vector<glm::dmat4> places, const Interval& interval, const std::vector<PixelScale>& scales)
        : places_(std::move(places)), interval_(interval), scales_(scales), mixes_matrices_(interval.fixed() && interval.fixed()->mix == MotionMix::matrix) {
        parts_.reserve(places_.size());
        for (const glm::dmat4& place : places_) parts_.push_back(decompose(place));
    }

    bool finite() const { return std::all_of(places_.begin(), places_.end(), is_finite); }
    bool hidden() const { return std::all_of(parts_.begin(), parts_.end(), is_singular); }
    bool still() const {
        return std::all_of(places_.begin() + 1, places_.end(), [&](const glm::dmat4& m) { return nearly_same(m, places_[0]); });
    }

    /// Gives vanishing scales (an object that pops up from nothing) a tiny size, with the rotation of the nearest time
    /// at which there is one. @return false where a scale changes its sign: no path leads through zero
    bool open_up() {
        if (std::none_of(parts_.begin(), parts_.end(), is_singular)) return keeps_its_sign();
        const std::vector<Decomposition> found = parts_;
        for (std::size_t i = 0; i < parts_.size(); ++i)
            if (is_singular(found[i])) parts_[i] = opened(i, found), places_[i] = compose(parts_[i]);
        return keeps_its_sign();
    }

    /// Radians that the rotation turns in the liveliest segment.
    double widest_step() const {
        double widest = 0;
        for (std::size_t i = 0; i + 1 < parts_.size(); i += 4) {
            double turn = 0;
            for (std::size_t k = i; k < i + 4; ++k) turn += angle_between(parts_[k].rotation, parts_[k + 1].rotation);
            widest = std::max(widest, turn);
        }
        return widest;
    }

    /// Screen-space error of every fourth place as a frame, where the true place at `u` in [0, 1] is `wanted`.
    double error_px_at(double u, const glm::dmat4& wanted, const PixelScale& scale) const {
        const std::size_t segments = places_.size() / 4;
        const double position = u * static_cast<double>(segments);
        const std::size_t from = 4 * std::min(static_cast<std::size_t>(position), segments - 1);
        return pixels_between(between(from, position - 0.25 * static_cast<double>(from)), wanted, scale, negligible());
    }

    /// Screen-space error of every fourth place as a frame; stops early once beyond `enough`.
    double error_px(double enough) const {
        double worst = 0;
        for (std::size_t i = 0; i < places_.size() && worst <= enough; ++i)
            if (const std::size_t from = i / 4 * 4; i != from)
                worst = std::max(worst, pixels_between(between(from, 0.25 * static_cast<double>(i - from)), places_[i], scales_[i], negligible()));
        return worst;
    }

    /// Screen-space error of two linearly interpolated matrices, the first place and the last. @pre two frames are enough
    double linear_error_px() const {
        double worst = 0;
        for (std::size_t i = 1; i < 4; ++i)
            worst = std::max(worst, pixels_between(mixed(places_[0], places_[4], 0.25 * static_cast<double>(i)), places_[i], scales_[i], negligible()));
        return worst;
    }

    void append_frames(std::vector<Decomposition>& frames, std::size_t step) const {
        for (std::size_t i = 0; i < parts_.size(); i += step) frames.push_back(parts_[i]);
    }

private:
    double negligible() const { return 0.1 * interval_.tolerance_px; }
    /// What is traced between the frames at `from` and the next one.
    glm::dmat4 between(std::size_t from, double u) const {
        return mixes_matrices_ ? mixed(places_[from], places_[from + 4], u) : compose(interpolate(parts_[from], parts_[from + 4], u));
    }
    bool keeps_its_sign() const {
        return std::all_of(parts_.begin(), parts_.end(), [&](const Decomposition& p) { return (p.scale.z < 0) == (parts_[0].scale.z < 0); });
    }

    Decomposition opened(std::size_t at, const std::vector<Decomposition>& found) const {
        std::size_t nearest = at, distance = found.size();
        for (std::size_t i = 0; i < found.size(); ++i)
            if (const std::size_t d = i < at ? at - i : i - at; !is_singular(found[i]) && d < distance) nearest = i, distance = d;
        Decomposition parts = found[nearest];
        const glm::dmat3 axes = glm::mat3_cast(parts.rotation);
        parts.translation = glm::dvec3(places_[at][3]);
        for (int i = 0; i < 3; ++i) {
            const double own = glm::dot(axes[i], glm::dvec3(places_[at][i]));
            const double least = kVanishing * parts.scale[i];
            parts.scale[i] = std::abs(own) > std::abs(least) && (own < 0) == (least < 0) ? own : least;
            parts.shear[i] *= kVanishing;
        }
        return parts;
    }

    std::vector<glm::dmat4> places_;
    std::vector<Decomposition> parts_;
    const Interval& interval_;
    const std::vector<PixelScale>& scales_;
    bool mixes_matrices_;
};

/// Fits the frames of some instances; those that need more go round again with twice as many.
class InstanceFitter {
public:
    InstanceFitter(const Interval& interval, std::span<const Instance> instances, InstanceFits& fits)
        : interval_(interval), instances_(instances), fits_(fits), rig_(interval.shot.bindings().rig), scene_(interval.shot.scene()) {
        fits_.fitted.resize(instances.size());
        uneven_.resize(instances.size());
    }

    void run() {
        fit_still();
        for (std::map<int, std::vector<std::size_t>>::iterator next; (next = waiting_.begin()) != waiting_.end();) {
            const auto [segments, members] = *next;
            waiting_.erase(next);
            if (members.empty()) continue;
            fit_moving(segments, members);
        }
    }

private:
    int node_of(std::size_t i) const { return instances_[i].seed->node; }
    glm::dmat4 copied_from_geometry(std::size_t i) const { return interval_.shot.bindings().copied_from_geometry(scene_, instances_[i]); }

    void refuse(std::size_t i, std::string_view what, std::string expected) {
        fits_.problems.push_back(problem_of_node(interval_.shot, node_of(i), what, interval_.open_s, std::move(expected)));
        fits_.fitted[i].hidden = true;
    }

    void refuse_infinite(std::size_t i) { refuse(i, "has a transform that is not finite", "expected finite translations, rotations and scales"); }

    void accept(std::size_t i, std::size_t first, bool linear, double error_px) {
        fits_.fitted[i] = {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(fits_.frames.size() - first), linear, false, static_cast<float>(error_px)};
    }

    /// Instances that do not move over the shot, or all of them when the shutter is closed in an instant.
    void fit_still() {
        const bool instant = !(interval_.close_s > interval_.open_s);
        SharedTransforms at_opening(interval_.shot.bindings(), {interval_.open_s});
        std::vector<std::size_t> moving;
        for (std::size_t i = 0; i < instances_.size(); ++i)
            if (instant || !rig_.moves(node_of(i)))
                place_still(i, at_opening.world_from_node(instances_[i]).front());
            else
                moving.push_back(i);
        enqueue_all(moving);
    }

    /// By how lively the nodes are at the times of each copy's clips.
    void enqueue_all(const std::vector<std::size_t>& moving) {
        std::map<double, std::vector<std::size_t>> by_offset;
        for (const std::size_t i : moving) by_offset[instances_[i].clip_offset_s()].push_back(i);
        for (const auto& [offset, members] : by_offset) {
            std::vector<int> nodes;
            for (const std::size_t i : members) nodes.push_back(node_of(i));
            nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
            const NodeRig::Selection selection = rig_.select(nodes);
            const auto activity = rig_.activity(selection, interval_.open_s, interval_.close_s, offset);
            for (const std::size_t i : members) enqueue(i, activity[static_cast<std::size_t>(selection.slot_of(node_of(i)))]);
        }
    }

    void place_still(std::size_t i, const glm::dmat4& world) {
        const glm::dmat4 place = relative(world * copied_from_geometry(i), interval_.space.origin);
        const Decomposition parts = decompose(place);
        if (!is_finite(place)) return refuse_infinite(i);
        fits_.fitted[i].hidden = is_singular(parts);
        if (fits_.fitted[i].hidden) return;
        fits_.frames.push_back(parts);
        accept(i, fits_.frames.size() - 1, true, 0);
    }

    void enqueue(std::size_t i, const NodeRig::Activity& activity) {
        if (const FixedMotionFrames* fixed = interval_.fixed()) {
            const int segments = fixed->count - 1;
            uneven_[i] = activity.keys > 0 && (activity.grid == 1 || segments % activity.grid != 0);
            waiting_[segments].push_back(i);
            return;
        }
        const double steps = std::ceil(activity.turn_rad / kWidestStep - 1e-9);
        if (!(steps <= kMostSegments)) fits_.quality.too_fast = true;
        // Keys that no even grid meets are smoothed: more segments than keys, so that none is passed over.
        const int keys = std::min(activity.keys + 1, kMostSegments);
        const int wanted = std::max(steps <= kMostSegments ? static_cast<int>(steps) : kMostSegments, keys);
        uneven_[i] = activity.keys > 0 && activity.grid == 1;
        waiting_[refined_segments(activity.grid, wanted)].push_back(i);
    }

    Corners& corners_of(std::size_t i) {
        const std::pair<int, double> key{node_of(i), instances_[i].clip_offset_s()};
        if (const auto found = corners_.find(key); found != corners_.end()) return found->second;
        const std::vector<double> times = rig_.key_times_of(key.first, interval_.open_s, interval_.close_s, key.second);
        Corners corners{{}, {}, SharedTransforms(interval_.shot.bindings(), times)};
        for (const double time : times) {
            corners.u.push_back((time - interval_.open_s) / (interval_.close_s - interval_.open_s));
            corners.scales.push_back(interval_.scale_at(corners.u.back()));
        }
        return corners_.emplace(key, std::move(corners)).first->second;
    }

    void miss(std::size_t i) {
        fits_.quality.missed = true;
        if (!uneven_[i]) return;
        for (const double u : corners_of(i).u) fits_.quality.corners_s.push_back(interval_.time(u));
    }

    double error_px_in_corners(std::size_t i, const Fit& fit) {
        Corners& corners = corners_of(i);
        const glm::dmat4 local = copied_from_geometry(i);
        const std::vector<glm::dmat4> places = corners.transforms.world_from_node(instances_[i]);
        double worst = 0;
        for (std::size_t k = 0; k < places.size(); ++k)
            worst = std::max(worst, fit.error_px_at(corners.u[k], relative(places[k] * local, interval_.space.origin), corners.scales[k]));
        return worst;
    }

    void fit_moving(int segments, const std::vector<std::size_t>& members) {
        std::vector<double> times;
        std::vector<PixelScale> scales;
        for (int k = 0; k <= 4 * segments; ++k) {
            const double u = k / (4.0 * segments);
            times.push_back(interval_.time(u));
            scales.push_back(interval_.scale_at(u));
        }
        SharedTransforms transforms(interval_.shot.bindings(), times);
        for (const std::size_t i : members) {
            const glm::dmat4 local = copied_from_geometry(i);
            std::vector<glm::dmat4> places = transforms.world_from_node(instances_[i]);
            for (glm::dmat4& place : places) place = relative(place * local, interval_.space.origin);
            fit_one(i, segments, Fit(std::move(places), interval_, scales));
        }
    }

    void fit_one(std::size_t i, int segments, Fit fit) {
        if (!fit.finite()) return refuse_infinite(i);
        fits_.fitted[i].hidden = fit.hidden();
        if (fits_.fitted[i].hidden) return;
        const std::size_t first = fits_.frames.size();
        if (fit.still()) {
            fit.append_frames(fits_.frames, 4 * static_cast<std::size_t>(segments) + 1);
            return accept(i, first, true, 0);
        }
        if (!fit.open_up())
            return refuse(i, "turns inside out (its scale passes through zero) within the shutter that opens",
                          "expected scales that keep their sign; use a step key to mirror an object");
        if (const FixedMotionFrames* fixed = interval_.fixed()) return keep_fixed(i, *fixed, fit);
        // Where vertices bend as well, both share the tolerance.
        const double enough = kMotionMargin * interval_.tolerance_px * (instances_[i].seed->deformer >= 0 ? 1 - kDeformationShare : 1);
        const bool last = 2 * segments > kMostSegments;
        const double step = fit.widest_step();
        double error = fit.error_px(last ? std::numeric_limits<double>::infinity() : enough);
        if (uneven_[i] && (last || error <= enough)) error = std::max(error, error_px_in_corners(i, fit));
        const double rounding = 1e-9;  // a turn of exactly 10 degrees a step, summed from four
        if ((step > kWidestStep + rounding || error > enough) && !last) {
            waiting_[2 * segments].push_back(i);
            return;
        }
        if (step > kWidestStep + rounding) fits_.quality.too_fast = true;
        if (error > enough) miss(i);
        fit.append_frames(fits_.frames, 4);
        const double linear_error = segments == 1 ? fit.linear_error_px() : std::numeric_limits<double>::infinity();
        const bool linear = linear_error <= enough;
        // A device may then move it so: what is said of it has to hold for all of them.
        accept(i, first, linear, linear ? std::max(error, linear_error) : error);
    }

    /// As many frames as the shot says, whatever they miss.
    void keep_fixed(std::size_t i, const FixedMotionFrames& fixed, const Fit& fit) {
        const bool matrices = fixed.mix == MotionMix::matrix;
        const double step = fit.widest_step();
        if (step >= (matrices ? kWidestMixed : kHalfTurn))
            return refuse(i, fmt::format("turns by {:.0f} degrees from one of the {} motion frames (render.motion_frames) to the next in the shutter that opens", glm::degrees(step), fixed.count),
                          matrices ? "expected less than 170 degrees, or the matrices between them have no size; take more frames, `mix: srt` or `motion_frames: auto`"
                                   : "expected less than 180 degrees, or it turns the other way; take more frames or `motion_frames: auto`");
        double error = fit.error_px(std::numeric_limits<double>::infinity());
        if (uneven_[i]) error = std::max(error, error_px_in_corners(i, fit));
        fits_.quality.widest_step_rad = std::max(fits_.quality.widest_step_rad, step);
        const std::size_t first = fits_.frames.size();
        fit.append_frames(fits_.frames, 4);
        accept(i, first, matrices, error);
    }

    const Interval& interval_;
    std::span<const Instance> instances_;
    InstanceFits& fits_;
    const NodeRig& rig_;
    const Scene& scene_;
    std::map<int, std::vector<std::size_t>> waiting_;  ///< by segments
    std::vector<bool> uneven_;                          ///< whether some keys lie beside every even grid
    std::map<std::pair<int, double>, Corners> corners_;  ///< by node and clip offset
};

}  // namespace

const FixedMotionFrames* Interval::fixed() const {
    const std::optional<FixedMotionFrames>& frames = shot.shot().render.motion_frames;
    return frames ? &*frames : nullptr;
}

PixelScale Interval::scale_at(double u) const {
    CameraState camera = camera_at(shot, time(u));
    camera.position -= space.origin;
    return {camera, image_height};
}

InstanceFits fit_instances(const Interval& interval, std::span<const Instance> instances) {
    InstanceFits fits;
    InstanceFitter(interval, instances, fits).run();
    return fits;
}

}  // namespace kadr
