#include "frame/precision.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.h"
#include "frame/bindings.h"
#include "frame/camera_keys.h"
#include "frame/problem.h"
#include "frame/references.h"
#include "frame/seen_distance.h"
#include "frame/snapshot.h"
#include "frame/thin_shells.h"

namespace kadr {
namespace {

constexpr double kFloat = 0x1p-24, kDouble = 0x1p-53;  // relative error of rounding
/// Of a pixel: beyond it a hit may lie on the wrong side of an edge often enough to be seen.
constexpr double kEnough_px = 0.02;
/// Of a mesh's size: what rounding may do to its shape.
constexpr double kEnoughOfSize = 1e-4;
/// Radiance, lux and candela between which products of a path's factors neither vanish nor overflow.
constexpr double kFaintest = 1e-20, kBrightest = 1e30;
/// Instances that are looked at; of more, a sample.
constexpr std::size_t kMostLookedAt = 4096;

struct View {
    CameraState camera;
    double time_s = 0, pixel_rad = 0;  ///< of an orthographic picture 0
    double pixel_m = 0;                ///< at the subject
    double ahead_m = 0;                ///< how far away from where rays start it is
};

/// Only lenses so long that directions do not suffice are worth the making of a frame.
double start_of_rays_m(const BoundShot& shot, int frame, const View& view) {
    if (view.camera.orthographic || kFloat <= kEnough_px * view.pixel_rad) return 0;
    const SceneSnapshot snapshot = make_snapshots(shot, shot.sequence().frame(frame)).front();
    return snapshot.camera_keys.front().start * snapshot.unit_m;
}

std::vector<View> views_of(const BoundShot& shot) {
    const std::vector<int>& frames = shot.timing().frames;
    std::vector<View> views;
    for (const std::size_t at : {std::size_t{0}, frames.size() / 2, frames.size() - 1}) {
        View view;
        view.time_s = shot.sequence().frame(frames[at]).open_s;
        view.camera = camera_at(shot, view.time_s);
        view.camera.subject_distance = seen_distance(shot, view.camera, view.time_s);
        const double pixel = 2 * view.camera.tan_half_height / shot.shot().image.height;
        view.pixel_rad = view.camera.orthographic ? 0 : pixel;
        view.pixel_m = view.camera.orthographic ? pixel : pixel * view.camera.subject_distance;
        view.ahead_m = std::max(view.camera.subject_distance - start_of_rays_m(shot, frames[at], view), 0.0);
        views.push_back(view);
    }
    return views;
}

class Warnings {
public:
    explicit Warnings(const BoundShot& shot) : shot_(shot), views_(views_of(shot)) {}

    std::vector<Diagnostic> run() {
        check_long_lens();
        check_distance();
        check_large_movers();
        check_meshes();
        check_shells();
        check_lights();
        return std::move(found_);
    }

private:
    const SourceLocation& at_camera() const { return shot_.shot().camera.where; }

    void check_long_lens() {
        const auto off_px = [](const View& view) { return view.pixel_rad > 0 ? view.ahead_m * kFloat / view.pixel_m : 0; };
        const View& worst = *std::max_element(views_.begin(), views_.end(), [&](const View& a, const View& b) { return off_px(a) < off_px(b); });
        if (off_px(worst) <= kEnough_px) return;
        found_.push_back(warning_at(at_camera(), fmt::format("a pixel of the camera is {:.2g} rad wide at {} s, and rays, which start {:.3g} m before what it looks at, are off by {:.2g} of it",
                                                             worst.pixel_rad, format_number(worst.time_s), worst.ahead_m, off_px(worst)),
                                    "fine lines and shadows may flicker; hide what is in view far before the subject, or take a camera that stands nearer with a shorter lens, or fewer pixels"));
    }

    void check_distance() {
        for (const View& view : views_) {
            const double off_px = glm::length(view.camera.position) * kDouble / view.pixel_m;
            if (off_px <= kEnough_px) continue;
            found_.push_back(warning_at(at_camera(), fmt::format("the camera is {:.3g} m from the origin at {} s, where numbers are precise to {:.2g} of a pixel", glm::length(view.camera.position),
                                                                 format_number(view.time_s), off_px),
                                        "move the scene nearer to the origin"));
            return;
        }
    }

