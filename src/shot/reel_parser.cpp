#include <fmt/format.h>

#include <algorithm>

#include "shot/overrides.h"
#include "shot/reel.h"
#include "shot/section_readers.h"
#include "shot/shot_document.h"

namespace kadr {

namespace {

namespace fs = std::filesystem;

constexpr const char* kMinimal = "expected a reel, at least: kadr-reel: 1, shots: [ a.yaml, b.yaml ]";
constexpr std::string_view kReelPrefix = "reel.";

/// The command line's share of the reel, and of each shot.
struct SplitOverrides {
    ShotOverrides reel, shots;
};

SplitOverrides split(const ShotOverrides& all) {
    SplitOverrides parts;
    for (const auto& [path, value] : all.set) {
        if (path.starts_with(kReelPrefix))
            parts.reel.set.emplace_back(path.substr(kReelPrefix.size()), value);
        else
            parts.shots.set.emplace_back(path, value);
    }
    parts.reel.output = all.output;
    parts.reel.video = all.video;
    parts.reel.width = all.width;
    parts.reel.height = all.height;
    parts.shots.quality = all.quality;
    parts.shots.samples = all.samples;
    parts.shots.max_error = all.max_error;
    parts.shots.time_budget = all.time_budget;
    parts.shots.time_budget_shot = all.time_budget_shot;
    return parts;
}

std::optional<ReelTime> read_time(const Field& field) {
    const auto seconds = read_number(field);
    if (!seconds) return std::nullopt;
    return ReelTime{*seconds, field.node->text, location_of(field.node->place)};
}

std::optional<glm::dvec3> read_color(const Field& field) {
    if (!field) return std::nullopt;
    if (is_word(field, "black")) return glm::dvec3(0);
    if (is_word(field, "white")) return glm::dvec3(1);
    return read_vector3(field);
}

ReelFade read_fade(const Section& entry, const char* key, const char* color_key) {
    ReelFade fade;
    const Field field = entry[key];
    if (!field || is_word(field, "none")) return fade;
    const Section section = entry.section(key);
    assign(fade.duration, read_time(section.present() ? section["duration"] : field));
    if (section.present()) assign(fade.color, read_color(section[color_key]));
    return fade;
}

/// Reads one reel: its own values, and its shots' files.
class ReelReader {
public:
    ReelReader(ReadContext& context, const YamlNode& root, fs::path file, fs::path working_folder,
               const ShotOverrides& for_shots)
        : context_(context),
          root_(context, &root, "reel", ""),
          working_folder_(std::move(working_folder)),
          for_shots_(for_shots) {
        reel_.file = std::move(file);
    }

    Reel read() {
        check_version();
        reel_.name = context_.name = read_name(root_, reel_.file);
        read_shot_files();
        read_picture();
        context_.timing.fps = reel_.fps;
        for (std::size_t i = 0; i < sections_.size(); ++i) read_cuts(i);
        check_joins();
        read_sound();
        read_files();
        return std::move(reel_);
    }

    /// Of the shots' own files; each problem once, however often its shot is in the reel.
    const std::vector<Diagnostic>& shot_errors() const { return shot_errors_; }

private:
    void check_version() {
        const auto version = read_integer(root_["kadr-reel"]);
        if (version && *version != 1)
            root_["kadr-reel"].error(fmt::format("the reel is written in format version {}", *version),
                                     "expected kadr-reel: 1; this Kadr reads version 1");
    }

    void read_shot_files() {
        const Field list = root_["shots"];
        if (!list) return;  // reported as missing
        reel_.where = location_of(list.node->place);
        if (!list.node->is_list() || list.node->items.empty())
            return list.mismatch("for example shots: [ turntable.yaml, { shot: spin.yaml, out: 1 s } ]");
        for (std::size_t i = 0; i < list.node->items.size(); ++i) read_entry(list, i);
    }

    void read_entry(const Field& list, std::size_t index) {
        const YamlNode& node = list.node->items[index];
        const Field item = list.with(node, fmt::format("shots.{}", index));
        reel_.entries.emplace_back();
        if (node.is_scalar()) {  // a bare path
            Field path = item;
            path.spec = find_field("reel.shots.shot");
            sections_.emplace_back(context_, nullptr, "reel.shots", item.name);
            return read_shot_file(path, {});
        }
        sections_.emplace_back(context_, &node, "reel.shots", item.name);
        if (!node.is_map())
            return item.error(fmt::format("{} is {}", item.name, shown_value(node)),
                              "expected a shot file or a map such as { shot: spin.yaml, out: 1 s }");
        read_shot_file(sections_.back()["shot"], sections_.back()["set"]);
    }

