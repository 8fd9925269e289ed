// Motion frames in HIPRT's own layout, so that a GPU takes them as they are and the CPU reads the same bytes.
// Source: HIPRT 3.1, hiprt_types.h (hiprtFrameSRT, hiprtFrameMatrix, hiprtTransformHeader).
#pragma once

namespace kadr::kernels {

/// One transform at one time: object to world is T * R * S.
struct FrameSrt {
    float axis[3];  ///< rotation axis, unit length
    float angle;    ///< radians, in [-pi, pi]
    float scale[3];
    float translation[3];  ///< metres, relative to the render origin
    float time;            ///< in [0, 1] over the shutter
    float padding;         ///< keeps the 48 bytes of hiprtFrameSRT
};

/// One affine transform at one time, row-major 3x4; column 3 is the translation relative to the render origin.
struct FrameMatrix {
    float matrix[3][4];
    float time;        ///< in [0, 1] over the shutter
    float padding[3];  ///< keeps the 64 bytes of hiprtFrameMatrix
};

/// The frames [first_frame, first_frame + frame_count) of one instance.
struct TransformHeader {
    unsigned first_frame;
    unsigned frame_count;
};

static_assert(sizeof(FrameSrt) == 48 && sizeof(FrameMatrix) == 64 && sizeof(TransformHeader) == 8,
              "layouts of hiprtFrameSRT, hiprtFrameMatrix and hiprtTransformHeader");

}  // namespace kadr::kernels
