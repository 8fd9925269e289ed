#include "device/hiprt/instance_tables.h"

#include <fmt/format.h>
#include <glm/trigonometric.hpp>

#include "base/error.h"
#include "device/tables/motion_keys.h"

namespace kadr {
namespace {

/// HIPRT takes matrices apart and turns what lies between them, and its boxes are good for steps of 10 degrees.
void refuse_fixed_frames(const MotionFrames& motion) {
    constexpr double kWidestStep = 0.17453292519943295 + 1e-9;
    if (motion.mixes_matrices)
        throw InputError("--device hiprt: render.motion_frames.mix is matrix, and HIPRT mixes no matrices", "use `mix: srt`, or --device cpu");
    if (motion.widest_step_rad > kWidestStep)
        throw InputError(fmt::format("--device hiprt: render.motion_frames lets something turn by {:.0f} degrees from one frame to the next", glm::degrees(motion.widest_step_rad)),
                         "HIPRT's boxes hold what turns by 10 degrees; take more frames, `motion_frames: auto`, or --device cpu");
}

/// Where the kernels find an instance: HIPRT interpolates decomposed frames whatever their number, and shading has to
/// use the transform that was traced, so matrices are for what is still.
void add_motion(const SceneSnapshot& snapshot, std::size_t instance, InstanceTables& tables) {
    using Kind = kernels::InstanceMotion::Kind;
    const unsigned count = snapshot.motion.headers[instance].frame_count;
    if (count == 1) {
        tables.motions.push_back({static_cast<unsigned>(tables.matrices.size()), 1, Kind::still, false});
        tables.matrices.push_back(matrix_at(snapshot.motion, instance, 0));
        return;
    }
    tables.motions.push_back({static_cast<unsigned>(tables.keys.size()), count, Kind::keys, false});
    for (unsigned k = 0; k < count; ++k) tables.keys.push_back(key_at(snapshot.motion, instance, k));
}

/// The frames of the snapshot as they are, of what is shown.
void add_srt_frames(const MotionFrames& motion, std::size_t instance, InstanceTables& tables) {
    const kernels::TransformHeader& header = motion.headers[instance];
    tables.headers.push_back({static_cast<unsigned>(tables.srt.size()), header.frame_count});
    for (unsigned k = 0; k < header.frame_count; ++k) tables.srt.push_back(motion.srt[header.first_frame + k]);
}

kernels::FrameMatrix matrix_frame(const MotionFrames& motion, std::size_t instance, unsigned k) {
    const kernels::TransformHeader& header = motion.headers[instance];
    if (motion.types[instance] == FrameType::matrix) return motion.matrices[header.first_frame + k];
    const kernels::Affine at = matrix_at(motion, instance, k);
    kernels::FrameMatrix frame{};
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) frame.matrix[row][column] = at.m[row][column];
    frame.time = motion.srt[header.first_frame + k].time;
    return frame;
}

void add_matrix_frames(const MotionFrames& motion, std::size_t instance, InstanceTables& tables) {
    const unsigned count = motion.headers[instance].frame_count;
    tables.headers.push_back({static_cast<unsigned>(tables.frame_matrices.size()), count});
    for (unsigned k = 0; k < count; ++k) tables.frame_matrices.push_back(matrix_frame(motion, instance, k));
}

void check_count(std::size_t shown) {
    if (shown <= hiprt::kMostInstances) return;
    throw InputError(fmt::format("--device hiprt: the frame shows {} instances", shown),
                     fmt::format("HIPRT takes at most {}; use --device cpu", hiprt::kMostInstances));
}

}  // namespace

InstanceTables make_instance_tables(const SceneSnapshot& snapshot,
                                    const std::function<ShownMesh(std::size_t instance)>& mesh_of) {
    refuse_fixed_frames(snapshot.motion);
    InstanceTables tables;
    for (std::size_t i = 0; i < snapshot.instances.size(); ++i) {
        const SnapshotInstance& source = snapshot.instances[i];
        const ShownMesh mesh = mesh_of(i);
        tables.instances.push_back({mesh.geometry, source.material, source.id});
        add_motion(snapshot, i, tables);
        if (!mesh.structure) continue;
        tables.shown.push_back({hiprt::InstanceType::geometry, mesh.structure});
        tables.masks.push_back(source.mask);
        tables.instance_of.push_back(static_cast<unsigned>(i));
        tables.moving += snapshot.motion.headers[i].frame_count > 1 ? 1 : 0;
        if (snapshot.motion.types[i] == FrameType::matrix) tables.frame_type = hiprt::FrameType::matrix;
    }
    check_count(tables.shown.size());
    for (const unsigned i : tables.instance_of)
        (tables.frame_type == hiprt::FrameType::srt ? add_srt_frames : add_matrix_frames)(snapshot.motion, i, tables);
    return tables;
}

}  // namespace kadr
