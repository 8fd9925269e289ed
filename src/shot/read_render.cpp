// render and view.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "shot/quality.h"
#include "shot/section_readers.h"
#include "shot/track_reader.h"

namespace kadr {

namespace {

/// Full widths at which each filter is usually taken, in the order of FilterKind.
constexpr std::array<double, 4> kFilterWidths{1, 3, 4, 1.5};

constexpr int kDefaultMost = 1024;   // samples.at_most

void read_samples(const Section& section, RenderSpec& render) {
    const Field samples = section["samples"];
    if (!samples || !samples.node->is_map()) return assign(render.samples, read_integer(samples));
    const Section map = section.section("samples");
    if (samples.node->entries.empty()) return samples.mismatch();
    if (!map.present() || !(map["max_error"] || map["time_budget"] || map["time_budget_shot"] || map["at_least"] || map["at_most"])) return;
    render.max_error = read_number(map["max_error"]);
    render.time_budget_s = read_number(map["time_budget"]);
    render.time_budget_shot_s = read_number(map["time_budget_shot"]);
    render.samples = kDefaultMost;
    assign(render.samples, read_integer(map["at_most"]));
    render.at_least = std::min(render.at_least, render.samples);
    assign(render.at_least, read_integer(map["at_least"]));
    if (!map["max_error"] && !map["time_budget"] && !map["time_budget_shot"])
        samples.error("render.samples has neither max_error nor time_budget",
                      "expected { max_error: 0.01 }, { time_budget: 20 s } or both; a plain number gives every pixel as many samples");
    if (render.at_least > render.samples)
        map[map["at_least"] ? "at_least" : "at_most"].error(fmt::format("render.samples.at_least is {} and at_most {}", render.at_least, render.samples),
                              "expected at_least to be no more than at_most");
}

void read_bounces(const Section& section, RenderSpec& render) {
    const Field field = section["bounces"];
    if (!field) return;
    const Section map = section.section("bounces");
    const auto total = map.present() ? read_integer(map["total"]) : read_integer(field);
    if (total)
        render.bounces.total = render.bounces.diffuse = render.bounces.glossy = render.bounces.transmission =
            static_cast<int>(*total);
    assign(render.bounces.diffuse, read_integer(map["diffuse"]));
    assign(render.bounces.glossy, read_integer(map["glossy"]));
    assign(render.bounces.transmission, read_integer(map["transmission"]));
}

void read_filter(const Section& section, RenderSpec& render) {
    const Field field = section["filter"];
    if (!field) return;
    const Section map = section.section("filter");
    assign(render.filter, read_choice<FilterKind>(map.present() ? map["type"] : field));
    render.filter_width_px = kFilterWidths[static_cast<std::size_t>(render.filter)];
    assign(render.filter_width_px, read_number(map["width"]));
}

void read_motion_frames(const Section& section, RenderSpec& render) {
    const Field field = section["motion_frames"];
    if (!field || is_word(field, "auto")) return;
    const Section map = section.section("motion_frames");
    const auto count = map.present() ? read_integer(map["count"]) : read_integer(field);
    FixedMotionFrames frames;
    assign(frames.count, count);
    assign(frames.mix, read_choice<MotionMix>(map["mix"]));
    if (count) render.motion_frames = frames;
}

std::optional<double> read_limit(const Field& field) {
    return is_word(field, "none") ? std::nullopt : read_number(field);
}

void read_texture_limit(const Field& field, RenderSpec& render) {
    if (const std::optional<double> limit = read_limit(field)) render.texture_limit_px = static_cast<int>(*limit);
}

void read_seed(const Section& section, RenderSpec& render) {
    const Field field = section["seed"];
    if (!field) return;
    const Section map = section.section("seed");
    assign(render.seed, read_integer(map.present() ? map["value"] : field));
    assign(render.seed_animated, read_boolean(map["animated"]));
}

/// Stops of a camera's exposure value: a factor of 1 / (1.2 * 2^ev100).  Source: Lagarde and de Rousiers, "Moving
/// Frostbite to PBR", 2014, section 5.1.
double stops_of_ev100(double ev100) { return -(ev100 + std::log2(1.2)); }

std::optional<double> read_camera_exposure(const Section& exposure) {
    for (const char* key : {"iso", "time", "f_stop"}) exposure.exclusive("ev100", key);
    if (exposure.has("ev100")) {
        const auto ev100 = read_number(exposure["ev100"]);
        return ev100 ? std::optional(stops_of_ev100(*ev100)) : std::nullopt;
    }
    for (const char* key : {"iso", "time", "f_stop"}) {
        if (!exposure.has(key))
            exposure.context().problems.error(exposure.node()->place,
                                              fmt::format("{}.{} is missing", exposure.name(), key),
                                              "give { ev100 }, or { iso, time, f_stop }");
    }
    const auto iso = read_number(exposure["iso"]), time_s = read_number(exposure["time"]),
               f_stop = read_number(exposure["f_stop"]);
    if (!iso || !time_s || !f_stop) return std::nullopt;
    return stops_of_ev100(std::log2(*f_stop * *f_stop / *time_s * 100 / *iso));
}

void read_exposure(const Section& section, ViewSpec& view) {
    const Field field = section["exposure"];
    if (field && field.node->is_map() && field.node->find("keys")) {
        view.exposure_keys = read_number_track(field);
        return;
    }
    const Section map = section.section("exposure");
    if (map.present())
        assign(view.exposure_stops, read_camera_exposure(map));
    else if (is_word(field, "auto"))
        view.automatic = true;
    else
        assign(view.exposure_stops, read_number(field));
}

}  // namespace

RenderSpec read_render(const Section& shot) {
    RenderSpec render;
    const Section section = shot.section("render");
    const Field quality = section["quality"];
    // Its values are laid under the document before it is read; the name is kept for what is said of the picture.
    if (const auto index = read_choice_index(quality)) render.quality = quality_blocks()[static_cast<std::size_t>(*index)].name;
    const Field integrator = section["integrator"];
    if (integrator) render.integrator_where = location_of(integrator.node->place);
    assign(render.integrator, read_choice<Integrator>(integrator));
    read_samples(section, render);
    read_bounces(section, render);
    read_filter(section, render);
    assign(render.motion_tolerance_px, read_number(section["motion_tolerance"]));
    read_motion_frames(section, render);
    const Section clamp = section.section("clamp");
    render.clamp_direct = read_limit(clamp["direct"]);
    render.clamp_indirect = read_limit(clamp["indirect"]);
    const Field denoise = section["denoise"];
    if (denoise) render.denoise_where = location_of(denoise.node->place);
    assign(render.denoise, read_choice<DenoiserKind>(denoise));
    assign(render.build, read_choice<BuildQuality>(section["build"]));
    if (const Field robust = section["robust"]; robust && !is_word(robust, "auto")) render.robust = read_boolean(robust);
    read_texture_limit(section["texture_limit"], render);
    assign(render.fresnel, read_choice<FresnelKind>(section["fresnel"]));
    read_seed(section, render);
    assign(render.cull_backfaces, read_boolean(section["cull_backfaces"]));
    return render;
}

ViewSpec read_view(const Section& shot) {
    ViewSpec view;
    const Section section = shot.section("view");
    assign(view.transform, read_choice<ViewTransform>(section["transform"]));
    read_exposure(section, view);
    return view;
}

}  // namespace kadr
