#include "device/tables/motion_keys.h"

#include <cmath>

#include "frame/decompose.h"
#include "kernels/scene/motion.h"

namespace kadr {
namespace {

kernels::TransformKey key_of(const kernels::FrameSrt& frame) {
    kernels::TransformKey key{};
    const double half = 0.5 * frame.angle;
    for (int i = 0; i < 3; ++i) {
        key.translation[i] = frame.translation[i];
        key.scale[i] = frame.scale[i];
        key.rotation[i] = static_cast<float>(frame.axis[i] * std::sin(half));
    }
    key.rotation[3] = static_cast<float>(std::cos(half));
    return key;
}

kernels::TransformKey key_of(const kernels::FrameMatrix& frame) {
    glm::dmat4 m(1);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) m[column][row] = frame.matrix[row][column];
    const Decomposition d = decompose(m);
    kernels::TransformKey key{};
    for (int i = 0; i < 3; ++i) {
        key.translation[i] = static_cast<float>(d.translation[i]);
        key.scale[i] = static_cast<float>(d.scale[i]);
        key.shear[i] = static_cast<float>(d.shear[i]);
    }
    key.rotation[0] = static_cast<float>(d.rotation.x);
    key.rotation[1] = static_cast<float>(d.rotation.y);
    key.rotation[2] = static_cast<float>(d.rotation.z);
    key.rotation[3] = static_cast<float>(d.rotation.w);
    return key;
}

kernels::Affine matrix_of(const kernels::FrameMatrix& frame) {
    kernels::Affine a;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) a.m[row][column] = frame.matrix[row][column];
    return a;
}

}  // namespace

bool is_linear(const MotionFrames& motion, std::size_t instance) {
    const unsigned count = motion.headers[instance].frame_count;
    return count == 1 || (instance < motion.linear.size() && motion.linear[instance]);
}

kernels::Affine matrix_at(const MotionFrames& motion, std::size_t instance, std::size_t frame) {
    const std::size_t at = motion.headers[instance].first_frame + frame;
    return motion.types[instance] == FrameType::srt ? kernels::compose(key_of(motion.srt[at]))
                                                    : matrix_of(motion.matrices[at]);
}

kernels::TransformKey key_at(const MotionFrames& motion, std::size_t instance, std::size_t frame) {
    const std::size_t at = motion.headers[instance].first_frame + frame;
    return motion.types[instance] == FrameType::srt ? key_of(motion.srt[at]) : key_of(motion.matrices[at]);
}

}  // namespace kadr
