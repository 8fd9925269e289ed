#include "frame/motion_report.h"

#include "frame/instance_name.h"

namespace kadr {

MotionReport motion_report(const BoundShot& shot, const std::vector<SceneSnapshot>& parts) {
    MotionReport report;
    report.parts = parts.size();
    report.tolerance_px = shot.shot().render.motion_tolerance_px;
    for (const SceneSnapshot& part : parts) {
        if (!part.motion.headers.empty()) report.frames = std::max<std::size_t>(report.frames, 1);
        for (const kernels::TransformHeader& header : part.motion.headers.own()) report.frames = std::max<std::size_t>(report.frames, header.frame_count);
        const double before = report.largest_px();
        report.instances_px = std::max(report.instances_px, part.motion.max_error_px);
        for (const auto& bent : part.deformed) report.vertices_px = std::max(report.vertices_px, bent->error_px);
        report.camera_px = std::max(report.camera_px, part.camera_error_px);
        if (report.met() || report.largest_px() <= before) continue;
        report.worst = part.camera_error_px >= part.motion.max_error_px ? "the camera" : "node '" + node_path_of(shot, part.instances[part.motion.worst]) + "'";
    }
    return report;
}

}  // namespace kadr
