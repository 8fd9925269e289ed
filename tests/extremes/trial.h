#pragma once

#include <string>

#include "scene/scene.h"
#include "shot/shot.h"

namespace kadr::test {

/// Renders the first frame of a shot small, with one sample a pixel, and puts it through the view.
/// @return what is wrong with the pixels; "" where all are finite  @throws InputError, RenderError
std::string flaws_of(Shot shot, const Scene& scene);

}  // namespace kadr::test
