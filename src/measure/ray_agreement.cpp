#include "measure/ray_agreement.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "device/eye.h"
#include "frame/instance_name.h"
#include "kernels/integrator/interaction.h"

namespace kadr {
namespace {

/// What one operation on floats rounds by, relative to its values, and what a few of them add up to.
constexpr double kUlp = 0x1p-23, kFewUlps = 8 * kUlp;
/// An error bar is never wider: beyond, rays would no longer be told apart from their neighbours.
constexpr double kWidestBar_px = 0.25;
constexpr double kLeastCosine = 0.05;  ///< at grazing angles a ray's error runs along the surface
constexpr int kAround = 8;

glm::dvec3 to_glm(const kernels::Vec3<double>& v) { return {v.x, v.y, v.z}; }

bool same_ids(const SurfaceHit& a, const SurfaceHit& b) {
    return a.instance == b.instance && (!a.met() || a.primitive == b.primitive);
}

class Agreement {
public:
    Agreement(const BoundShot& shot, Device& first, Device& second, const SceneSnapshot& snapshot,
              double motion_error_px)
        : shot_(shot),
          probes_{first.probe(), second.probe()},
          snapshot_(snapshot),
          eye_(snapshot),
          motion_error_px_(motion_error_px) {
        for (int y = 0; y < eye_.height; ++y)
            for (int x = 0; x < eye_.width; ++x)
                points_.push_back({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
    }

    RayAgreement run() {
        const bool still = !(snapshot_.close_s > snapshot_.open_s);
        for (const double time : {0.0, 0.5, 1.0}) {
            compare_at(time);
            if (still) break;
        }
        return result_;
    }

private:
    void compare_at(double time) {
        const std::vector<SurfaceHit> first = probes_[0]->look(points_, time), second = probes_[1]->look(points_, time);
        std::vector<std::size_t> other, displaced;  // in the order of the pixels
        result_.rays += points_.size();
        std::vector<char> wrong(points_.size(), 0);
        for (std::size_t i = 0; i < points_.size(); ++i) {
            if (!same_ids(first[i], second[i]))
                other.push_back(i);
            else if (first[i].met() && !same_place(first[i], second[i]))
                displaced.push_back(i);
        }
        result_.other_ids += other.size();
        for (const std::size_t i : explain(other, first, second, time, result_.at_edges)) wrong[i] = 1, ++result_.wrong_ids;
        // A triangle seen almost from its side is all edge: how far along it a ray meets it says nothing.
        std::uint64_t grazing = 0;
        for (const std::size_t i : explain(displaced, first, second, time, grazing)) wrong[i] = 1, ++result_.wrong_places;
        const auto bad = std::find(wrong.begin(), wrong.end(), 1);
        if (result_.first_bad || bad == wrong.end()) return;
        const auto i = static_cast<std::size_t>(bad - wrong.begin());
        result_.first_bad = BadPixel{snapshot_.frame_number,
                                     static_cast<int>(points_[i].x),
                                     static_cast<int>(points_[i].y),
                                     time,
                                     seen(first[i]),
                                     seen(second[i])};
    }

    /// How far from each other two devices may see what is in one place, in pixels across the ray.
    double bar_px(const SurfaceHit& hit) const {
        const double distance = std::max(hit.distance_m, 1e-30);
        const glm::dvec3 p = glm::abs(to_glm(hit.position));
        // Of the place of a point: what a few operations on its largest coordinate leave, and what the render origin's
        // distance adds on the way from the camera.
        double error = kFewUlps * (std::max({p.x, p.y, p.z}) + distance);
        // HIPRT takes the direction in a mesh's space as a difference of points one unit apart.
        error += kUlp * distance * distance;
        error += turning_error(hit);
        const double px =
            error / std::max(eye_.pixel_at(to_glm(hit.position)), 1e-30) + kFewUlps * std::max(eye_.width, eye_.height) + motion_error_px_;
        return std::min(px, kWidestBar_px);
    }

    /// Tracers do not all turn alike between keys (kSlerpError).
    double turning_error(const SurfaceHit& hit) const {
        const kernels::TransformHeader& header = snapshot_.motion.headers[static_cast<std::size_t>(hit.instance)];
        if (header.frame_count < 2) return 0;
        glm::dvec3 about(0);
        if (snapshot_.motion.types[static_cast<std::size_t>(hit.instance)] == FrameType::srt) {
            const float* t = snapshot_.motion.srt[header.first_frame].translation;
            about = {t[0], t[1], t[2]};
        } else {
            const auto& m = snapshot_.motion.matrices[header.first_frame].matrix;
            about = {m[0][3], m[1][3], m[2][3]};
        }
        return static_cast<double>(kernels::kSlerpError) * glm::length(to_glm(hit.position) - about);
    }

    double note_bar(const SurfaceHit& hit) {
        const double bar = bar_px(hit);
        result_.error_bar_px = std::max(result_.error_bar_px, bar);
        return bar;
    }

    /// Whether both hits are in one place: along the ray, and where the triangle's corners and the weights put it.
    bool same_place(const SurfaceHit& a, const SurfaceHit& b) {
        // Where rays start is a device's own business: only from the camera can their lengths be compared.
        const double along = eye_.starts_at_camera ? std::abs(a.distance_m - b.distance_m) : 0;
        const double off = std::max(along, glm::length(to_glm(a.position) - to_glm(b.position)));
        if (same_ids(a, b)) result_.place_error = std::max(result_.place_error, off / std::max(a.distance_m, 1e-30));
        return off <= std::min(bar_along(a), bar_along(b));
    }
    double bar_along(const SurfaceHit& hit) {
        const double cosine =
            std::clamp(std::abs(glm::dot(eye_.towards(to_glm(hit.position)), to_glm(hit.normal))), kLeastCosine, 1.0);
        const double across = note_bar(hit) * eye_.pixel_at(to_glm(hit.position));
        return across / cosine;
    }

    /// Sends the rays around those that differ. @param at_edges  is added how many an edge explains
    /// @return those that neither an edge nor one place explains
    std::vector<std::size_t> explain(const std::vector<std::size_t>& other, const std::vector<SurfaceHit>& first,
                                     const std::vector<SurfaceHit>& second, double time, std::uint64_t& at_edges) {
        std::vector<kernels::Vec2f> around;
        for (const std::size_t i : other) {
            const double radius =
                2 * std::max(first[i].met() ? note_bar(first[i]) : 0.0, second[i].met() ? note_bar(second[i]) : 0.0);
            for (int k = 0; k < kAround; ++k) {
                const double angle = 2 * 3.14159265358979 * (k + 0.5) / kAround;
                around.push_back({points_[i].x + static_cast<float>(radius * std::cos(angle)),
                                  points_[i].y + static_cast<float>(radius * std::sin(angle))});
            }
        }
        const std::vector<SurfaceHit> near_first = probes_[0]->look(around, time),
                                      near_second = probes_[1]->look(around, time);
        std::vector<std::size_t> wrong;
        for (std::size_t k = 0; k < other.size(); ++k) {
            const std::size_t from = k * kAround, i = other[k];
            if (sees_edge(near_first, from) && sees_edge(near_second, from))
                ++at_edges;
            else if (first[i].met() && second[i].met() && same_place(first[i], second[i]))
                ++result_.same_place;
            else
                wrong.push_back(i);
        }
        return wrong;
    }

    /// Whether the rays around one do not all meet the same triangle.
    static bool sees_edge(const std::vector<SurfaceHit>& around, std::size_t from) {
        for (std::size_t k = from; k < from + kAround; ++k)
            if (!same_ids(around[k], around[from])) return true;
        return false;
    }

    SeenSurface seen(const SurfaceHit& hit) const {
        if (!hit.met()) return {};
        const SnapshotInstance& instance = snapshot_.instances[static_cast<std::size_t>(hit.instance)];
        return {true, node_path_of(shot_, instance), shot_.scene().geometries[instance.geometry].name, hit.primitive,
                (eye_.orthographic ? hit.distance_m : glm::distance(to_glm(hit.position), eye_.place)) * snapshot_.unit_m};
    }

    const BoundShot& shot_;
    Probe* probes_[2];
    const SceneSnapshot& snapshot_;
    const Eye eye_;
    double motion_error_px_;
    std::vector<kernels::Vec2f> points_;
    RayAgreement result_;
};

}  // namespace

RayAgreement operator+(const RayAgreement& a, const RayAgreement& b) {
    return {a.rays + b.rays,
            a.other_ids + b.other_ids,
            a.at_edges + b.at_edges,
            a.same_place + b.same_place,
            a.wrong_ids + b.wrong_ids,
            a.wrong_places + b.wrong_places,
            std::max(a.error_bar_px, b.error_bar_px),
            std::max(a.place_error, b.place_error),
            a.first_bad ? a.first_bad : b.first_bad};
}

RayAgreement compare_rays(const BoundShot& shot, Device& first, Device& second, const SceneSnapshot& snapshot,
                          double motion_error_px) {
    return Agreement(shot, first, second, snapshot, motion_error_px).run();
}

}  // namespace kadr
