#include "extremes/shot_fields.h"

#include <algorithm>

#include "base/text.h"

namespace kadr::test {

namespace {

/// Where a field, or all below a section, stands in the shot around it. In the path and in the text '#' is the field's own
/// key, and '@' in the text its value.
struct Place {
    std::string_view field;
    std::string_view path, text = "@";
    std::string_view ordinary = {};     ///< number that belongs there; empty: one that the field's range allows
    std::string_view keyed_text = {};   ///< of a track, where that needs another
};

// The first row that fits counts.
constexpr Place kPlaces[] = {
    {"timing.frames", "timing.frames", "\"@\"", "12"},
    {"timing", "timing.#"},
    {"image", "image.#"},
    {"scenes.transform", "scenes.rig.transform.#"},
    {"scenes.visible", "scenes.rig.#"},
    {"scenes.animation.clip", "scenes.rig.animation", "{ clip: @ }", "0"},
    {"scenes.animation", "scenes.rig.animation", "{ clip: all, #: @ }"},
    {"scenes.nodes", "scenes.rig.nodes", "{ Morph: { #: @ } }"},
    {"scenes.materials", "scenes.rig.materials", "{ Paint: { #: @ } }"},
    {"scenes.instances.translate", "scenes.rig.instances", "[ { #: @ }, { translate: [1, 0, 0] } ]"},
    {"scenes.instances.rotate", "scenes.rig.instances", "[ { #: @ }, { translate: [1, 0, 0] } ]"},
    {"scenes.instances.scale", "scenes.rig.instances", "[ { #: @ }, { translate: [1, 0, 0] } ]"},
    {"scenes.instances.offset", "scenes.rig.instances", "[ { #: @ }, { translate: [1, 0, 0] } ]"},
    {"scenes.instances.grid", "scenes.rig.instances", "{ grid: @ }"},
    {"scenes.instances.count", "scenes.rig.instances", "{ scatter: ground/Square, count: @ }"},
    {"scenes.instances.distance", "scenes.rig.instances", "{ scatter: ground/Square, count: 5, distance: @ }", "0.01"},
    {"scenes.instances.offset_steps", "scenes.rig.instances", "{ grid: [2, 1, 2], random_offset: [0, 1], offset_steps: @ }"},
    {"scenes.instances", "scenes.rig.instances", "{ grid: [2, 1, 2], #: @ }"},
    {"camera.blades", "camera", "{ f_stop: 2, blades: @ }", "5"},
    {"camera.sensor", "camera.sensor.#"},
    {"camera.focal_length", "camera.focal_length", "@", "35"},
    {"camera", "camera.#"},
    {"shutter.open", "shutter", "{ open: @, close: 2 }"},
    {"shutter.close", "shutter", "{ open: -2, close: @ }"},
    {"shutter.curve", "shutter.curve.#"},
    {"shutter.rolling", "shutter.rolling.#", "@", "0.01"},
    {"shutter.time", "shutter", "{ time: @ }", "0.01"},
    {"shutter.angle", "shutter.angle"},
    {"shutter", "shutter", "@", "0"},
    {"lights.illuminance", "lights.sun.#"},
    {"lights.angular_diameter", "lights.sun.#"},
    {"lights.direction", "lights.sun.#"},
    {"lights.luminance", "lights.panel.#"},
    {"lights.size", "lights.panel.#"},
    {"lights.look_at", "lights.panel.#"},
    {"lights.intensity", "lights.bulb.#"},
    {"lights.power", "lights.bulb.#"},
    {"lights.outer", "lights.spot.#", "@", "20"},
    {"lights", "lights.spot.#"},
    {"environment.rotate", "environment", "{ image: sky.hdr, rotate: @ }"},
    {"environment", "environment.#"},
    {"render.samples.max_error", "render.samples", "{ max_error: @ }"},
    {"render.samples.time_budget", "render.samples", "{ time_budget: @ }"},
    {"render.samples.time_budget_shot", "render.samples", "{ time_budget_shot: @ }"},
    {"render.samples.at_least", "render.samples", "{ max_error: 0.5, at_least: @ }"},
    {"render.samples.at_most", "render.samples", "{ max_error: 0.5, at_least: 2, at_most: @ }"},
    {"render.bounces.", "render.bounces.#"},
    {"render.filter", "render.filter.#"},
    {"render.clamp", "render.clamp.#"},
    {"render.motion_frames.count", "render.motion_frames", "{ count: @ }"},
    {"render.seed.value", "render.seed.value"},
    {"render", "render.#"},
    {"view.exposure.iso", "view.exposure", "{ iso: @, time: 10 ms, f_stop: 8 }"},
    {"view.exposure.time", "view.exposure", "{ iso: 100, time: @, f_stop: 8 }"},
    {"view.exposure.f_stop", "view.exposure", "{ iso: 100, time: 10 ms, f_stop: @ }"},
    {"view.exposure.ev100", "view.exposure", "{ ev100: @ }"},
    {"view", "view.#"},
    {"output.video", "output.video", "{ file: a.mp4, #: @ }"},
    {"output.png_bits", "output.png_bits", "@", "8"},
    {"kadr", "kadr"},
    {"rotation.axis", "scenes.rig.transform.rotate", "{ axis: @, angle: { keys: { 0 s: 0, 1 s: 90 } } }"},
    {"rotation.angle", "scenes.rig.transform.rotate", "{ axis: [0, 1, 0], angle: @ }"},
    {"key.spin", "scenes.rig.transform.rotate", "{ keys: { 0 s: { value: [0, 0, 0], spin: @ }, 1 s: [0, 90, 0] } }"},
    {"key.axis", "scenes.rig.transform.rotate", "{ keys: { 0 s: { value: [0, 0, 0], axis: @ }, 1 s: [0, 90, 0] } }"},
    {"motion.path", "camera.position", "{ path: @, to: 1 s }"},
    {"motion.from", "camera.position", "{ path: [[0, 0, 6], [1, 0, 6], [2, 1, 6]], to: 1 s, from: @ }", "0.25"},
    {"motion.to", "camera.position", "{ path: [[0, 0, 6], [1, 0, 6], [2, 1, 6]], to: @ }"},
    {"motion.at", "camera.position", "{ path: [[0, 0, 6], [1, 0, 6], [2, 1, 6]], at: @ }"},
    {"motion.up", "scenes.rig.transform.translate", "{ path: [[0, 0, 0], [1, 0, 0], [2, 1, 0]], to: 1 s, orient: along, up: @ }"},
    {"orbit.radius", "camera.orbit", "{ radius: @, to: 1 s }", "6"},
    {"orbit.turns", "camera.orbit", "{ radius: 6, to: 1 s, turns: @ }", "", "{ radius: 6, turns: @ }"},
    {"orbit.from", "camera.orbit", "{ radius: 6, from: @, to: 1 s }", "0.25"},
    {"orbit.to", "camera.orbit", "{ radius: 6, to: @ }"},
    {"orbit", "camera.orbit", "{ radius: 6, to: 1 s, #: @ }"},
    {"shake.amplitude", "camera.shake", "{ amplitude: @ }"},
    {"shake", "camera.shake", "{ amplitude: 0.01, #: @ }"},
    {"reel.fps", "reel.fps"},
    {"reel.shots.in", "reel.shots.0.in", "@", "0.25"},
    {"reel.shots.crossfade", "reel.shots.0.crossfade", "@", "0.25"},
    {"reel.shots.fade_in.duration", "reel.shots.0.fade_in", "{ duration: @ }", "0.25"},
    {"reel.shots.fade_in.from", "reel.shots.0.fade_in", "{ duration: 0.25, from: @ }"},
    {"reel.shots.fade_in", "reel.shots.0.fade_in", "@", "0.25"},
    {"reel.shots.fade_out.duration", "reel.shots.1.fade_out", "{ duration: @ }", "0.25"},
    {"reel.shots.fade_out.to", "reel.shots.1.fade_out", "{ duration: 0.25, to: @ }"},
    {"reel.shots.fade_out", "reel.shots.1.fade_out", "@", "0.25"},
    {"reel.shots", "reel.shots.0.#"},
    {"reel.sound", "reel.sound", "{ file: sound.wav, #: @ }"},
    {"reel.output.video", "reel.output.video", "{ file: a.mp4, #: @ }"},
    {"reel.output.png_bits", "reel.output.png_bits", "@", "8"},
    {"reel.size", "reel.size", "@", "8"},
    {"reel", "reel.#"},
};

/// Fields whose numbers stand in other fields' rows: of tracks and keys in every field that takes a track.
constexpr std::string_view kElsewhere[] = {"track.keys"};

const Place* place_of(std::string_view field) {
    for (const Place& place : kPlaces) {
        const bool below = field.size() > place.field.size() && field.starts_with(place.field) && (place.field.ends_with('.') || field[place.field.size()] == '.');
        if (field == place.field || below) return &place;
    }
    return nullptr;
}

std::string replaced(std::string text, char mark, std::string_view by) {
    for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += by.size()) text.replace(at, 1, by);
    return text;
}

/// A number that the field's range allows.
std::string ordinary_number(const FieldSpec& field, const Place& place) {
    if (!place.ordinary.empty()) return std::string(place.ordinary);
    for (const char* number : {"1", "2", "0.5", "8", "45", "0"})
        if (const double value = std::stod(number); value >= field.low && value <= field.high) return number;
    return "1";
}

/// A text with '@' where a number stands, and one that belongs there.
struct Value {
    std::string text, ordinary;
};

/// The values that a field takes.
class Values {
public:
    Values(const FieldSpec& field, std::string ordinary) : field_(field), ordinary_(std::move(ordinary)) {}

