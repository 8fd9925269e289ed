#include "shot/section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

#include "base/text.h"

namespace kadr {

namespace {

constexpr std::size_t kMostErrors = 100;       // shown
constexpr std::size_t kMostKeptErrors = 1000;  // sorted, to show the first of
constexpr std::size_t kLongestShown = 60;

std::string shortened(const std::string& text) {
    return text.size() <= kLongestShown ? text : text.substr(0, kLongestShown) + "...";
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// "; <advice>" or nothing.
std::string with_advice(std::string expected, std::string_view advice) {
    if (!advice.empty()) expected += fmt::format("; {}", advice);
    return expected;
}

bool in_range(const Field& field, double value) {
    // The smallest positive number may round to 0 in another unit.
    const bool above = field.spec->low == kAboveZero ? value > 0 : value >= from_natural(field.spec->quantity, field.spec->low);
    return above && value <= from_natural(field.spec->quantity, field.spec->high);
}

std::string problem_advice(const Field& field, const ParsedQuantity& parsed) {
    using Problem = ParsedQuantity::Problem;
    const std::string units = unit_names(field.spec->quantity);
    if (parsed.problem == Problem::not_finite) return "infinite numbers and NaN are not allowed";
    if (parsed.problem == Problem::out_of_range) return "the number is too large or too small to be represented";
    if (parsed.problem == Problem::wrong_unit && units.empty())
        return fmt::format("it has no unit, remove '{}'", parsed.unit);
    if (parsed.problem == Problem::wrong_unit)
        return fmt::format("'{}' is not one of its units ({})", parsed.unit, units);
    return {};
}

template <class Vector>
std::optional<Vector> read_vector(const Field& field) {
    constexpr auto kSize = static_cast<std::size_t>(Vector::length());
    if (!field) return std::nullopt;
    if (!field.node->is_list() || field.node->items.size() != kSize) {
        field.mismatch();
        return std::nullopt;
    }
    Vector result(0);
    bool complete = true;
    for (std::size_t i = 0; i < kSize; ++i) {
        const auto component = read_number(field.with(field.node->items[i], fmt::format("{}[{}]", field.name, i)));
        complete = complete && component.has_value();
        if (component) result[static_cast<int>(i)] = *component;
    }
    return complete ? std::optional(result) : std::nullopt;
}

std::string lower_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return extension;
}

std::string did_you_mean_file(const std::filesystem::path& path) {
    constexpr int kMostNames = 10000;
    std::vector<std::string> names;
    std::error_code failed;
    for (std::filesystem::directory_iterator entry(path.parent_path(), failed), end;
         !failed && entry != end && names.size() < kMostNames; entry.increment(failed)) {
        names.push_back(entry->path().filename().string());
    }
    const auto nearest = nearest_name(path.filename().string(), names);
    return nearest ? fmt::format("; did you mean '{}'?", *nearest) : "";
}

}  // namespace

bool Problems::full() const { return errors_.size() >= kMostKeptErrors; }

void Problems::error(const YamlPlace& place, std::string found, std::string expected) {
    if (full()) {
        ++not_kept_;
        return;
    }
    errors_.push_back({place, diagnostic_at(place, std::move(found), std::move(expected))});
}

void Problems::warning(const YamlPlace& place, std::string found, std::string expected) {
    Diagnostic diagnostic = diagnostic_at(place, std::move(found), std::move(expected));
    diagnostic.warning = true;
    warnings_.push_back(std::move(diagnostic));
}

std::vector<Diagnostic> Problems::take_errors() {
    std::stable_sort(errors_.begin(), errors_.end(), [](const Error& a, const Error& b) {
        const bool a_argument = a.place.source && a.place.source->argument,
                   b_argument = b.place.source && b.place.source->argument;
        if (a_argument != b_argument) return b_argument;
        return std::pair(a.place.line, a.place.column) < std::pair(b.place.line, b.place.column);
    });
    // A value that two readers looked at is wrong only once.
    const auto same = [](const Error& a, const Error& b) {
        return a.diagnostic.where == b.diagnostic.where && a.diagnostic.found == b.diagnostic.found;
    };
    errors_.erase(std::unique(errors_.begin(), errors_.end(), same), errors_.end());
    std::vector<Diagnostic> result;
    for (Error& error : errors_) {
        if (result.size() == kMostErrors) break;
        result.push_back(std::move(error.diagnostic));
    }
    if (errors_.size() > kMostErrors) {
        Diagnostic rest;
        rest.found = fmt::format("{} more errors are not shown", errors_.size() - kMostErrors + not_kept_);
        result.push_back(std::move(rest));
    }
    return result;
}

namespace {
/// A track where the format has a constant.
bool is_keyed_constant(const Field& field) {
    return field.node->is_map() && field.node->find("keys") && !(field.spec->forms & kTrack) &&
           !find_field(std::string(field.spec->path) + ".keys");  // unless its own map has keys
}
}  // namespace

void Field::mismatch(std::string_view advice) const { mismatch_with("expected " + expectation(*spec), advice); }

void Field::mismatch_with(std::string expected, std::string_view advice) const {
    if (is_keyed_constant(*this)) advice = "this value cannot change over time";
    // The row's hint is about the range; an advice about this very value says more.
    error(fmt::format("{} is {}", name, shown_value(*node)),
          with_advice(std::move(expected), advice.empty() ? spec->hint : advice));
}

std::string shown_value(const YamlNode& node) {
    if (node.is_list()) return node.items.empty() ? "an empty list" : fmt::format("a list of {}", node.items.size());
    if (node.is_map()) return node.entries.empty() ? "an empty map" : "a map";
    if (node.kind == YamlNode::Kind::null) return "empty";
    return looks_like_number(node) ? shortened(node.text) : fmt::format("'{}'", shortened(node.text));
}

bool looks_like_number(const YamlNode& node) {
    if (!node.is_scalar() || node.quoted || node.text.empty()) return false;
    std::string_view text = node.text;
    if (text.front() == '+' || text.front() == '-') text.remove_prefix(1);
    return !text.empty() && (is_digit(text.front()) || text.front() == '.');
}

Section::Section(ReadContext& context, const YamlNode* node, std::string schema_path, std::string name)
    : context_(&context),
      node_(node && node->is_map() ? node : nullptr),
      schema_path_(std::move(schema_path)),
      name_(std::move(name)) {
    if (!node_) return;
    check_keys();
    check_required();
}

void Section::check_keys() const {
    for (const YamlEntry& entry : node_->entries) check_key(entry);
}

void Section::check_key(const YamlEntry& entry) const {
    const FieldSpec* spec = find_field(path_of(entry.key.text));
    if (!spec) return unknown_key(entry);
    const bool given =
        entry.value.kind != YamlNode::Kind::null && !(entry.value.is_scalar() && entry.value.text == "none");
    if (!spec->built && given) {
        context_->problems.error(
            entry.key.place, fmt::format("{} is not supported yet", name_of(entry.key.text)),
            fmt::format("{} is part of the format, but this version of Kadr cannot do it; remove the key",
                        key_of(*spec)));
    }
}

void Section::unknown_key(const YamlEntry& entry) const {
    if (context_->problems.full()) return context_->problems.error(entry.key.place, {});  // only counted
    std::vector<std::string> names;
    for (const FieldSpec* field : fields_below(schema_path_)) names.emplace_back(key_of(*field));
    const auto nearest = nearest_name(entry.key.text, names);
    const std::string place = name_.empty() ? "" : fmt::format(" in {}", name_);
    context_->problems.error(entry.key.place, fmt::format("unknown key '{}'{}", shortened(entry.key.text), place),
                             nearest ? fmt::format("did you mean '{}'?", *nearest)
                                     : fmt::format("expected one of {}", fmt::join(names, ", ")));
}

void Section::check_required() const {
    for (const FieldSpec* field : fields_below(schema_path_)) {
        if (!field->required || has(key_of(*field))) continue;
        context_->problems.error(node_->place, fmt::format("{} is missing", name_of(key_of(*field))),
                                 fmt::format("add `{}`", field->example));
    }
}

Section Section::section(std::string_view key) const {
    const Field field = (*this)[key];
    constexpr unsigned kOtherForms = ~(kSection | kTrack);
    const bool keyed = field && is_keyed_constant(field);
    if (keyed || (field && !field.node->is_map() && !(field.spec->forms & kOtherForms))) field.mismatch();
    if (keyed) return Section(*context_, nullptr, path_of(key), name_of(key));
    return Section(*context_, field.node, path_of(key), name_of(key));
}

Field Section::operator[](std::string_view key) const {
    const FieldSpec* spec = find_field(path_of(key));
    assert(spec && "a reader asks for a key that the table does not have");
    const YamlNode* value = node_ ? node_->find(key) : nullptr;
    if (value && value->kind == YamlNode::Kind::null) value = nullptr;
    return {context_, value, spec, name_of(key)};
}

bool Section::exclusive(std::string_view one, std::string_view other) const {
    if (!has(one) || !has(other)) return false;
    const YamlPlace a = key_place(one), b = key_place(other);
    const bool one_is_later = std::pair(a.line, a.column) > std::pair(b.line, b.column);
    context_->problems.error(one_is_later ? a : b,
                             fmt::format("{} and {} exclude each other", name_of(one), name_of(other)),
                             "remove one of the two");
    return true;
}

YamlPlace Section::key_place(std::string_view key) const {
    const auto found = std::find_if(node_->entries.begin(), node_->entries.end(),
                                    [&](const YamlEntry& entry) { return entry.key.text == key; });
    return found->key.place;
}

std::optional<double> read_number(const Field& field) {
    if (!field) return std::nullopt;
    if (!field.node->is_scalar() || field.node->quoted) {
        field.mismatch(field.node->is_scalar() ? "remove the quotes" : "");
        return std::nullopt;
    }
    ParsedQuantity parsed = parse_quantity(field.node->text, field.spec->quantity);
    if (parsed.in_frames) parsed.value = seconds_of_frames(parsed.value, field.context->timing.fps);
    if (parsed.problem != ParsedQuantity::Problem::none || !in_range(field, parsed.value)) {
        field.mismatch(problem_advice(field, parsed));
        return std::nullopt;
    }
    return parsed.value;
}

std::optional<std::int64_t> read_integer(const Field& field) {
    if (!field) return std::nullopt;
    std::int64_t value = 0;
    std::string_view text = field.node->text;
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole =
        field.node->is_scalar() && !field.node->quoted && error == std::errc() && end == text.data() + text.size();
    const double limit = static_cast<double>(value);
    if (!whole || limit < field.spec->low || limit > field.spec->high) {
        field.mismatch();
        return std::nullopt;
    }
    return value;
}

std::optional<bool> read_boolean(const Field& field) {
    if (!field) return std::nullopt;
    if (is_word(field, "true")) return true;
    if (is_word(field, "false")) return false;
    field.mismatch();
    return std::nullopt;
}

std::optional<std::string> read_text(const Field& field) {
    if (!field) return std::nullopt;
    if (field.node->is_scalar() && !field.node->text.empty()) return field.node->text;
    field.mismatch();
    return std::nullopt;
}

std::optional<glm::dvec2> read_vector2(const Field& field) { return read_vector<glm::dvec2>(field); }
std::optional<glm::dvec3> read_vector3(const Field& field) { return read_vector<glm::dvec3>(field); }

std::optional<std::filesystem::path> read_path(const Field& field) {
    const auto text = read_text(field);
    if (!text) return std::nullopt;
    return (field.node->place.source->folder / *text).lexically_normal();
}

std::optional<std::filesystem::path> read_existing_file(const Field& field, const std::vector<std::string>& endings) {
    const auto path = read_path(field);
    if (!path) return std::nullopt;
    const bool ending_fits =
        endings.empty() || std::find(endings.begin(), endings.end(), lower_extension(*path)) != endings.end();
    if (!ending_fits) {
        field.error(fmt::format("{} is '{}'", field.name, field.node->text),
                    fmt::format("expected a file that ends in {}", fmt::join(endings, " or ")));
        return std::nullopt;
    }
    std::error_code failed;
    if (std::filesystem::is_regular_file(*path, failed)) return path;
    const bool exists = std::filesystem::exists(*path, failed);
    field.error(
        fmt::format("{} is '{}', which {}", field.name, field.node->text, exists ? "is not a file" : "does not exist"),
        fmt::format("expected a file, looked for as {}{}", path->string(), did_you_mean_file(*path)));
    return std::nullopt;
}

std::optional<int> read_choice_index(const Field& field) {
    if (!field) return std::nullopt;
    const std::vector<Choice> choices = choices_of(*field.spec);
    // An entry of a list is one of the words, not a list again.
    const std::string expected =
        "expected " + (field.spec->forms & kTexts ? choices_text(*field.spec) : expectation(*field.spec));
    std::vector<std::string> names;
    for (const Choice& choice : choices) {
        names.push_back(choice.name);
        if (!field.node->is_scalar() || field.node->text != choice.name) continue;
        if (choice.built) return static_cast<int>(names.size()) - 1;
        field.error(fmt::format("{}: {} is not supported yet", field.name, choice.name), expected);
        return std::nullopt;
    }
    if (choices.size() == 1 && field.spec->forms == kChoice) {
        field.error(fmt::format("{} other than {} is not supported yet", field.name, names.front()),
                    fmt::format("expected {}", names.front()));
        return std::nullopt;
    }
    const auto nearest = field.node->is_scalar() ? nearest_name(field.node->text, names) : std::nullopt;
    field.mismatch_with(expected, nearest ? fmt::format("did you mean '{}'?", *nearest) : "");
    return std::nullopt;
}

bool is_word(const Field& field, std::string_view word) {
    return field && field.node->is_scalar() && !field.node->quoted && field.node->text == word;
}

}  // namespace kadr
