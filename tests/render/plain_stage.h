#pragma once

#include "frame/stage.h"

namespace kadr::test {

/// A node in front of the camera, two frames, no lights, black environment.
struct PlainStage : Stage {
    PlainStage() {
        shot.timing.frames = {0, 1};
        shot.shutter = {0, 0.5};
        shot.environment.given = true;
        ball = add_node("Ball");
        scene.material_names = {"paint"};
        scene.material_sources.resize(1);
    }
    int ball;
    kernels::Material& material() { return scene.materials[0]; }
};

}  // namespace kadr::test
