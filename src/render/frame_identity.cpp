#include "render/frame_identity.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include <fmt/format.h>

#include "base/text.h"
#include "base/version.h"
#include "output/frame_writer.h"
#include "render/denoising.h"
#include "shot/schema.h"
#include "shot/shot_hash.h"

namespace kadr {
namespace {

void add_assets(const LoadedShot& shot, Hasher& hasher) {
    for (const SceneFile& file : shot.scene().files) hasher.add(file.content.hex());
    const auto& image = shot.shot().environment.image;
    hasher.add(image ? hash_file(*image).hex() : std::string());
}

std::string linear_hash(const LoadedShot& shot) {
    Hasher hasher;
    hasher.add(kVersion);
    hash_shot(shot.shot(), hasher);
    add_assets(shot, hasher);
    return hasher.finish().hex();
}

std::string display_hash(const std::string& linear, const Shot& shot, int metered_frame) {
    Hasher hasher;
    hasher.add(linear);
    hash_view(shot, hasher);
    if (shot.view.automatic) hasher.add(static_cast<std::int64_t>(metered_frame));
    return hasher.finish().hex();
}

std::string frame_hash(const std::string& shot, const FrameTime& frame) {
    Hasher hasher;
    hasher.add(shot);
    hasher.add(static_cast<std::int64_t>(frame.number));
    hasher.add(frame.time.numerator);
    hasher.add(frame.time.denominator);
    hasher.add(frame.open_s);
    hasher.add(frame.close_s);
    return hasher.finish().hex();
}

/// "cpu (Embree 3.13.5, 8 lanes, 2 threads)" -> "cpu": threads and lanes do not change a pixel, so they do not belong
/// into a frame's metadata.
std::string device_kind(const std::string& name) { return name.substr(0, name.find(' ')); }

void add_sampling(Metadata& metadata, const SamplingReport& sampling) {
    metadata["samples_least"] = std::to_string(sampling.least);
    metadata["samples_most"] = std::to_string(sampling.most);
    metadata["samples_mean"] = fmt::format("{:.4g}", sampling.mean);
    metadata["stopped_by"] = name_of(sampling.stopped_by);
    if (!sampling.error.known) return;
    metadata["error_relmse"] = fmt::format("{:.4g}", sampling.error.relmse);
    metadata["error_relmse_95"] = fmt::format("{:.4g} to {:.4g}", sampling.error.relmse_low, sampling.error.relmse_high);
    metadata["error_display"] = fmt::format("{:.4g}", sampling.display_error);
}

/// The word that the format has for a value of an enum.
template <class Enum>
std::string word_of(const char* path, Enum value) {
    return std::string(choices_of(*find_field(path))[static_cast<std::size_t>(value)].name);
}

std::string limit_of(const std::optional<double>& limit) { return limit ? format_number(*limit) : "none"; }

/// How the picture was asked for, setting by setting.
void add_settings(Metadata& metadata, const RenderSpec& render) {
    if (!render.quality.empty()) metadata["quality"] = render.quality;
    metadata["integrator"] = word_of("render.integrator", render.integrator);
    metadata["bounces"] = fmt::format("{} (diffuse {}, glossy {}, transmission {})", render.bounces.total, render.bounces.diffuse,
                                      render.bounces.glossy, render.bounces.transmission);
    metadata["filter"] = fmt::format("{} {} px", word_of("render.filter.type", render.filter), format_number(render.filter_width_px));
    metadata["motion_tolerance_px"] = format_number(render.motion_tolerance_px);
    metadata["motion_frames_set"] =
        render.motion_frames ? fmt::format("{} {}", render.motion_frames->count, word_of("render.motion_frames.mix", render.motion_frames->mix)) : "auto";
    metadata["clamp_direct"] = limit_of(render.clamp_direct);
    metadata["clamp_indirect"] = limit_of(render.clamp_indirect);
    metadata["build"] = word_of("render.build", render.build);
    metadata["robust"] = render.robust ? (*render.robust ? "yes" : "no") : "auto";
    metadata["texture_limit_px"] = render.texture_limit_px > 0 ? std::to_string(render.texture_limit_px) : "none";
    metadata["fresnel"] = word_of("render.fresnel", render.fresnel);
    const Denoiser* denoiser = denoiser_of(render);
    metadata["denoise"] = word_of("render.denoise", render.denoise) + (denoiser ? " " + denoiser->version() : "");
    metadata["seed"] = std::to_string(render.seed) + (render.seed_animated ? ", animated" : "");
    metadata["cull_backfaces"] = render.cull_backfaces ? "yes" : "no";
}

/// What decides how many samples a pixel gets.
void add_sampling_settings(Metadata& metadata, const RenderSpec& render) {
    metadata["samples"] = std::to_string(render.samples);
    if (render.max_error) metadata["max_error"] = format_number(*render.max_error);
    if (render.max_error || render.time_budget_s || render.time_budget_shot_s) metadata["samples_at_least"] = std::to_string(render.at_least);
    if (render.time_budget_s) metadata["time_budget_s"] = format_number(*render.time_budget_s);
    if (render.time_budget_shot_s) metadata["time_budget_shot_s"] = format_number(*render.time_budget_shot_s);
}

std::string shutter_text(const Shutter& shutter) {
    const auto end = [](double frames, double seconds) {
        return seconds != 0 ? fmt::format("{} f + {} s", format_number(frames), format_number(seconds)) : format_number(frames) + " f";
    };
    return fmt::format("{} to {}{}", end(shutter.open_frames, shutter.open_s), end(shutter.close_frames, shutter.close_s), shutter.physical ? ", physical" : "");
}

}  // namespace

ShotIdentity::ShotIdentity(const LoadedShot& shot, int metered_frame)
    : linear_(linear_hash(shot)), display_(display_hash(linear_, shot.shot(), metered_frame)) {}

FrameIdentity ShotIdentity::of(const FrameTime& frame) const {
    return {frame_hash(linear_, frame), frame_hash(display_, frame)};
}

bool is_linear_file(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return extension == ".exr";
}

Metadata shot_metadata(const Shot& shot, const std::string& device_name) {
    Metadata metadata{
        {"shot", shot.name},
        {"version", kVersion},
        {"device", device_kind(device_name)},
        {"fps", format_number(shot.timing.fps.value())},
        {"shutter", shutter_text(shot.shutter)},
        {"view", fmt::format("{}, {}", word_of("view.transform", shot.view.transform),
                             shot.view.automatic ? "auto" : format_number(shot.view.exposure_stops) + " stops")},
    };
    add_settings(metadata, shot.render);
    add_sampling_settings(metadata, shot.render);
    return metadata;
}

Metadata frame_metadata(const Shot& shot, const FrameTime& time, const RenderedFrame& frame,
                        const std::string& device_name) {
    Metadata metadata = shot_metadata(shot, device_name);
    metadata["frame"] = std::to_string(time.number);
    metadata["time"] = format_number(time.time_s());
    metadata["motion_error_px"] = fmt::format("{:.4g}", frame.motion.largest_px());
    metadata["motion_error_instances_px"] = fmt::format("{:.4g}", frame.motion.instances_px);
    metadata["motion_error_vertices_px"] = fmt::format("{:.4g}", frame.motion.vertices_px);
    metadata["motion_error_camera_px"] = fmt::format("{:.4g}", frame.motion.camera_px);
    metadata["motion_frames"] = std::to_string(frame.motion.frames);
    metadata["shutter_parts"] = std::to_string(frame.motion.parts);
    metadata["motion_tolerance_met"] = frame.motion.met() ? "yes" : "no";
    metadata["light_error"] = fmt::format("{:.4g}", frame.light_error);
    if (shot.view.exposure_keys) metadata["exposure_stops"] = format_number(view_at(shot.view, time.time_s()).exposure_stops);
    add_sampling(metadata, frame.sampling);
    metadata["dropped_samples"] = std::to_string(frame.statistics.dropped_samples);
    metadata["seconds"] = fmt::format("{:.3f}", frame.seconds);
    return metadata;
}

double stored_relmse(const std::filesystem::path& frame) {
    const Metadata metadata = describe_image(frame);
    const auto stored = metadata.find("error_relmse");
    double relmse = 0;
    if (stored != metadata.end()) std::from_chars(stored->second.data(), stored->second.data() + stored->second.size(), relmse);
    return relmse;
}

}  // namespace kadr
