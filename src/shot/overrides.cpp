#include "shot/overrides.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/text.h"
#include "shot/quality.h"
#include "shot/shot_document.h"

namespace kadr {

namespace {

YamlNode scalar_node(const YamlSource& source, std::string text, bool quoted) {
    YamlNode node;
    node.kind = YamlNode::Kind::scalar;
    node.text = std::move(text);
    node.quoted = quoted;
    node.place = {&source, -1, 0, 0};
    return node;
}

YamlNode map_node(const YamlPlace& place) {
    YamlNode node;
    node.kind = YamlNode::Kind::map;
    node.place = place;
    return node;
}

std::vector<std::string> split_path(const std::string& path) {
    std::vector<std::string> parts(1);
    for (const char c : path) {
        if (c == '.')
            parts.emplace_back();
        else
            parts.back() += c;
    }
    return parts;
}

/// Entry of a list by its index or by its id.
YamlNode* find_item(YamlNode& list, const std::string& part) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
    if (error == std::errc() && end == part.data() + part.size())
        return index < list.items.size() ? &list.items[index] : nullptr;
    for (YamlNode& item : list.items) {
        const YamlNode* id = item.find("id");
        if (id && id->text == part) return &item;
    }
    return nullptr;
}

YamlEntry* find_entry(YamlNode& map, const std::string& key) {
    const auto found = std::find_if(map.entries.begin(), map.entries.end(),
                                    [&](const YamlEntry& entry) { return entry.key.text == key; });
    return found == map.entries.end() ? nullptr : &*found;
}

std::string item_names(const YamlNode& list) {
    std::string names;
    for (std::size_t i = 0; i < list.items.size(); ++i) {
        const YamlNode* id = list.items[i].find("id");
        names += fmt::format("{}{}", i == 0 ? "" : ", ", id ? id->text : std::to_string(i));
    }
    return names.empty() ? "none" : names;
}

/// One key path of the command line laid over the document.
class Override {
public:
    /// @param place  of the path, for messages
    Override(const YamlPlace& place, std::string path)
        : place_(place), path_(std::move(path)), parts_(split_path(path_)) {}

    std::optional<Diagnostic> put(YamlNode& root, YamlNode value) {
        if (std::any_of(parts_.begin(), parts_.end(), [](const std::string& part) { return part.empty(); })) {
            return diagnostic_at(place_, fmt::format("'{}' is not a key path", path_),
                                 "expected a path such as render.samples or lights.key.intensity");
        }
        YamlNode* node = &root;
        for (const std::string& part : parts_) {
            node = descend(*node, part);
            if (!node) return problem_;
        }
        *node = std::move(value);
        return std::nullopt;
    }

private:
    /// The value under one part of the path; made where a map does not have it yet.
    YamlNode* descend(YamlNode& node, const std::string& part) {
        if (node.kind == YamlNode::Kind::null) node = map_node(place_);
        if (node.is_list()) {
            YamlNode* item = find_item(node, part);
            if (!item)
                problem_ = diagnostic_at(place_, fmt::format("there is no entry '{}'", part),
                                         fmt::format("the list has: {}", item_names(node)));
            return item;
        }
        if (!node.is_map()) {
            problem_ =
                diagnostic_at(place_, fmt::format("'{}' is below '{}', which is not a section here", part, node.text),
                           "set the whole value instead, for example --set 'render.seed={ value: 7, animated: true }'");
            return nullptr;
        }
        if (YamlEntry* entry = find_entry(node, part)) return &entry->value;
        YamlNode key = scalar_node(*place_.source, part, false);
        key.place = place_;
        node.entries.push_back({std::move(key), {}});
        return &node.entries.back().value;
    }

    const YamlPlace place_;
    std::string path_;
    std::vector<std::string> parts_;
    std::optional<Diagnostic> problem_;
};

class Overrides {
public:
    /// @param prefix  what the command line has before the key paths of this document
    Overrides(YamlDocument& document, std::filesystem::path folder, std::string_view prefix) : document_(document), folder_(std::move(folder)), prefix_(prefix) {}