    void read_shot_file(const Field& field, const Field& set) {
        const auto path = read_existing_file(field, {".yaml", ".yml"});
        const std::optional<ShotOverrides> overrides = overrides_of(set);
        if (!path || !overrides) return;
        if (is_reel(*path))
            return field.error(fmt::format("{} is '{}', which is a reel", field.name, field.node->text),
                               "expected a shot; a reel cannot hold another: list that one's shots here");
        ReelEntry& entry = reel_.entries.back();
        entry.where = location_of(field.node->place);
        entry.changed = !overrides->nodes.empty();
        try {
            entry.shot = parse_shot(*path, *overrides);
        } catch (const InputError& error) {
            for (const Diagnostic& problem : error.diagnostics()) add_shot_error(problem);
        }
    }

    void add_shot_error(const Diagnostic& problem) {
        const auto same = [&](const Diagnostic& other) { return other.text() == problem.text(); };
        if (std::none_of(shot_errors_.begin(), shot_errors_.end(), same)) shot_errors_.push_back(problem);
    }

    std::optional<ShotOverrides> overrides_of(const Field& set) {
        ShotOverrides overrides = for_shots_;
        if (!set) return overrides;
        if (!set.node->is_map()) {
            set.error(fmt::format("{} is {}", set.name, shown_value(*set.node)),
                      "expected a map of key paths and values such as { render.samples: 16 }");
            return std::nullopt;
        }
        for (const YamlEntry& entry : set.node->entries) overrides.nodes.emplace_back(entry.key, entry.value);
        return overrides;
    }

    void read_picture() {
        const bool any = !reel_.entries.empty() && !reel_.entries.front().shot.file.empty();
        if (any) {
            reel_.fps = reel_.entries.front().shot.timing.fps;
            reel_.image = reel_.entries.front().shot.image;
        }
        if (reel_.fps.numerator == 0) reel_.fps = Timing{}.fps;
        assign(reel_.fps, read_rational(root_["fps"]));
        read_size(root_["size"], reel_.image);
        assign(reel_.bars, read_color(root_["bars"]));
        assign(reel_.blend, read_choice<ReelBlend>(root_["blend"]));
    }

    void read_cuts(std::size_t index) {
        const Section& section = sections_[index];
        ReelEntry& entry = reel_.entries[index];
        // `f` is a frame of the shot in the times of the shot, and one of the reel in durations.
        context_.timing.fps = entry.shot.timing.fps;
        entry.in = read_time(section["in"]);
        entry.out = read_time(section["out"]);
        context_.timing.fps = reel_.fps;
        assign(entry.speed, read_number(section["speed"]));
        assign(entry.hold, read_time(section["hold"]));
        assign(entry.crossfade, read_time(section["crossfade"]));
        entry.fade_in = read_fade(section, "fade_in", "from");
        entry.fade_out = read_fade(section, "fade_out", "to");
        if (entry.in && entry.out && entry.in->seconds >= entry.out->seconds)
            section["out"].error(
                fmt::format("{} is {}, not after {} at {}", section["out"].name, entry.out->written, section["in"].name,
                            entry.in->written),
                "expected an out point after the in point");
    }

    void check_joins() {
        for (std::size_t i = 0; i < sections_.size(); ++i) {
            if (!(reel_.entries[i].crossfade.seconds > 0)) continue;
            if (i + 1 == sections_.size()) {
                sections_[i]["crossfade"].error(
                    fmt::format("{} is {}, but no shot follows", sections_[i]["crossfade"].name,
                                reel_.entries[i].crossfade.written),
                    "remove the key, or use fade_out");
                continue;
            }
            check_fade_at_join(sections_[i], "fade_out", reel_.entries[i].fade_out, sections_[i]["crossfade"].name);
            check_fade_at_join(sections_[i + 1], "fade_in", reel_.entries[i + 1].fade_in,
                               sections_[i]["crossfade"].name);
        }
    }

    static void check_fade_at_join(const Section& section, const char* key, const ReelFade& fade,
                                   const std::string& crossfade) {
        if (fade.duration.seconds > 0)
            section[key].error(fmt::format("{} meets {}", section[key].name, crossfade),
                               "remove one of the two: a shot is mixed with the next one, or fades to a colour");
    }