    std::vector<Value> all() {
        const std::vector<std::string> values = texts(ordinary_);
        for (const std::string& text : values) add(text, ordinary_);
        if (field_.forms & kFrames) add("12-@", "14"), add("12-40x@", "2");
        if (field_.forms & kRational) add("@/1001", "24000"), add("24000/@", "1001");
        if (field_.forms & kKeys) add("{ @: 0, 1: 1 }", "0.5"), add("{ 0: 0, @: 1 }", "0.5"), add("{ 0: 0, 1: @ }", "0.5");
        if (field_.forms & kPoints) add("[[0, 0, 6], [@, 0, 6], [2, 1, 6]]", "1"), add("[[0, 0, 6], [1, 0, 6], [2, @, 6]]", "1");
        if (field_.forms & kWeights) add("{ all: @ }", "1");
        if (field_.forms & kRotation) add("{ axis: [0, @, 1], angle: 10 }", "1"), add("{ axis: [0, 1, 0], angle: @ }", "1");
        if (field_.forms & kNumber) add_units();
        if (field_.forms & kTrack) add_keys(values);
        return std::move(values_);
    }

private:
    void add(const std::string& text, const std::string& ordinary) { values_.push_back({text, ordinary}); }

    /// Plain values, whose other components are `o`.
    std::vector<std::string> texts(const std::string& o) const {
        std::vector<std::string> list;
        if (field_.forms & (kNumber | kInteger | kRational | kFrames)) list.push_back("@");
        if (field_.forms & (kVector2 | kRange | kSize2 | kNumberList)) list.insert(list.end(), {"[@, " + o + "]", "[" + o + ", @]"});
        if (field_.forms & kVector3) list.insert(list.end(), {"[@, " + o + ", " + o + "]", "[" + o + ", " + o + ", @]"});
        if (field_.forms & kRotation) list.insert(list.end(), {"[@, 0, 0]", "[0, @, 0]", "[0, 0, 0, @]", "[@, 0, 0, 1]"});
        return list;
    }