    /// What stands still is subdivided near the camera (device/tables/subdivide.h); what moves keeps its triangles.
    void check_large_movers() {
        const Bindings& bindings = shot_.bindings();
        const std::size_t step = bindings.instances.size() / kMostLookedAt + 1;
        double worst_px = kEnough_px, worst_m = 0;
        int worst = -1;
        for (std::size_t i = 0; i < bindings.instances.size(); i += step) {
            const Instance instance = bindings.instances[i];
            if (!bindings.rig.moves(instance.seed->node)) continue;
            for (const View& view : views_) {
                const glm::dmat4 world = bindings.node_transform(instance.seed->node, instance.copy, view.time_s) * bindings.copied_from_geometry(shot_.scene(), instance);
                const double size = std::sqrt(glm::dot(world[0], world[0]) + glm::dot(world[1], world[1]) + glm::dot(world[2], world[2]));
                // From afar it is as small as its rounding.
                const double nearest = std::max(glm::distance(glm::dvec3(world[3]), view.camera.position) - size, view.camera.subject_distance);
                const double off_px = size * kFloat / (view.pixel_rad > 0 ? view.pixel_rad * nearest : view.pixel_m);
                if (off_px > worst_px) worst_px = off_px, worst_m = size, worst = instance.seed->mesh_node;
            }
        }
        if (worst < 0) return;
        found_.push_back(warning_at(where_of(worst), fmt::format("node '{}' moves and is {:.3g} m large: its surface is precise to {:.2g} of a pixel", name_of(worst), 2 * worst_m, worst_px),
                                    "keep large things still, or split their mesh"));
    }

    /// Files hold vertices in 32 bits: what lies far from the mesh's own origin was rounded before anyone read it.
    void check_meshes() {
        for (const InstanceSeed& seed : shot_.bindings().seeds) {
            const GeometryData& mesh = shot_.scene().geometries[seed.geometry];
            const double far = glm::length(mesh.centre), off = far * kFloat;
            if (!(mesh.scale > 0) || off <= kEnoughOfSize * mesh.scale) continue;
            found_.push_back(warning_at(where_of(seed.mesh_node), fmt::format("the vertices of node '{}' lie {:.3g} from their origin, where the file's 32-bit numbers are precise to {:.2g}; the mesh is {:.3g} large",
                                                                              name_of(seed.mesh_node), far, off, 2 * mesh.scale),
                                        "move the vertices to the origin and the node to where they were"));
            return;
        }
    }

    void check_shells() {
        const std::optional<ThinShell> shell = find_thin_shell(shot_, views_.front().time_s);
        if (!shell) return;
        const std::string what = shell->inner_node < 0 ? fmt::format("node '{}' is", name_of(shell->node)) : fmt::format("nodes '{}' and '{}' are a shell", name_of(shell->node), name_of(shell->inner_node));
        found_.push_back(warning_at(where_of(shell->node), fmt::format("{} {:.3g} m thick and {:.3g} m large: rays that leave one side may start beyond the other", what, shell->thickness_m, shell->size_m),
                                    fmt::format("make it thicker than {:.0e} of its size, or leave one side out", kThinnestShell)));
    }

    void check_lights() {
        for (const LightSpec& light : shot_.shot().lights)
            for (const View& view : views_) {
                const glm::dvec3 color = evaluate(light.color, view.time_s);
                const double strength = evaluate(light.strength, view.time_s) * std::max({color.x, color.y, color.z});
                if (!(strength > 0) || (strength >= kFaintest && strength <= kBrightest)) continue;
                found_.push_back(warning_at(light.where, fmt::format("light '{}' has the strength {:.3g} at {} s", light.id, strength, format_number(view.time_s)),
                                            fmt::format("numbers are safe from {:.0e} to {:.0e}; scale all lights, and the exposure against them", kFaintest, kBrightest)));
                break;
            }
    }

    std::string name_of(int node) const { return node_path(shot_.scene(), shot_.bindings().rig.file_of(node), node); }
    const SourceLocation& where_of(int node) const { return shot_.shot().scenes[static_cast<std::size_t>(shot_.bindings().rig.file_of(node))].where; }

    const BoundShot& shot_;
    const std::vector<View> views_;
    std::vector<Diagnostic> found_;
};

}  // namespace

std::vector<Diagnostic> precision_warnings(const BoundShot& shot) { return Warnings(shot).run(); }

}  // namespace kadr
