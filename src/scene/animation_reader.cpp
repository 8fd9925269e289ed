#include "scene/animation_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>

#include "scene/accessor.h"
#include "scene/deformation_reader.h"
#include "scene/pointer_target.h"

namespace kadr {

namespace {

struct Samples {
    std::vector<float> times, values;
    Interpolation interpolation = Interpolation::linear;
};

Interpolation interpolation_of(const std::string& name) {
    if (name == "STEP") return Interpolation::step;
    return name == "CUBICSPLINE" ? Interpolation::cubic : Interpolation::linear;
}

/// One animation sampler, checked.
class SamplerReader {
public:
    SamplerReader(const GltfDocument& document, std::size_t animation, std::size_t sampler)
        : document_(document), sampler_(document.model().animations[animation].samplers[sampler]),
          pointer_(fmt::format("/animations/{}/samplers/{}", animation, sampler)) {}

    /// @param components  of an element of the output
    /// @param per_key     elements for each key: the number of morph targets, else 1
    Samples read(int components, std::size_t per_key = 1) const {
        Samples samples;
        samples.interpolation = interpolation_of(sampler_.interpolation);
        samples.times = read_times();
        samples.values = read_values(components, per_key, samples);
        return samples;
    }

    /// Booleans: 0 and 1, in steps.  Source: KHR_animation_pointer, "Output Accessor Component Types".
    Samples read_switches() const {
        if (sampler_.interpolation != "STEP")
            document_.fail(pointer_ + "/interpolation", fmt::format("is {}", sampler_.interpolation), "expected STEP: what is true or false only jumps");
        const tinygltf::Accessor& output = accessor(sampler_.output);
        if (output.type != TINYGLTF_TYPE_SCALAR || output.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || output.normalized)
            document_.fail(pointer_ + "/output", "is " + describe_accessor(output), "expected SCALAR of unsigned byte: 0 or 1");
        Samples samples{read_times(), read_floats(document_, sampler_.output), Interpolation::step};
        if (samples.values.size() != samples.times.size())
            document_.fail(pointer_ + "/output", fmt::format("has {} elements for {} times", samples.values.size(), samples.times.size()), fmt::format("expected {}", samples.times.size()));
        for (float& value : samples.values) value = value != 0 ? 1.0f : 0.0f;
        return samples;
    }

private:
    const tinygltf::Accessor& accessor(int index) const { return document_.model().accessors[static_cast<std::size_t>(index)]; }

