#pragma once

#include "shot/section.h"
#include "shot/shot.h"

namespace kadr {

// One reader a section of the shot. Each takes the document's top section, reports what is wrong and returns what it
// could read, with defaults elsewhere.

struct ReadTiming {
    Timing timing;
    bool frames_given = false;
};
ReadTiming read_timing(const Section& shot);
ImageSpec read_image(const Section& shot);
Shutter read_shutter(const Section& shot);
std::vector<SceneSpec> read_scenes(const Section& shot);
/// `materials`, `variant` and `visible` of a scene entry.
void read_appearance(const Section& scene, SceneSpec& spec);
CameraSpec read_camera(const Section& shot);
std::vector<LightSpec> read_lights(const Section& shot);
/// @param has_lights  whether the shot has lights: the default depends on it
EnvironmentSpec read_environment(const Section& shot, bool has_lights);
RenderSpec read_render(const Section& shot);
ViewSpec read_view(const Section& shot);
/// @param one_frame  whether the shot has exactly one frame: several need {frame} in their file names
/// @param working_folder  where the default pattern starts
OutputSpec read_output(const Section& shot, bool one_frame, const std::filesystem::path& working_folder);

}  // namespace kadr
