#include "render/clip_report.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.h"
#include "frame/bindings.h"

namespace kadr {
namespace {

constexpr std::size_t kMostLines = 200;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Files hold times as floats: six digits are theirs.
std::string seconds(double time_s) { return fmt::format("{:.6g} s", time_s); }

/// The report of one scene of the shot.
class SceneReport {
public:
    SceneReport(const BoundShot& shot, int file)
        : scene_(shot.scene()), spec_(shot.shot().scenes[index(file)]), source_(scene_.files[index(file)]), rig_(shot.bindings().rig), file_(file) {
        for (int node = source_.first_node; node < source_.first_node + source_.node_count; ++node)
            if (rig_.hidden(node) || rig_.pose(node))
                for (int above = node; above >= 0 && lively_.insert(above).second;) above = scene_.nodes[index(above)].parent;
    }

    std::string text() const {
        if (source_.clip_count == 0 && spec_.nodes.empty() && spec_.hide.empty()) return {};
        std::string text = fmt::format("scene {}: {} nodes, {} clips\n", source_.id, source_.node_count, source_.clip_count);
        if (source_.clip_count > 0) text += clip_table();
        for (int layer = 0; layer < rig_.layer_count_of(file_); ++layer) text += layer_line(layer);
        return text + tree();
    }

private:
    const PlayingLayer& layer_at(int layer) const { return rig_.layers()[index(rig_.first_layer_of(file_) + layer)]; }
    std::string clip_name(int clip) const {
        const std::string& name = scene_.clips[index(clip)].name;
        return name.empty() ? fmt::format("#{}", clip - source_.first_clip) : name;
    }

    std::string played_by(int clip) const {
        std::vector<int> layers;
        for (int i = 0; i < rig_.layer_count_of(file_); ++i)
            if (const auto& clips = layer_at(i).clips; std::find(clips.begin(), clips.end(), clip) != clips.end()) layers.push_back(i);
        return layers.empty() ? "-" : fmt::format("{}", fmt::join(layers, ", "));
    }

    std::string clip_table() const {
        std::size_t width = 4;
        for (int clip = source_.first_clip; clip < source_.first_clip + source_.clip_count; ++clip) width = std::max(width, clip_name(clip).size());
        width = std::min<std::size_t>(width, 32);
        std::string text = fmt::format("  clip  {:<{}}  {:>10}  {:>10}  {:>10}  channels  nodes  layers\n", "name", width, "begin", "end", "duration");
        for (int i = 0; i < source_.clip_count; ++i) {
            const Clip& clip = scene_.clips[index(source_.first_clip + i)];
            text += fmt::format("  {:>4}  {:<{}}  {:>10}  {:>10}  {:>10}  {:>8}  {:>5}  {}\n", i, clip_name(source_.first_clip + i).substr(0, width), width, seconds(clip.begin_s),
                                seconds(clip.end_s), seconds(clip.end_s - clip.begin_s), clip.channel_count, clip.channels.size(), played_by(source_.first_clip + i));
        }
        return text;
    }

    std::string weight_text(const Track<double>& weight) const {
        if (weight.is_constant()) return format_number(weight.keys.front().value);
        return fmt::format("{} keys from {} to {}", weight.keys.size(), seconds(weight.keys.front().time_s), seconds(weight.keys.back().time_s));
    }

    std::string layer_line(int i) const {
        constexpr const char* kLoops[] = {"hold", "repeat", "pingpong"};
        const PlayingLayer& layer = layer_at(i);
        std::vector<std::string> names;
        for (const int clip : layer.clips) names.push_back(clip_name(clip));
        if (names.size() > 6) names = {fmt::format("{} clips", names.size())};
        const std::string plays = layer.runs() ? fmt::format("{} to {} at speed {}", seconds(layer.in_s), seconds(layer.out_s), format_number(layer.speed))
                                               : fmt::format("stands at {}", seconds(layer.clip_time(0, 0)));
        return fmt::format("  layer {}: {}, {}, {}, {} of the clip at {} of the shot, first pass over at {}, weight {}\n", i, fmt::join(names, ", "), plays,
                           kLoops[static_cast<int>(layer.loop)], seconds(layer.start_s), seconds(layer.at_s), seconds(layer.end_s()), weight_text(layer.weight));
    }

    template <class T>
    std::string source_of(const LayeredTrack<T>& track, bool by_shot) const {
        if (by_shot) return "shot";
        std::vector<int> layers;
        for (const auto& part : track.parts) layers.push_back(part.layer - rig_.first_layer_of(file_));
        return layers.empty() ? "" : fmt::format("layer {}", fmt::join(layers, ", "));
    }

    /// "translate: layer 0; rotate: shot"
    std::string what_moves(int node) const {
        const NodePose* pose = rig_.pose(node);
        if (!pose) return {};
        const NodeOverride* own = pose->override;
        const std::pair<const char*, std::string> parts[] = {{"translate", source_of(pose->translation, own && own->translates)},
                                                             {"rotate", source_of(pose->rotation, own && own->rotates)},
                                                             {"scale", source_of(pose->scale, own && own->scales)}};
        std::string text;
        for (const auto& [part, source] : parts)
            if (!source.empty()) text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", part, source);
        return text;
    }

    void add_node(int node, std::size_t depth, std::vector<std::pair<std::string, std::string>>& lines) const {
        const std::string& name = scene_.nodes[index(node)].name;
        const std::string label = name.empty() ? fmt::format("#{}", node - source_.first_node) : name;
        const std::string note = rig_.hidden(node) ? "hidden" : what_moves(node);
        lines.emplace_back(std::string(2 * depth + 4, ' ') + label, note);
        if (rig_.hidden(node)) return;
        for (const int child : scene_.nodes[index(node)].children)
            if (lively_.count(child)) add_node(child, depth + 1, lines);
    }

    std::string tree() const {
        std::vector<std::pair<std::string, std::string>> lines;
        for (const int root : source_.roots)
            if (lively_.count(root)) add_node(root, 0, lines);
        std::size_t width = 0;
        for (const auto& line : lines) width = std::max(width, std::min<std::size_t>(line.first.size(), 48));
        std::string text = lines.empty() ? "  no node moves\n" : fmt::format("  what moves, of {} nodes\n", source_.node_count);
        for (std::size_t i = 0; i < std::min(lines.size(), kMostLines); ++i)
            text += lines[i].second.empty() ? lines[i].first + "\n" : fmt::format("{:<{}}  {}\n", lines[i].first, width, lines[i].second);
        if (lines.size() > kMostLines) text += fmt::format("    and {} more\n", lines.size() - kMostLines);
        return text;
    }

    const Scene& scene_;
    const SceneSpec& spec_;
    const SceneFile& source_;
    const NodeRig& rig_;
    int file_;
    std::set<int> lively_;  ///< nodes that move of themselves or are hidden, and those that lead to them
};

}  // namespace

std::string clip_report(const BoundShot& shot) {
    std::string text;
    for (std::size_t file = 0; file < shot.scene().files.size(); ++file) text += SceneReport(shot, static_cast<int>(file)).text();
    return text;
}

}  // namespace kadr
