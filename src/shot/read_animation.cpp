// scenes.animation: the layers of clips.
#include <fmt/format.h>

#include "shot/section_readers.h"
#include "shot/track_reader.h"

namespace kadr {

namespace {

/// The clip that a value or a key of a map names. @param field  of scenes.animation.clip
void read_clip_name(const Field& field, ClipLayer& layer) {
    layer.where = location_of(field.node->place);
    if (is_word(field, "all")) {
        layer.clips = ClipLayer::Clips::all;
    } else if (is_word(field, "none")) {
        layer.clips = ClipLayer::Clips::none;
    } else if (looks_like_number(*field.node)) {
        layer.clips = ClipLayer::Clips::one;
        const auto index = read_integer(field);
        if (index && (*index < 0 || *index > 1000000))
            field.mismatch("an index counts from 0");
        else
            assign(layer.clip_index, index);
    } else if (const auto name = read_text(field)) {
        layer.clips = ClipLayer::Clips::one;
        layer.clip_name = *name;
    }
}

/// Seconds of shot time: in frames, the time of that frame, which counts from timing.first.
std::optional<double> read_shot_time(const Field& field) {
    const auto time_s = read_number(field);
    if (!time_s || !parse_quantity(field.node->text, Quantity::time).in_frames) return time_s;
    return *time_s - seconds_of_frames(field.context->timing.first, field.context->timing.fps);
}

void check_range(const Section& section, const ClipLayer& layer) {
    if (!layer.out_s || *layer.out_s >= layer.in_s.value_or(0)) return;
    const Field out = section["out"];
    out.error(fmt::format("{} is {}, before {}.in", out.name, shown_value(*out.node), section.name()),
              "expected in, then out; a negative speed plays from out to in");
}

/// What all clips of one map have in common.
ClipLayer read_times(const Section& section) {
    ClipLayer layer;
    if (section.present()) layer.where = location_of(section.node()->place);
    assign(layer.at_s, read_shot_time(section["at"]));
    layer.start_s = read_number(section["start"]);
    assign(layer.speed, read_number(section["speed"]));
    layer.in_s = read_number(section["in"]);
    layer.out_s = read_number(section["out"]);
    assign(layer.loop, read_choice<ClipLayer::Loop>(section["loop"]));
    assign(layer.weight, read_number_track(section["weight"]));
    check_range(section, layer);
    return layer;
}

/// clip: { Walk: 0.3, Run: 0.7 } is one layer each, with the times of the map around it.
void add_weighted(const Section& section, const Field& clips, const ClipLayer& times, std::vector<ClipLayer>& layers) {
    if (clips.node->entries.empty()) return clips.mismatch();
    for (const YamlEntry& entry : clips.node->entries) {
        ClipLayer layer = times;
        const std::string name = fmt::format("{}.{}", clips.name, entry.key.text);
        read_clip_name(clips.with(entry.key, clips.name), layer);
        const Field weight{clips.context, &entry.value, find_field("scenes.animation.weight"), name};
        assign(layer.weight, read_number_track(weight));
        layers.push_back(std::move(layer));
    }
    if (section.has("weight"))
        section.context().problems.error(section.key_place("weight"), fmt::format("{}.weight stands beside weights in {}", section.name(), clips.name),
                                         "give the weights in one of the two");
}

void add_layers(const Section& section, std::vector<ClipLayer>& layers) {
    ClipLayer times = read_times(section);
    const Field clip = section["clip"];
    if (clip && clip.node->is_map()) return add_weighted(section, clip, times, layers);
    if (clip && clip.node->is_list())
        clip.mismatch("a mix of clips is a map, or a list of layers right under animation");
    else if (clip)
        read_clip_name(clip, times);
    layers.push_back(std::move(times));
}

}  // namespace

std::vector<ClipLayer> read_animation(const Section& scene) {
    const Field field = scene["animation"];
    std::vector<ClipLayer> layers;
    if (!field) return {ClipLayer{}};
    if (!field.node->is_list()) {
        const Section section = scene.section("animation");
        if (!section.present()) field.mismatch();
        add_layers(section, layers);
        return layers;
    }
    if (field.node->items.empty()) field.mismatch("write { clip: none } for no animation");
    for (std::size_t i = 0; i < field.node->items.size(); ++i) {
        const YamlNode& item = field.node->items[i];
        const std::string name = fmt::format("{}.{}", field.name, i);
        if (!item.is_map())
            field.with(item, name).error(fmt::format("{} is {}", name, shown_value(item)), "expected a map such as { clip: Walk, weight: 0.3 }");
        else
            add_layers(Section(*field.context, &item, "scenes.animation", name), layers);
    }
    return layers;
}

}  // namespace kadr