    void read_sound() {
        const Field field = root_["sound"];
        if (!field || is_word(field, "none")) return;
        SoundSpec sound;
        const Section section = root_.section("sound");
        const Field file = section.present() ? section["file"] : field;
        const auto path = read_existing_file(file, {});
        if (file) sound.where = location_of(file.node->place);
        assign(sound.start_s, read_number(section["start"]));
        assign(sound.offset_s, read_number(section["offset"]));
        assign(sound.gain_db, read_number(section["gain"]));
        assign(sound.fade_in_s, read_number(section["fade_in"]));
        assign(sound.fade_out_s, read_number(section["fade_out"]));
        assign(sound.loop, read_boolean(section["loop"]));
        if (!path) return;
        sound.file = *path;
        reel_.sound = sound;
    }

    void read_files() {
        const Section output = root_.section("output");
        read_own_frames(output["frames"]);
        read_shot_pattern(output["shots"]);
        read_png_bits(output["png_bits"], reel_.output);
        reel_.output.video = read_video(output);
        if (!output["video"]) {
            reel_.output.video.emplace();
            reel_.output.video->file = working_folder_ / fmt::format("output/{}.mp4", reel_.name);
        }
    }

    static bool has_frame(const std::string& pattern) { return pattern.find("{frame") != std::string::npos; }

    void read_own_frames(const Field& field) {
        if (!field || is_word(field, "none")) return;
        const auto pattern = read_pattern(field, {.frame = true});
        if (!pattern) return;
        const std::string ending = fs::path(*pattern).extension().string();
        if (ending != ".png" && ending != ".jpg")
            return field.error(fmt::format("{} is '{}'", field.name, field.node->text),
                               "expected a pattern that ends in .png or .jpg: a reel is display-referred, and the linear "
                               "frames of its shots are theirs");
        if (!has_frame(*pattern))
            return field.error(fmt::format("{} is '{}', the same file for every frame", field.name, field.node->text),
                               "expected {frame} or {frame:04} in the pattern");
        reel_.output.frames.push_back(*pattern);
        reel_.output.frames_where.push_back(location_of(field.node->place));
    }

    void read_shot_pattern(const Field& field) {
        reel_.shot_frames =
            (working_folder_ / fmt::format("output/{}/{{shot}}/{{shot}}.{{frame:04}}.png", reel_.name)).string();
        const auto pattern = read_pattern(field, {.frame = true, .shot = true});
        if (!pattern) return;
        const std::string ending = fs::path(*pattern).extension().string();
        if (ending != ".png" && ending != ".jpg" && ending != ".exr")
            return field.error(fmt::format("{} is '{}'", field.name, field.node->text),
                               "expected a pattern that ends in .exr, .png or .jpg");
        if (!has_frame(*pattern) || pattern->find("{shot}") == std::string::npos)
            return field.error(fmt::format("{} is '{}', the same file for several frames", field.name, field.node->text),
                               "expected both {shot} and {frame} or {frame:04} in the pattern");
        reel_.shot_frames = *pattern;
    }

    ReadContext& context_;
    const Section root_;
    const fs::path working_folder_;
    const ShotOverrides& for_shots_;
    std::vector<Section> sections_;  ///< [entry]; absent for a bare path
    std::vector<Diagnostic> shot_errors_;
    Reel reel_;
};

}  // namespace

bool is_reel(const fs::path& path) {
    try {
        YamlDocument document;
        const YamlSource& source =
            document.add_source(read_document_file(path), path.string(), path.parent_path(), false);
        return parse_yaml(source).find("kadr-reel") != nullptr;
    } catch (const InputError&) {
        return false;
    }
}

Reel parse_reel(const fs::path& path, const ShotOverrides& overrides) {
    const fs::path working_folder = fs::current_path();
    const fs::path file = (working_folder / path).lexically_normal();
    YamlDocument document;
    const YamlSource& source = document.add_source(read_document_file(path), path.string(), file.parent_path(), false);
    document.root = parse_root(source, kMinimal);
    ReadContext context;
    check_duplicates(context.problems, document.root);
    const SplitOverrides parts = split(overrides);
    const std::vector<Diagnostic> unusable = apply_overrides(document, parts.reel, working_folder, "size");
    ReelReader reader(context, document.root, file, working_folder, parts.shots);
    Reel reel = reader.read();
    std::vector<Diagnostic> errors = context.problems.take_errors();
    errors.insert(errors.end(), unusable.begin(), unusable.end());
    errors.insert(errors.end(), reader.shot_errors().begin(), reader.shot_errors().end());
    if (!errors.empty()) throw InputError(std::move(errors));
    reel.warnings = context.problems.take_warnings();
    return reel;
}

}  // namespace kadr
