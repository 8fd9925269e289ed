// timing and image.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "shot/section_readers.h"

namespace kadr {

namespace {

std::optional<std::int64_t> parse_whole(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// "24000/1001" or "23.976" as an exact fraction.
std::optional<Rational> parse_rational(std::string_view text) {
    constexpr std::size_t kMostDigits = 9;  // keeps every product with a frame number inside 64 bits
    if (text.size() > 2 * kMostDigits + 1) return std::nullopt;
    if (const std::size_t slash = text.find('/'); slash != std::string_view::npos) {
        const auto above = parse_whole(text.substr(0, slash)), below = parse_whole(text.substr(slash + 1));
        const bool fits = above && below && *above > 0 && *below > 0 && slash <= kMostDigits &&
                          text.size() - slash - 1 <= kMostDigits;
        return fits ? std::optional(make_rational(*above, *below)) : std::nullopt;
    }
    const std::size_t dot = text.find('.');
    const std::string_view decimals = dot == std::string_view::npos ? std::string_view{} : text.substr(dot + 1);
    std::string digits(text.substr(0, dot));
    digits += decimals;
    const auto above = parse_whole(digits);
    if (!above || *above <= 0 || decimals.size() > 6 || digits.size() > kMostDigits || decimals.starts_with('-'))
        return std::nullopt;
    std::int64_t below = 1;
    for (std::size_t i = 0; i < decimals.size(); ++i) below *= 10;
    return make_rational(*above, below);
}

bool is_frame_part(const YamlEntry& entry) {
    const std::string& text = entry.key.text;
    return entry.value.kind == YamlNode::Kind::null && !entry.key.quoted && !text.empty() &&
           text.find_first_not_of("0123456789-x ") == std::string::npos;
}

/// `{ frames: 5,9,12-20 }`: YAML ends the value at the comma and takes the rest for keys without values. Takes those
/// out of the map, so that the list is explained once instead of each rest being an unknown key.
YamlNode without_cut_frames(ReadContext& context, const YamlNode& timing) {
    YamlNode rest = timing;
    const YamlNode* frames = timing.find("frames");
    if (!frames || !frames->is_scalar() || frames->quoted) return rest;
    std::string whole = frames->text;
    for (const YamlEntry& entry : timing.entries) {
        if (is_frame_part(entry)) whole += "," + entry.key.text;
    }
    if (whole == frames->text) return rest;
    std::erase_if(rest.entries, is_frame_part);
    context.problems.error(
        frames->place, fmt::format("timing.frames is cut short: YAML reads {} alone", frames->text),
        fmt::format("inside braces a comma begins the next key; quote the list: frames: \"{}\"", whole));
    return rest;
}

std::string frames_text(const YamlNode& node) {
    if (!node.is_list()) return node.text;
    std::string text;
    for (const YamlNode& item : node.items) text += (text.empty() ? "" : ",") + item.text;
    return text;
}

std::optional<std::vector<int>> read_frames(const Field& field) {
    if (!field) return std::nullopt;
    const bool list_of_scalars = field.node->is_list() && !field.node->items.empty() &&
                                 std::all_of(field.node->items.begin(), field.node->items.end(),
                                             [](const YamlNode& item) { return item.is_scalar(); });
    if (!field.node->is_scalar() && !list_of_scalars) {
        field.mismatch();
        return std::nullopt;
    }
    try {
        return parse_frame_list(frames_text(*field.node));
    } catch (const InputError& error) {
        const Diagnostic& first = error.diagnostics().front();
        const std::string text = frames_text(*field.node), prefix = fmt::format("frames \"{}\": ", text);
        const std::string found = first.found.starts_with(prefix) ? first.found.substr(prefix.size()) : first.found;
        const bool blank = text.find_first_not_of(' ') == std::string::npos;
        field.error(blank ? fmt::format("{} is empty", field.name) : fmt::format("{} is {}: {}", field.name, text, found),
                    first.expected.empty() ? "expected " + expectation(*field.spec) : first.expected);
        return std::nullopt;
    }
}

}  // namespace

std::optional<Rational> read_rational(const Field& field) {
    if (!field) return std::nullopt;
    const bool plain = field.node->is_scalar() && !field.node->quoted;
    const auto value = plain ? parse_rational(field.node->text) : std::nullopt;
    if (value && value->value() <= field.spec->high) return value;
    field.mismatch();
    return std::nullopt;
}

ReadTiming read_timing(const Section& shot) {
    const Field whole = shot["timing"];
    YamlNode cleaned;
    if (whole && whole.node->is_map()) cleaned = without_cut_frames(shot.context(), *whole.node);
    if (whole && !whole.node->is_map()) whole.mismatch();
    const Section section(shot.context(), &cleaned, "timing", "timing");
    ReadTiming result;
    assign(result.timing.fps, read_rational(section["fps"]));
    assign(result.timing.first, read_integer(section["first"]));
    const auto frames = read_frames(section["frames"]);
    assign(result.timing.frames, frames);
    result.frames_given = frames.has_value();
    return result;
}

void read_size(const Field& size, ImageSpec& image) {
    if (!size) return;
    if (!size.node->is_list() || size.node->items.size() != 2) return size.mismatch();
    std::array<int*, 2> sides{&image.width, &image.height};
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const YamlNode& item = size.node->items[i];
        const ParsedQuantity parsed = parse_quantity(item.text, Quantity::pixels);
        const bool whole = item.is_scalar() && !item.quoted && parsed.problem == ParsedQuantity::Problem::none &&
                           parsed.value == static_cast<double>(static_cast<std::int64_t>(parsed.value)) &&
                           parsed.value >= size.spec->low && parsed.value <= size.spec->high;
        if (whole)
            *sides[i] = static_cast<int>(parsed.value);
        else
            size.with(item, fmt::format("{}[{}]", size.name, i)).mismatch();
    }
}

ImageSpec read_image(const Section& shot) {
    const Section section = shot.section("image");
    ImageSpec image;
    assign(image.pixel_aspect, read_number(section["pixel_aspect"]));
    read_choice_index(section["crop"]);
    read_size(section["size"], image);
    return image;
}

}  // namespace kadr
