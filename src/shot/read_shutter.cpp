// The shutter: when it opens and closes, its curve, and lines that open one after another.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "base/text.h"
#include "shot/section_readers.h"

namespace kadr {

namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;
constexpr double kMostFrames = 100;

/// A time that a frame's shutter may take.
std::optional<double> read_duration(const Field& field) {
    const auto seconds = read_number(field);
    if (!seconds) return std::nullopt;
    const double frames = *seconds * field.context->timing.fps.value();
    if (frames <= kMostFrames) return seconds;
    field.error(fmt::format("{} is {}, which is {:.6g} frames", field.name, field.node->text, frames),
                fmt::format("expected at most {} frames", kMostFrames));
    return std::nullopt;
}

/// Opening and closing of a shutter that is open for `length`; in the order of the phase's choices.
std::pair<double, double> interval_of(double length, int phase) {
    if (phase == 0) return {0, length};
    if (phase == 1) return {-length / 2, length / 2};
    return {-length, 0};
}

void read_interval(const Section& section, Shutter& shutter) {
    for (const char* one : {"angle", "time", "phase"})
        for (const char* other : {"open", "close"}) section.exclusive(one, other);
    const Field open = section["open"], close = section["close"];
    if (!open || !close) {
        const Field& given = open ? open : close;
        given.error(fmt::format("{} stands alone", given.name),
                    "give both open and close, in frames: shutter: { open: -0.25, close: 0.25 }");
        return;
    }
    const auto open_frames = read_number(open), close_frames = read_number(close);
    if (!open_frames || !close_frames) return;
    if (*close_frames < *open_frames)
        close.error(fmt::format("shutter.close is {}, before shutter.open at {}", close.node->text, open.node->text),
                    "expected a close that is not before open");
    shutter.open_frames = *open_frames;
    shutter.close_frames = *close_frames;
}

void read_length(const Section& section, Shutter& shutter) {
    section.exclusive("angle", "time");
    const int phase = read_choice_index(section["phase"]).value_or(0);
    if (const auto seconds = read_duration(section["time"])) {
        shutter.open_frames = shutter.close_frames = 0;
        std::tie(shutter.open_s, shutter.close_s) = interval_of(*seconds, phase);
        return;
    }
    double angle_rad = kFullTurn / 2;
    assign(angle_rad, read_number(section["angle"]));
    std::tie(shutter.open_frames, shutter.close_frames) = interval_of(angle_rad / kFullTurn, phase);
}

std::optional<double> read_share(const Field& keys, const YamlNode& node, std::string_view what) {
    const ParsedQuantity parsed = parse_quantity(node.is_scalar() && !node.quoted ? node.text : "", Quantity::number);
    if (parsed.problem == ParsedQuantity::Problem::none && parsed.value >= 0 && parsed.value <= 1) return parsed.value;
    keys.context->problems.error(node.place, fmt::format("{} of {} is {}", what, keys.name, shown_value(node)),
                                 "expected a number from 0 to 1");
    return std::nullopt;
}

void read_curve_key(const Field& keys, const YamlEntry& entry, std::vector<ShutterCurve::Key>& curve) {
    const auto fraction = read_share(keys, entry.key, "a fraction"), efficiency = read_share(keys, entry.value, "a value");
    if (!fraction || !efficiency) return;
    if (!curve.empty() && *fraction <= curve.back().fraction)
        keys.context->problems.error(
            entry.key.place, fmt::format("{} has a key at {} after one at {}", keys.name, entry.key.text, format_number(curve.back().fraction)),
            "expected ascending fractions");
    curve.push_back({*fraction, *efficiency});
}

void read_curve(const Section& shutter_section, ShutterCurve& curve) {
    const Field field = shutter_section["curve"];
    if (!field) return;
    if (!field.node->is_map()) return assign(curve.shape, read_choice_index(field));
    const Section section = shutter_section.section("curve");
    const Field keys = section["keys"];
    if (!keys) return;
    if (!keys.node->is_map() || keys.node->entries.empty()) return keys.mismatch_with("expected fractions and values: { 0: 0, 0.5: 1, 1: 0 }");
    for (const YamlEntry& entry : keys.node->entries) read_curve_key(keys, entry, curve.keys);
    if (curve.keys.size() < keys.node->entries.size()) return curve.keys.clear();
    curve.shape = ShutterCurve::Shape::keys;
    if (!(light_passed(curve, 1) > 0)) keys.error(fmt::format("{} lets no light through", keys.name), "expected a value above 0");
}

void read_rolling(const Section& shutter_section, RollingShutter& rolling) {
    const Section section = shutter_section.section("rolling");
    if (!section.present()) return;
    const int direction = read_choice_index(section["direction"]).value_or(0);
    const auto duration = read_duration(section["duration"]);
    if (!duration || *duration == 0) return;
    rolling.direction = static_cast<RollingShutter::Direction>(direction + 1);
    rolling.duration_s = *duration;
}

void read_exposure(const Section& section, Shutter& shutter) {
    const Field field = section["exposure"];
    shutter.physical = read_choice_index(field).value_or(0) == 1;
    if (shutter.physical && !(open_length_s(shutter, section.context().timing.fps) > 0))
        field.error("shutter.exposure is physical, but the shutter does not open: every frame would be black",
                    "expected an angle or a time above 0, or exposure: constant");
}

}  // namespace

Shutter read_shutter(const Section& shot) {
    Shutter shutter;
    const Field field = shot["shutter"];
    if (!field) return shutter;
    if (!field.node->is_map()) {
        const bool zero = field.node->is_scalar() && !field.node->quoted && field.node->text == "0";
        if (!zero) field.mismatch("a bare shutter can only be 0, for no motion blur");
        shutter.close_frames = 0;
        return shutter;
    }
    const Section section = shot.section("shutter");
    if (section.has("open") || section.has("close"))
        read_interval(section, shutter);
    else
        read_length(section, shutter);
    read_curve(section, shutter.curve);
    read_rolling(section, shutter.rolling);
    read_exposure(section, shutter);
    return shutter;
}

}  // namespace kadr
