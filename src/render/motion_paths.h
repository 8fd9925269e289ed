#pragma once

#include <functional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "frame/frame_state.h"

namespace kadr {

/// The way of one point over the time of a shot.
struct MotionPath {
    enum class Subject { camera, target, light, object } subject = Subject::object;
    std::string name;                                   ///< "camera", "look at", a scene's id or a node's path
    std::function<glm::dvec3(double time_s)> position;  ///< in the world
    double radius = 0;                                  ///< metres from the point to the end of what moves with it
};

/// The times at which paths are looked at: from the first frame (or its shutter's opening) to the last one's end.
struct PathTimes {
    std::vector<FrameTime> frames;
    std::vector<double> samples_s;  ///< ascending; among them all frames, openings and closings
    std::vector<double> jumps_s;    ///< ascending; a path is broken there
};
/// @param frames  ascending, at least one
PathTimes path_times(const BoundShot& shot, const std::vector<int>& frames);

/// What moves during those times: the camera, its target, lights, then objects, each a scene or a node whose parents
/// stand still. An object is followed by the middle of its bounding box at `now_s`, carried along with it; where it
/// only turns about its middle, by the corner of the box that goes farthest ("(a corner)" in its name). The shot has to
/// outlive the result.
std::vector<MotionPath> motion_paths(const BoundShot& shot, const PathTimes& times, double now_s);

}  // namespace kadr