    /// The ordinary number in every unit that the field takes.
    void add_units() {
        for (const UnitSpec& unit : unit_table())
            if (unit.quantity == field_.quantity) add(std::string("@ ") + unit.name, format_number(from_natural(field_.quantity, std::stod(ordinary_)) * unit.divisor / unit.multiplier));
    }

    void add_keys(const std::vector<std::string>& values) {
        if (values.empty()) return add("{ keys: { @ s: true, 100 s: false } }", "1");  // a switch
        const std::string other = replaced(values.front(), '@', ordinary_);
        add("{ keys: { @ s: " + other + ", 100 s: " + other + " } }", "1");
        add("{ keys: { 0 s: " + other + ", @ f: " + other + " }, before: repeat, after: repeat }", "9");
        for (const char* ease : {"[@, 0, 0.5, 1]", "[0.5, @, 0.5, 1]"}) add(std::string("{ keys: { 0 s: { value: ") + other + ", ease: " + ease + " }, 1 s: " + other + " } }", "0.5");
        for (const std::string& value : values) {
            const std::string same = replaced(value, '@', ordinary_);
            add("{ keys: { 0 s: " + value + ", 1 s: " + same + " } }", ordinary_);
            add("{ keys: { 0 s: " + same + ", 0.25 s: " + value + ", 1 s: " + same + " }, interpolate: smooth }", ordinary_);
            add("{ keys: { 0 s: " + same + ", 0.25 s: " + value + " }, after: continue }", ordinary_);
        }
        const std::vector<std::string> tangents = texts("0");
        for (std::size_t i = 0; i < tangents.size(); ++i) {
            const std::string same = replaced(values[i], '@', ordinary_), &tangent = tangents[i];
            add("{ keys: { 0 s: { value: " + same + ", out_tangent: " + tangent + " }, 1 s: " + same + " }, interpolate: cubic }", "0");
            add("{ keys: { 0 s: " + same + ", 1 s: { value: " + same + ", in_tangent: " + tangent + " } }, interpolate: cubic }", "0");
        }
    }

