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
/// "24000/1001" or "23.976" as an exact fraction.
std::optional<Rational> read_rational(const Field& field);
ImageSpec read_image(const Section& shot);
/// Fills width and height in.
void read_size(const Field& size, ImageSpec& image);
Shutter read_shutter(const Section& shot);
std::vector<SceneSpec> read_scenes(const Section& shot);
/// `materials`, `variant` and `visible` of a scene entry.
void read_appearance(const Section& scene, SceneSpec& spec);
/// The clip layers of one entry of `scenes`.
std::vector<ClipLayer> read_animation(const Section& scene);
/// `instances` of one entry of `scenes`.
std::optional<InstancesSpec> read_instances(const Section& scene);
CameraSpec read_camera(const Section& shot);
std::vector<LightSpec> read_lights(const Section& shot);
/// @param has_lights  whether the shot has lights: the default depends on it
EnvironmentSpec read_environment(const Section& shot, bool has_lights);
RenderSpec read_render(const Section& shot);
ViewSpec read_view(const Section& shot);
/// @param one_frame  whether the shot has exactly one frame: several need {frame} in their file names
/// @param working_folder  where the default pattern starts
OutputSpec read_output(const Section& shot, bool one_frame, const std::filesystem::path& working_folder);
/// `png_bits` and `video` of an output section, a shot's or a reel's.
void read_png_bits(const Field& field, OutputSpec& output);
std::optional<VideoSpec> read_video(const Section& output);

/// What may stand in braces in a file's name, beside {name}.
struct Placeholders {
    bool frame = false;  ///< {frame}, {frame:04}: stay as they are
    bool shot = false;   ///< {shot}: stays as it is
};
/// Absolute file name or pattern with {name} filled in; relative to the text that names it. Reports other placeholders.
std::optional<std::string> read_pattern(const Field& field, Placeholders allowed);

}  // namespace kadr
