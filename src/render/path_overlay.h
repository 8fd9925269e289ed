#pragma once

#include <string>
#include <vector>

#include "film/film.h"
#include "output/drawing.h"
#include "render/motion_paths.h"
#include "render/screen_camera.h"

namespace kadr {

/// A piece of a path on the picture.
struct PathSegment {
    glm::dvec2 from{0}, to{0};
    double depth = 0;      ///< metres along the view axis, of its middle
    bool exposed = false;  ///< the shutter is open
};
/// A frame's place on a path.
struct PathTick {
    int frame = 0;
    glm::dvec2 at{0}, across{0, -1};  ///< pixels; unit, perpendicular to the path
    double depth = 0;
};
/// A path as one camera sees it.
struct ScreenPath {
    MotionPath::Subject subject = MotionPath::Subject::object;
    std::string name;
    std::vector<PathSegment> segments;
    std::vector<PathTick> ticks;  ///< of the frames in front of the camera
    double tolerance = 0;         ///< metres that may lie in front of the path without hiding it
    double length_px = 0;         ///< within the picture
};
ScreenPath project(const MotionPath& path, const PathTimes& times, const ScreenCamera& camera);

/// Keeps camera and target and the `most` lights and objects whose paths are longest on the picture, longest first; what
/// does not show is dropped. @return the number of those that were left out although they show
int keep_most_prominent(std::vector<ScreenPath>& paths, int most);

/// The frames between two ticks, so that ticks stay apart: 1, 2, 5, 10, 20, ...
int tick_step(const ScreenPath& path);

/// Draws the paths over a display-referred picture: thin lines, thick where the shutter is open, a tick at every frame,
/// a longer one with its number at every tenth, a ring at `now`, and the names in their colours. What lies behind the
/// surfaces of `depth` (metres, [y][x]; empty: unknown) is drawn fainter.
void draw_paths(Image& picture, const std::vector<ScreenPath>& paths, int now, const std::vector<float>& depth);

/// The colour of the i-th path of its kind.
DisplayColor path_color(MotionPath::Subject subject, int index);

}  // namespace kadr