    const FieldSpec& field_;
    std::string ordinary_;
    std::vector<Value> values_;
};

}  // namespace

ShotOverrides NumberSlot::with(const std::string& number) const {
    ShotOverrides overrides;
    overrides.set = {{path, replaced(before + "@" + after, '@', number)}};
    return overrides;
}

bool has_numbers(const FieldSpec& field) {
    constexpr unsigned kNumeric = kInteger | kNumber | kVector2 | kVector3 | kRotation | kRational | kKeys | kSize2 | kRange | kNumberList | kPoints | kWeights | kFrames | kTrack;
    return (field.forms & kNumeric) && std::ranges::find(kElsewhere, std::string_view(field.path)) == std::end(kElsewhere);
}

std::vector<NumberSlot> slots_of(const FieldSpec& field) {
    const Place* place = place_of(field.path);
    if (!place) return {};
    const std::string key(key_of(field)), ordinary = ordinary_number(field, *place);
    std::vector<NumberSlot> slots;
    for (const Value& value : Values(field, ordinary).all()) {
        const bool keyed = !place->keyed_text.empty() && value.text.starts_with("{ keys");
        const std::string text = replaced(replaced(std::string(keyed ? place->keyed_text : place->text), '#', key), '@', value.text);
        const std::size_t at = text.find('@');
        slots.push_back({field.path, replaced(std::string(place->path), '#', key), text.substr(0, at), text.substr(at + 1), value.ordinary});
    }
    return slots;
}

std::string reel_around_slots() { return "kadr-reel: 1\nshots: [ { shot: shot.yaml }, { shot: shot.yaml } ]\n"; }

std::string shot_around_slots() {
    return R"(kadr: 1
timing: { fps: 24, frames: 12 }
scenes:
  - { id: rig, gltf: scene.gltf }
  - { id: ground, gltf: scene.gltf, animation: { clip: none } }
camera: { look_at: [0.1, 0.2, 0.3] }
shutter: { angle: 180 deg }
lights:
  - { id: sun, type: directional }
  - { id: bulb, type: point, position: [2, 2, 2] }
  - { id: spot, type: spot, position: [0, 4, 4], inner: 10 deg }
  - { id: panel, type: area, position: [-2, 2, 2] }
environment: { color: [0.1, 0.1, 0.1] }
view: { exposure: 0 }
render: { bounces: { total: 4 } }
)";
}

}  // namespace kadr::test
