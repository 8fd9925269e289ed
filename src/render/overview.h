#pragma once

#include "render/motion_paths.h"
#include "render/path_overlay.h"
#include "render/render_job.h"

namespace kadr {

/// The shot seen by a second camera that has all of the motion in its picture: the paths, what moves along them and the
/// shot's own camera. Walls are cut open (faces turned away are not drawn).
///
/// @param from  side: from the right of the shot's camera at `now_s`; top: from above, its view upwards; iso: from
/// above,
///              behind and to the right of it
Shot overview_shot(const BoundShot& shot, const std::vector<MotionPath>& paths, const PathTimes& times, Viewpoint from,
                   double now_s);

/// Draws what the shot's camera sees at a time as a pyramid with a mark on its upper side.
void draw_frustum(Image& picture, const ScreenCamera& overview, const CameraState& camera);

}  // namespace kadr