    std::vector<float> read_times() const {
        const tinygltf::Accessor& input = accessor(sampler_.input);
        if (input.type != TINYGLTF_TYPE_SCALAR || input.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
            document_.fail(pointer_ + "/input", "is " + describe_accessor(input), "expected SCALAR of float: seconds");
        std::vector<float> times = read_floats(document_, sampler_.input);
        for (std::size_t i = 0; i < times.size(); ++i) {
            if (!std::isfinite(times[i])) document_.fail(pointer_ + "/input", fmt::format("element {} is not finite", i), "expected seconds");
            if (i > 0 && times[i] <= times[i - 1])
                document_.fail(pointer_ + "/input", fmt::format("element {} is {} s after {} s", i, times[i], times[i - 1]), "expected strictly increasing times");
        }
        return times;
    }

    std::vector<float> read_values(int components, std::size_t per_key, const Samples& samples) const {
        const tinygltf::Accessor& output = accessor(sampler_.output);
        const int expected_type = components == 1 ? TINYGLTF_TYPE_SCALAR : components == 2 ? TINYGLTF_TYPE_VEC2 : components == 3 ? TINYGLTF_TYPE_VEC3 : TINYGLTF_TYPE_VEC4;
        const bool number = output.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT ||
                            (output.normalized && output.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
        if (output.type != expected_type || !number)
            document_.fail(pointer_ + "/output", "is " + describe_accessor(output),
                           components == 1 ? "expected SCALAR of float or of normalized integers" : fmt::format("expected VEC{} of float or of normalized integers", components));
        const std::size_t keys = samples.times.size(), expected = per_key * (samples.interpolation == Interpolation::cubic ? 3 * keys : keys);
        if (output.count != expected)
            document_.fail(pointer_ + "/output", fmt::format("has {} elements for {} times", output.count, keys), fmt::format("expected {}", expected));
        std::vector<float> values = read_floats(document_, sampler_.output);
        const auto bad = std::find_if(values.begin(), values.end(), [](float f) { return !std::isfinite(f); });
        if (bad != values.end())
            document_.fail(pointer_ + "/output", fmt::format("element {} is not finite", (bad - values.begin()) / components), "expected finite numbers");
        return values;
    }

    const GltfDocument& document_;
    const tinygltf::AnimationSampler& sampler_;
    std::string pointer_;
};

double value_at(const float* v, double) { return v[0]; }
glm::dvec2 value_at(const float* v, glm::dvec2) { return {v[0], v[1]}; }
glm::dvec3 value_at(const float* v, glm::dvec3) { return {v[0], v[1], v[2]}; }
glm::dquat value_at(const float* v, glm::dquat) { return {v[3], v[0], v[1], v[2]}; }

/// @param components  of an element of the sampler; @param first  of them that the track takes
template <class T>
Track<T> make_track(const Samples& samples, std::size_t components, std::size_t first = 0) {
    Track<T> track;
    track.interpolation = samples.interpolation;
    const bool cubic = samples.interpolation == Interpolation::cubic;
    for (std::size_t i = 0; i < samples.times.size(); ++i) {
        Key<T> key;
        key.time_s = samples.times[i];
        const float* values = &samples.values[i * components * (cubic ? 3 : 1)] + first;
        key.value = value_at(cubic ? values + components : values, T{});
        if (cubic) {
            key.in_tangent = value_at(values, T{});
            key.out_tangent = value_at(values + 2 * components, T{});
        }
        track.keys.push_back(std::move(key));
    }
    return track;
}

/// Weights of `count` morph targets: key after key, and within a cubic key in-tangents, values, out-tangents (3.11).
std::vector<Track<double>> weight_tracks(const Samples& samples, std::size_t count) {
    const bool cubic = samples.interpolation == Interpolation::cubic;
    std::vector<Track<double>> tracks(count);
    for (std::size_t target = 0; target < count; ++target) {
        tracks[target].interpolation = samples.interpolation;
        for (std::size_t i = 0; i < samples.times.size(); ++i) {
            const float* values = &samples.values[i * count * (cubic ? 3 : 1) + target];
            Key<double> key;
            key.time_s = samples.times[i];
            key.value = values[cubic ? count : 0];
            if (cubic) {
                key.in_tangent = values[0];
                key.out_tangent = values[2 * count];
            }
            tracks[target].keys.push_back(std::move(key));
        }
    }
    return tracks;
}

class AnimationReader {
public:
    /// @param unknown  takes pointers to what Kadr does not animate
    AnimationReader(GltfDocument& document, std::size_t index, std::vector<std::string>& unknown)
        : document_(document), source_(document.model().animations[index]), index_(index), unknown_(unknown) {
        clip_.name = source_.name;
        clip_.begin_s = std::numeric_limits<double>::infinity();
        clip_.end_s = -clip_.begin_s;
    }

    Clip read() {
        // From the JSON: tinygltf leaves out channels that name no node.
        const nlohmann::json& channels = document_.json()["animations"][index_]["channels"];
        clip_.channel_count = static_cast<int>(channels.size());
        for (std::size_t i = 0; i < channels.size(); ++i) channel(i, channels[i]);
        if (clip_.begin_s > clip_.end_s) clip_.begin_s = clip_.end_s = 0;
        return std::move(clip_);
    }

private:
    std::string pointer(std::size_t channel) const { return fmt::format("/animations/{}/channels/{}", index_, channel); }

    void warn(std::size_t channel, const std::string& found) {
        document_.warnings.push_back(document_.warning(pointer(channel), found + " and is ignored"));
    }

    void channel(std::size_t i, const nlohmann::json& json) {
        const nlohmann::json& target = json["target"];
        tinygltf::AnimationChannel channel;
        channel.sampler = json["sampler"].get<int>();
        channel.target_node = target.contains("node") ? target["node"].get<int>() : -1;
        channel.target_path = target["path"].get<std::string>();
        const std::string& path = channel.target_path;
        if (static_cast<std::size_t>(channel.sampler) >= source_.samplers.size())
            document_.fail(pointer(i) + "/sampler", fmt::format("is {}", channel.sampler), fmt::format("expected an index into the animation's {} samplers", source_.samplers.size()));
        if (path == "pointer" && !follow_pointer(i, target, channel)) return;
        if (path != "weights" && path != "translation" && path != "rotation" && path != "scale")
            document_.fail(pointer(i) + "/target/path", fmt::format("is \"{}\"", path.substr(0, 60)), "expected one of: translation rotation scale weights");
        if (channel.target_node < 0) return warn(i, "names no node");
        if (path == "weights") return add_weights(i, channel);
        add(i, channel);
    }

    void add_weights(std::size_t i, const tinygltf::AnimationChannel& channel) {
        const int mesh = document_.model().nodes[static_cast<std::size_t>(channel.target_node)].mesh;
        const std::size_t count = mesh < 0 ? 0 : target_count(document_.model().meshes[static_cast<std::size_t>(mesh)]);
        if (count == 0) return warn(i, "animates morph weights of a node without morph targets");
        NodeChannels& node = channels_of(channel.target_node);
        if (!node.weights.empty())
            document_.fail(pointer(i) + "/target", fmt::format("animates weights of node {} again", channel.target_node), "expected one channel for each property");
        const Samples samples = SamplerReader(document_, index_, static_cast<std::size_t>(channel.sampler)).read(1, count);
        extend(samples);
        node.weights = weight_tracks(samples, count);
    }

    void extend(const Samples& samples) {
        clip_.begin_s = std::min<double>(clip_.begin_s, samples.times.front());
        clip_.end_s = std::max<double>(clip_.end_s, samples.times.back());
    }

    /// @return whether the pointer names a node's own transform or weights, which `channel` then names itself
    bool follow_pointer(std::size_t i, const nlohmann::json& target, tinygltf::AnimationChannel& channel) {
        const std::string where = pointer(i) + "/target/extensions/KHR_animation_pointer/pointer";
        static const nlohmann::json::json_pointer kMember("/extensions/KHR_animation_pointer/pointer");
        if (!target.contains(kMember)) document_.fail(where, "is missing", "expected a JSON pointer: the channel's path is \"pointer\"");
        if (channel.target_node >= 0) document_.fail(pointer(i) + "/target/node", "is given beside a pointer", "expected one of the two");
        const std::string text = target[kMember].get<std::string>();
        const std::optional<PointerTarget> found = parse_pointer(document_, text, where);
        if (!found) unknown_.push_back(text);
        else if (found->node < 0) add_property(i, channel.sampler, *found, text);
        if (!found || found->node < 0) return false;
        channel.target_node = found->node;
        channel.target_path = found->node_path;
        return true;
    }

    void add_property(std::size_t i, int sampler, const PointerTarget& target, const std::string& text) {
        for (const PropertyChannel& earlier : clip_.properties)
            if (earlier.property == target.property && earlier.index == target.index && earlier.use == target.use)
                document_.fail(pointer(i) + "/target", fmt::format("animates {} again", text), "expected one channel for each property");
        const SamplerReader reader(document_, index_, static_cast<std::size_t>(sampler));
        const Samples samples = target.is_switch ? reader.read_switches() : reader.read(target.components);
        extend(samples);
        const auto components = static_cast<std::size_t>(target.components);
        PropertyChannel channel{target.property, target.index, target.use, {}};
        if (components == 1) channel.track = make_track<double>(samples, 1);
        else if (components == 2) channel.track = make_track<glm::dvec2>(samples, 2);
        else channel.track = make_track<glm::dvec3>(samples, components);
        clip_.properties.push_back(std::move(channel));
        if (target.property == Property::base_color) clip_.properties.push_back({Property::alpha, target.index, target.use, make_track<double>(samples, 4, 3)});
    }

    void add(std::size_t i, const tinygltf::AnimationChannel& channel) {
        if (!document_.model().nodes[static_cast<std::size_t>(channel.target_node)].matrix.empty())
            document_.fail(pointer(i) + "/target/node", fmt::format("is {}, a node with a matrix", channel.target_node), "expected a node with translation, rotation and scale");
        NodeChannels& node = channels_of(channel.target_node);
        const bool rotation = channel.target_path == "rotation";
        const bool taken = rotation ? node.rotation.has_value() : channel.target_path == "scale" ? node.scale.has_value() : node.translation.has_value();
        if (taken)
            document_.fail(pointer(i) + "/target", fmt::format("animates {} of node {} again", channel.target_path, channel.target_node), "expected one channel for each property");
        const Samples samples = SamplerReader(document_, index_, static_cast<std::size_t>(channel.sampler)).read(rotation ? 4 : 3);
        extend(samples);
        if (rotation) node.rotation = rotation_track(i, samples);
        else if (channel.target_path == "scale") node.scale = make_track<glm::dvec3>(samples, 3);
        else node.translation = make_track<glm::dvec3>(samples, 3);
    }

    Track<glm::dquat> rotation_track(std::size_t channel, const Samples& samples) const {
        Track<glm::dquat> track = make_track<glm::dquat>(samples, 4);
        for (std::size_t i = 0; i < track.keys.size(); ++i) {
            const double length = glm::length(track.keys[i].value);
            if (!(length > 1e-6)) document_.fail(pointer(channel), fmt::format("rotates by key {}, a quaternion of length 0", i), "expected unit quaternions");
            if (samples.interpolation != Interpolation::cubic) track.keys[i].value /= length;  // tangents belong to the value as it is
        }
        return track;
    }

    NodeChannels& channels_of(int node) {
        const auto [place, added] = place_of_.try_emplace(node, clip_.channels.size());
        if (added) clip_.channels.emplace_back().node = node;
        return clip_.channels[place->second];
    }

    GltfDocument& document_;
    const tinygltf::Animation& source_;
    std::size_t index_;
    Clip clip_;
    std::map<int, std::size_t> place_of_;
    std::vector<std::string>& unknown_;
};

/// A clip that nothing plays.
Clip named_clip(const GltfDocument& document, std::size_t index) {
    Clip clip;
    clip.name = document.model().animations[index].name;
    clip.channel_count = static_cast<int>(document.json()["animations"][index]["channels"].size());
    clip.read = false;
    return clip;
}

/// One warning for a file, however many of its pointers name what Kadr does not animate.
void warn_of_pointers(GltfDocument& document, std::vector<std::string> pointers) {
    constexpr std::size_t kMostListed = 6;
    std::sort(pointers.begin(), pointers.end());
    pointers.erase(std::unique(pointers.begin(), pointers.end()), pointers.end());
    if (pointers.empty()) return;
    const std::size_t more = pointers.size() - std::min(pointers.size(), kMostListed);
    pointers.resize(pointers.size() - more);
    document.warnings.push_back(document.warning(
        "/animations", fmt::format("point to {}{}, which Kadr does not animate", fmt::join(pointers, ", "), more ? fmt::format(" and {} more", more) : "")));
}

}  // namespace

std::vector<Clip> read_animations(GltfDocument& document, const ClipChoice& choice) {
    std::vector<Clip> clips;
    std::vector<std::string> unknown;
    for (std::size_t i = 0; i < document.model().animations.size(); ++i)
        clips.push_back(choice.holds(document.model().animations[i].name, static_cast<int>(i)) ? AnimationReader(document, i, unknown).read() : named_clip(document, i));
    warn_of_pointers(document, std::move(unknown));
    return clips;
}

}  // namespace kadr