    void set(const std::string& path, const std::string& value) {
        const YamlSource& source = document_.add_source(value, fmt::format("--set {}{}={}", prefix_, path, value), folder_, true);
        try {
            YamlNode node = parse_yaml(source);
            Problems duplicates;
            check_duplicates(duplicates, node);
            for (Diagnostic& problem : duplicates.take_errors()) problems_.push_back(std::move(problem));
            put(source, path, std::move(node));
        } catch (const InputError& error) {
            problems_.insert(problems_.end(), error.diagnostics().begin(), error.diagnostics().end());
        }
    }
    void put_node(const YamlNode& path, YamlNode value) {
        if (value.kind == YamlNode::Kind::null) value.place = path.place;
        if (auto problem = Override(path.place, path.text).put(document_.root, std::move(value)))
            problems_.push_back(std::move(*problem));
    }
    /// A value that is taken as it is typed, not as YAML.
    void put_text(std::string_view option, const std::string& path, const std::string& value, bool quoted) {
        const YamlSource& source = argument(option, value);
        put(source, path, scalar_node(source, value, quoted));
    }
    void put_size(const char* key, int width, int height) {
        const YamlSource& source = argument("--size", fmt::format("{}x{}", width, height));
        YamlNode list;
        list.kind = YamlNode::Kind::list;
        list.place = {&source, -1, 0, 0};
        for (const int side : {width, height}) list.items.push_back(scalar_node(source, std::to_string(side), false));
        put(source, key, std::move(list));
    }
    /// The values of a step replace the document's, and its name stands there.
    void put_quality(const std::string& name) {
        put_text("--quality", "render.quality", name, true);
        if (const QualityBlock* block = find_quality(name)) lay_block(*block, true);
    }
    /// The values of the document's own step, where it does not give them.
    void fill_quality() {
        YamlNode* render = find_entry_value(document_.root, "render");
        const YamlNode* name = render ? render->find("quality") : nullptr;
        if (const QualityBlock* block = name && name->is_scalar() ? find_quality(name->text) : nullptr) lay_block(*block, false);
    }
    /// A number of samples, or what decides it. `--max-error` keeps the file's number as the most: it makes a render cheaper,
    /// never dearer. A time budget is there to be used: the number of a file does not end it.
    void put_samples(const ShotOverrides& overrides) {
        const bool steered = !overrides.max_error.empty() || !overrides.time_budget.empty() || !overrides.time_budget_shot.empty();
        const std::string most = overrides.samples > 0 ? std::to_string(overrides.samples) : std::string();
        if (!steered) {
            if (!most.empty()) put_text("--samples", "render.samples", most, false);
            return;
        }
        YamlNode* render = find_entry_value(document_.root, "render");
        YamlNode* samples = render ? find_entry_value(*render, "samples") : nullptr;
        if (samples && !samples->is_map()) {
            const YamlNode number = *samples;
            *samples = map_node(number.place);
            if (most.empty() && overrides.time_budget.empty() && overrides.time_budget_shot.empty()) put_node_at("render.samples.at_most", number);
        }
        if (!most.empty()) put_text("--samples", "render.samples.at_most", most, false);
        if (!overrides.max_error.empty()) put_text("--max-error", "render.samples.max_error", overrides.max_error, false);
        if (!overrides.time_budget_shot.empty())
            put_text("--time-budget-shot", "render.samples.time_budget_shot", overrides.time_budget_shot, false);
        if (!overrides.time_budget.empty()) put_text("--time-budget", "render.samples.time_budget", overrides.time_budget, false);
    }
    /// Replaces the file's video; its codec and quality stay where the new file has the same ending.
    void put_video(const std::string& file) {
        YamlNode* output = &document_.root;
        for (const char* key : {"output", "video"}) {
            YamlEntry* entry = output && output->is_map() ? find_entry(*output, key) : nullptr;
            output = entry ? &entry->value : nullptr;
        }
        const YamlNode* old = output && output->is_map() ? output->find("file") : nullptr;
        const bool same_kind =
            old && std::filesystem::path(old->text).extension() == std::filesystem::path(file).extension();
        put_text("--video", same_kind ? "output.video.file" : "output.video", file, file != "none");
    }
    std::vector<Diagnostic> take_problems() { return std::move(problems_); }

private:
    void lay_block(const QualityBlock& block, bool replaces) {
        for (const auto& [key, value] : block.values) {
            YamlNode* render = find_entry_value(document_.root, "render");
            if (render && render->kind != YamlNode::Kind::null && !render->is_map()) return;  // refused as it stands
            if (!replaces && render && render->find(key)) continue;
            const YamlSource& source = document_.add_source(value, fmt::format("quality {}: {}: {}", block.name, key, value), folder_, true);
            put(source, fmt::format("render.{}", key), parse_yaml(source));
        }
    }
    static YamlNode* find_entry_value(YamlNode& node, const char* key) {
        YamlEntry* entry = node.is_map() ? find_entry(node, key) : nullptr;
        return entry ? &entry->value : nullptr;
    }
    void put_node_at(const std::string& path, YamlNode value) {
        if (auto problem = Override(value.place, path).put(document_.root, std::move(value))) problems_.push_back(std::move(*problem));
    }
    const YamlSource& argument(std::string_view option, const std::string& value) {
        return document_.add_source(value, fmt::format("{} {}", option, value), folder_, true);
    }
    void put(const YamlSource& source, const std::string& path, YamlNode value) {
        if (value.kind == YamlNode::Kind::null) value.place = {&source, -1, 0, 0};
        if (auto problem = Override({&source, -1, 0, 0}, path).put(document_.root, std::move(value)))
            problems_.push_back(std::move(*problem));
    }

    YamlDocument& document_;
    std::filesystem::path folder_;
    std::string_view prefix_;
    std::vector<Diagnostic> problems_;
};

}  // namespace

std::vector<Diagnostic> apply_overrides(YamlDocument& document, const ShotOverrides& overrides,
                                        const std::filesystem::path& working_folder, const char* size_key) {
    const bool is_shot = std::string_view(size_key) == kShotSize;
    Overrides apply(document, working_folder, is_shot ? "" : "reel.");
    for (const auto& [path, value] : overrides.nodes) apply.put_node(path, value);
    if (!overrides.quality.empty()) apply.put_quality(overrides.quality);
    for (const auto& [path, value] : overrides.set) apply.set(path, value);
    if (!overrides.frames.empty()) apply.put_text("--frames", "timing.frames", overrides.frames, true);
    if (!overrides.output.empty()) apply.put_text("--output", "output.frames", overrides.output, true);
    apply.put_samples(overrides);
    if (is_shot) apply.fill_quality();  // a reel has no render section
    if (overrides.width > 0 && overrides.height > 0) apply.put_size(size_key, overrides.width, overrides.height);
    if (!overrides.video.empty()) apply.put_video(overrides.video);
    return apply.take_problems();
}

}  // namespace kadr
