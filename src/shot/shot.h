#pragma once

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "anim/timing.h"
#include "anim/shake.h"
#include "anim/track.h"
#include "anim/transform.h"
#include "base/error.h"
#include "shot/instances_spec.h"
#include "shot/track_limits.h"

namespace kadr {

/// A node named "scene" or "scene/Node" or "scene/Parent/Node" by the shot; resolved against the scene by frame/.
struct NodeReference {
    std::string text;
    SourceLocation where;
    bool operator==(const NodeReference& other) const { return text == other.text; }
};

/// Where a camera or a light looks: a (moving) point, or the origin of a node.
using Target = std::variant<PositionTrack, NodeReference>;

/// What a shot changes of a material of a scene's file. What is absent stays as the file, or a clip, has it.
struct MaterialSpec {
    std::string name;  ///< in the file; of several materials with one name all are meant
    SourceLocation where;
    std::optional<Track<glm::dvec3>> base_color;  ///< linear
    std::optional<Track<glm::dvec3>> emissive;    ///< linear; times emissive_strength it is radiance
    std::optional<Track<double>> metallic, roughness, ior, emissive_strength;
    std::optional<Track<double>> alpha;  ///< makes a material that the file calls opaque blend
    std::optional<Track<double>> alpha_cutoff, normal_scale;
    bool operator==(const MaterialSpec&) const = default;
};

/// How joints carry vertices: by blended matrices, as glTF says, or by blended dual quaternions, which keep the volume of
/// twisted limbs.
enum class Skinning { linear, dual_quaternion };
/// One layer of a scene's animation: a clip, or all of them at once, when it plays and how much it counts. At the shot's
/// time t it is at start + speed * (t - at) of its own time, kept within [in, out] as `loop` says.
struct ClipLayer {
    enum class Clips { all, none, one } clips = Clips::all;
    std::string clip_name;  ///< Clips::one: a clip's name ...
    int clip_index = -1;    ///< ... or its index; -1 when named
    SourceLocation where;   ///< of the clip's name
    double at_s = 0;
    std::optional<double> start_s;  ///< none: in, or out where the speed is negative
    double speed = 1;               ///< clip seconds a second; negative plays backwards
    std::optional<double> in_s;     ///< none: 0, the clip's own start
    std::optional<double> out_s;    ///< none: the end of the clip
    enum class Loop { hold, repeat, pingpong } loop = Loop::hold;
    Track<double> weight{1.0};      ///< over the shot's time, never negative
    bool operator==(const ClipLayer&) const = default;
};

/// Something that is on (1) or off (0) and only jumps between the two: keys of Interpolation::step.
using SwitchTrack = Track<double>;
inline bool is_on(const SwitchTrack& track, double time_s) { return evaluate(track, time_s) >= 0.5; }

/// What the shot says of one node of a scene, whatever the clips say of it.
struct NodeOverride {
    std::string name;  ///< "Node" or "Parent/Node", as resolve_node (frame/) reads it
    SourceLocation where;
    TransformTrack transform;  ///< parent_from_node; each part counts only where it is given
    bool translates = false, rotates = false, scales = false;
    std::optional<SwitchTrack> visible;  ///< of the node and all below it; replaces what the file and its clips say
    std::vector<Track<double>> weights;  ///< [morph target] of its mesh; empty: those of the file and its clips
    SourceLocation weights_where;
    bool operator==(const NodeOverride&) const = default;
};

/// A name and where the shot says it.
struct NamedAt {
    std::string name;
    SourceLocation where;
    bool operator==(const NamedAt& other) const { return name == other.name; }
};

struct SceneSpec {
    std::string id;
    std::filesystem::path gltf;  ///< absolute
    SourceLocation where;        ///< of the path in the shot file
    TransformTrack transform;    ///< world_from_scene
    std::vector<ClipLayer> layers{ClipLayer{}};  ///< of clips, in the shot's order
    std::vector<NodeOverride> nodes;
    std::vector<NamedAt> hide;   ///< nodes left out with all below them
    SwitchTrack visible{1.0};  ///< of everything in the scene
    std::optional<std::string> variant;  ///< of KHR_materials_variants
    SourceLocation variant_where;
    std::vector<MaterialSpec> materials;
    Skinning skinning = Skinning::linear;
    std::optional<InstancesSpec> instances;  ///< absent: one, in its place
    bool operator==(const SceneSpec&) const = default;
};

struct CameraSpec {
    SourceLocation where;
    std::optional<NodeReference> gltf;  ///< an authored camera; the fields below (but lens and focus) are unused then
    PositionTrack position{glm::dvec3(0, 0, 5)};   ///< relative to `around` where there is one
    std::optional<NodeReference> around;           ///< the node that position orbits
    Target look_at = PositionTrack(glm::dvec3(0)); ///< unused where the position turns along a path
    Track<glm::dvec3> up{glm::dvec3(0, 1, 0)};
    bool up_given = false;                         ///< false: a still camera that looks along +y may choose another
    std::optional<Track<double>> dolly_m;          ///< forward along the view axis
    std::optional<Shake> shake;
    std::optional<Track<double>> focal_length_mm;   ///< exclusive with vertical_fov
    std::optional<Track<double>> vertical_fov_rad;  ///< neither given: 50 mm
    glm::dvec2 sensor_mm{36, 24};
    enum class Fit { automatic, horizontal, vertical } fit = Fit::automatic;  ///< automatic: the longer image side
    std::optional<Track<double>> f_stop;                                      ///< pinhole when absent
    std::optional<std::variant<Track<double>, NodeReference>>
        focus;       ///< metres along the view axis, or a node; default: the look_at target
    int blades = 0;  ///< 0: round
    bool operator==(const CameraSpec&) const = default;
};

enum class LightKind { directional, point, spot, area };
enum class SpotFalloff { gltf, linear, blender };

/// A light of the shot. `strength` is what the kind's unit says: directional lux, point and spot candela (power was
/// divided by 4 pi), area nit.
struct LightSpec {
    std::string id;
    SourceLocation where;
    LightKind kind = LightKind::point;
    Track<double> strength{1.0};
    Track<glm::dvec3> color{glm::dvec3(1)};
    PositionTrack position{glm::dvec3(0)};
    std::optional<Target> look_at;                                ///< wins over direction
    Track<glm::dvec3> direction{glm::dvec3(0, 0, -1)};            ///< the way the light travels
    Track<double> inner_rad{0.0}, outer_rad{0.7853981633974483};  ///< half-angles
    Track<double> range_m{0.0};                                   ///< 0: infinite, never keyed
    SpotFalloff falloff = SpotFalloff::gltf;
    Track<double> radius_m{0.0};              ///< point, spot: a sphere
    Track<double> angular_diameter_rad{0.0};  ///< directional
    Track<glm::dvec2> size_m{glm::dvec2(1)};  ///< area: rectangle
    SwitchTrack visible{1.0};                 ///< off: as if it were not there
    bool operator==(const LightSpec&) const = default;
};

struct EnvironmentSpec {
    std::optional<std::filesystem::path> image;  ///< absolute; latitude-longitude
    SourceLocation where;
    Track<glm::dvec3> color{glm::dvec3(0)};  ///< radiance is color * strength (or image * strength)
    Track<double> strength{1.0};
    Track<double> rotate_rad{0.0};  ///< about +y
    bool visible = true;            ///< false: transparent background
    bool given = false;  ///< whether the shot says what it shines: color, image or strength (defaults depend on it)
    bool operator==(const EnvironmentSpec&) const = default;
};

enum class Integrator { direct, path };
enum class FilterKind { box, gaussian, mitchell, blackman_harris };
enum class DenoiserKind { none, oidn };
/// How much work goes into acceleration structures: better ones take longer to build and less to trace.
enum class BuildQuality { low, medium, high };

/// How transforms between two motion frames are found.
enum class MotionMix {
    srt,     ///< scale, shear and translation linearly, rotation by slerp: what turns stays on its circle
    matrix,  ///< matrices linearly: cheaper to trace, and cuts the corners of what turns
};
/// Motion frames of everything that moves in each part of the shutter, whatever the motion tolerance.
struct FixedMotionFrames {
    int count = 2;
    MotionMix mix = MotionMix::srt;
    bool operator==(const FixedMotionFrames&) const = default;
};

/// How dielectrics reflect: kernels/bsdf/fresnel.h.
enum class FresnelKind { schlick, exact };

struct RenderSpec {
    SourceLocation integrator_where;
    Integrator integrator = Integrator::path;
    int samples = 64;                        ///< a pixel; the most, where max_error or a time budget decides
    int at_least = 32;                       ///< before max_error decides
    std::optional<double> max_error;         ///< standard error of a pixel in values of the display: sample until it is below
    std::optional<double> time_budget_s;     ///< wall time a frame may take
    std::optional<double> time_budget_shot_s; ///< wall time that all frames may take
    /// A number of samples that nothing but it decides.
    void fix_samples(int count) {
        samples = count;
        max_error.reset();
        time_budget_s.reset();
        time_budget_shot_s.reset();
    }
    struct Bounces {
        int total = 8, diffuse = 8, glossy = 8, transmission = 8;
        bool operator==(const Bounces&) const = default;
    } bounces;
    FilterKind filter = FilterKind::blackman_harris;
    double filter_width_px = 1.5;  ///< full width of the support
    double motion_tolerance_px = 0.1;
    std::optional<FixedMotionFrames> motion_frames;  ///< absent: as few as keep the tolerance
    std::optional<double> clamp_direct, clamp_indirect;
    DenoiserKind denoise = DenoiserKind::none;
    SourceLocation denoise_where;
    BuildQuality build = BuildQuality::medium;
    std::optional<bool> robust;   ///< rays cannot slip between triangles that share an edge; absent: where they would too often (slipping.h)
    int texture_limit_px = 0;     ///< larger textures are halved until they fit; 0: as they are
    FresnelKind fresnel = FresnelKind::schlick;
    std::string quality;          ///< the step of the ladder (quality.h) that filled in what was not given; empty: none
    std::uint32_t seed = 0;
    bool seed_animated = false;
    bool cull_backfaces = false;
    bool operator==(const RenderSpec&) const = default;
};

enum class ViewTransform { none, srgb, agx, aces, pbr_neutral };
struct ViewSpec {
    ViewTransform transform = ViewTransform::srgb;
    double exposure_stops = 0;  ///< every form of exposure, as a factor 2^stops
    bool automatic = false;     ///< meters the log-average of the shot's first frame
    std::optional<Track<double>> exposure_keys;  ///< stops over time; replaces exposure_stops (see view_at)
    bool operator==(const ViewSpec&) const = default;
};
/// The view of the frame at a time: one exposure, whatever is open of its shutter.
inline ViewSpec view_at(ViewSpec view, double time_s) {
    if (view.exposure_keys) view.exposure_stops = evaluate(*view.exposure_keys, time_s);
    view.exposure_keys.reset();
    return view;
}

enum class Aov { albedo, normal, depth, motion, samples, error };
enum class VideoCodec { h264, h265, av1, vp9, prores, ffv1, gif };
struct VideoSpec {
    std::filesystem::path file;  ///< absolute
    SourceLocation where;
    std::optional<VideoCodec>
        codec;  ///< none: by the file's extension (mp4, mkv: h264; mov: prores; webm: vp9; gif; avi refused)
    std::optional<int> crf;
    std::optional<std::string> pixel_format;  ///< none: the codec's default
    bool operator==(const VideoSpec&) const = default;
};
struct OutputSpec {
    std::vector<std::string> frames;  ///< absolute patterns with {name} filled in and {frame:04} left; never empty
    std::vector<SourceLocation> frames_where;
    std::vector<Aov> aovs;
    int png_bits = 8;  ///< 8 or 16
    std::optional<VideoSpec> video;
    bool has(Aov aov) const { return std::find(aovs.begin(), aovs.end(), aov) != aovs.end(); }
    bool operator==(const OutputSpec&) const = default;
};

struct ImageSpec {
    int width = 1280, height = 720;
    double pixel_aspect = 1;
    bool operator==(const ImageSpec&) const = default;
};

/// A validated shot: SI units, absolute paths, every default filled in that does not depend on the glTF files.
struct Shot {
    std::filesystem::path file;
    std::string name;
    Timing timing;
    bool frames_given = false;  ///< false: from 0 to the end of the longest clip (frame/ fills timing.frames in)
    ImageSpec image;
    std::vector<SceneSpec> scenes;
    CameraSpec camera;
    Shutter shutter;
    std::vector<LightSpec> lights;
    EnvironmentSpec environment;
    bool use_scene_lights = true;
    RenderSpec render;
    ViewSpec view;
    OutputSpec output;
    std::vector<LimitedTrack> limited_tracks;  ///< of what is above, for the check that needs the frame range
    std::vector<Diagnostic> warnings;
};

}  // namespace kadr
