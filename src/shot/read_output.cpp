#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "shot/section_readers.h"

namespace kadr {

namespace {

constexpr const char* kDefaultPattern = "output/{name}/{name}.{frame:04}.png";
constexpr std::array<std::string_view, 3> kImageEndings{".exr", ".png", ".jpg"};
constexpr std::array<std::string_view, 5> kVideoEndings{".mp4", ".mkv", ".mov", ".webm", ".gif"};

/// Highest constant-quality number of each codec, in the order of VideoCodec; 0: the codec has none.
constexpr std::array<int, 7> kHighestCrf{51, 51, 63, 63, 0, 0, 0};

template <std::size_t N>
bool ends_in(const std::filesystem::path& path, const std::array<std::string_view, N>& endings) {
    return std::find(endings.begin(), endings.end(), path.extension().string()) != endings.end();
}

/// A placeholder of a pattern: "{name}", "{frame}", "{frame:04}".
bool is_frame_placeholder(std::string_view inside) {
    if (inside == "frame") return true;
    if (!inside.starts_with("frame:")) return false;
    const std::string_view width = inside.substr(6);
    return !width.empty() && width.size() <= 2 && width.find_first_not_of("0123456789") == std::string_view::npos;
}

const char* expected_placeholders(Placeholders allowed) {
    if (allowed.shot) return "expected {name}, {shot}, {frame} or {frame:04}";
    return allowed.frame ? "expected {name}, {frame} or {frame:04}" : "expected {name}";
}

struct Pattern {
    std::string text;  ///< {name} filled in
    bool has_frame = false;
};

/// Fills {name} in. Reports other braces; `found` names the first bad placeholder.
std::optional<Pattern> fill_pattern(const Field& field, const std::string& text, Placeholders allowed) {
    Pattern pattern;
    for (std::size_t i = 0; i < text.size();) {
        if (text[i] != '{' && text[i] != '}') {
            pattern.text += text[i++];
            continue;
        }
        const std::size_t close = text[i] == '{' ? text.find('}', i) : std::string::npos;
        const std::string inside = close == std::string::npos ? "" : text.substr(i + 1, close - i - 1);
        const bool frame = allowed.frame && is_frame_placeholder(inside);
        const bool shot = allowed.shot && inside == "shot";
        if (inside != "name" && !frame && !shot) {
            field.error(fmt::format("{} has '{}', which is no placeholder", field.name,
                                    text.substr(i, close == std::string::npos ? 1 : close - i + 1)),
                        expected_placeholders(allowed));
            return std::nullopt;
        }
        pattern.text += frame || shot ? text.substr(i, close - i + 1) : field.context->name;
        pattern.has_frame = pattern.has_frame || frame;
        i = close + 1;
    }
    return pattern;
}

std::string absolute_path(const YamlNode& node, const std::string& path) {
    return (node.place.source->folder / path).lexically_normal().string();
}

void read_frame_pattern(const Field& field, bool one_frame, OutputSpec& output) {
    const auto text = read_text(field);
    const auto pattern = text ? fill_pattern(field, *text, {.frame = true}) : std::nullopt;
    if (!pattern) return;
    if (!ends_in(pattern->text, kImageEndings))
        return field.error(fmt::format("{} is '{}'", field.name, *text),
                           "expected a pattern that ends in .exr, .png or .jpg");
    if (!pattern->has_frame && !one_frame) {
        return field.error(fmt::format("{} is '{}', the same file for every frame", field.name, *text),
                           "expected {frame} or {frame:04} in the pattern of a shot with several frames");
    }
    const std::string path = absolute_path(*field.node, pattern->text);
    if (std::find(output.frames.begin(), output.frames.end(), path) != output.frames.end())
        return field.error(fmt::format("{} is '{}', which is already an output", field.name, *text),
                           "give each output a path of its own");
    output.frames.push_back(path);
    output.frames_where.push_back(location_of(field.node->place));
}

void read_patterns(const Field& field, bool one_frame, OutputSpec& output) {
    if (!field) return;
    if (!field.node->is_list()) return read_frame_pattern(field, one_frame, output);
    if (field.node->items.empty()) return field.mismatch();
    for (std::size_t i = 0; i < field.node->items.size(); ++i)
        read_frame_pattern(field.with(field.node->items[i], fmt::format("{}[{}]", field.name, i)), one_frame, output);
}

void read_aovs(const Field& field, OutputSpec& output) {
    if (!field) return;
    if (!field.node->is_list()) {
        if (const auto aov = read_choice<Aov>(field)) output.aovs.push_back(*aov);
        return;
    }
    for (std::size_t i = 0; i < field.node->items.size(); ++i) {
        const Field item = field.with(field.node->items[i], fmt::format("{}[{}]", field.name, i));
        const auto aov = read_choice<Aov>(item);
        if (!aov) continue;
        if (std::find(output.aovs.begin(), output.aovs.end(), *aov) != output.aovs.end())
            item.error(fmt::format("{} is '{}' again", item.name, item.node->text), "expected each layer once");
        else
            output.aovs.push_back(*aov);
    }
}

void read_video_file(const Field& field, VideoSpec& video) {
    const auto text = read_text(field);
    const auto filled = text ? fill_pattern(field, *text, {}) : std::nullopt;
    if (!filled) return;
    video.where = location_of(field.node->place);
    video.file = absolute_path(*field.node, filled->text);
    if (!ends_in(video.file, kVideoEndings))
        field.error(fmt::format("{} is '{}'", field.name, *text),
                    "expected a file that ends in .mp4, .mkv, .mov, .webm or .gif");
}

VideoCodec codec_of(const VideoSpec& video) {
    static const std::map<std::string, VideoCodec> by_ending{
        {".mov", VideoCodec::prores}, {".webm", VideoCodec::vp9}, {".gif", VideoCodec::gif}};
    if (video.codec) return *video.codec;
    const auto found = by_ending.find(video.file.extension().string());
    return found == by_ending.end() ? VideoCodec::h264 : found->second;
}

void read_crf(const Field& field, VideoSpec& video) {
    const auto crf = read_integer(field);
    if (!crf) return;
    const auto codec = static_cast<std::size_t>(codec_of(video));
    const std::string name = choices_of(*find_field("output.video.codec"))[codec].name;
    if (kHighestCrf[codec] == 0)
        return field.error(fmt::format("{} does not apply to {}", field.name, name),
                           "remove the key; crf belongs to h264, h265, av1 and vp9");
    if (*crf > kHighestCrf[codec])
        return field.error(fmt::format("{} is {}", field.name, *crf),
                           fmt::format("expected 0 to {} for {}", kHighestCrf[codec], name));
    video.crf = static_cast<int>(*crf);
}

void read_pixel_format(const Field& field, VideoSpec& video) {
    const auto format = read_text(field);
    if (!format) return;
    const bool word = format->find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
    if (!word)
        return field.error(fmt::format("{} is '{}'", field.name, *format),
                           "expected a name such as yuv420p or yuv422p10le");
    video.pixel_format = *format;
}

/// The default pattern's {name} without a document to point at; read_name refuses names that are no file names.
std::string default_pattern(const std::string& name, const std::filesystem::path& working_folder) {
    std::string pattern = kDefaultPattern;
    for (std::size_t at = pattern.find("{name}"); at != std::string::npos;
         at = pattern.find("{name}", at + name.size()))
        pattern.replace(at, 6, name);
    return (working_folder / pattern).lexically_normal().string();
}

}  // namespace

std::optional<VideoSpec> read_video(const Section& section) {
    const Field field = section["video"];
    if (!field || is_word(field, "none")) return std::nullopt;
    VideoSpec video;
    const Section map = section.section("video");
    read_video_file(map.present() ? map["file"] : field, video);
    video.codec = read_choice<VideoCodec>(map["codec"]);
    read_crf(map["crf"], video);
    read_pixel_format(map["pixel_format"], video);
    return video;
}

void read_png_bits(const Field& field, OutputSpec& output) {
    const auto bits = read_integer(field);
    if (bits && *bits != 8 && *bits != 16)
        return field.error(fmt::format("{} is {}", field.name, *bits), "expected 8 or 16");
    assign(output.png_bits, bits);
}

std::optional<std::string> read_pattern(const Field& field, Placeholders allowed) {
    const auto text = read_text(field);
    const auto filled = text ? fill_pattern(field, *text, allowed) : std::nullopt;
    return filled ? std::optional(absolute_path(*field.node, filled->text)) : std::nullopt;
}

OutputSpec read_output(const Section& shot, bool one_frame, const std::filesystem::path& working_folder) {
    OutputSpec output;
    const Section section = shot.section("output");
    read_patterns(section["frames"], one_frame, output);
    if (!section["frames"]) {
        output.frames.push_back(default_pattern(shot.context().name, working_folder));
        output.frames_where.emplace_back();
    }
    read_aovs(section["aovs"], output);
    read_png_bits(section["png_bits"], output);
    output.video = read_video(section);
    return output;
}

}  // namespace kadr
