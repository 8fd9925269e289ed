#include "shot/units.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

namespace kadr {

namespace {

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
    return text;
}

bool has_digit_soon(std::string_view text) {
    if (!text.empty() && text.front() == '-') text.remove_prefix(1);
    if (!text.empty() && text.front() == '.') text.remove_prefix(1);
    return !text.empty() && text.front() >= '0' && text.front() <= '9';
}

/// YAML's and C's spellings of what is no number to compute with.
bool is_not_finite(std::string_view text) {
    if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
    if (!text.empty() && text.front() == '.') text.remove_prefix(1);
    std::string lower(text.substr(0, 9));
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return lower == "inf" || lower == "nan" || lower == "infinity";
}

const UnitSpec* find_unit(std::string_view name, Quantity quantity) {
    for (const UnitSpec& unit : unit_table()) {
        if (unit.quantity == quantity && name == unit.name) return &unit;
    }
    return nullptr;
}

/// Takes "/48" off the front of what follows a time's number, as shutters are labelled.
/// @return false where the denominator is no number above 0
bool divide(const char*& at, const char* end, double& number) {
    if (at == end || *at != '/') return true;
    double divisor = 0;
    const auto [rest, error] = std::from_chars(at + 1, end, divisor);
    if (error != std::errc() || !(divisor > 0) || !std::isfinite(divisor)) return false;
    at = rest;
    number /= divisor;
    return true;
}

ParsedQuantity problem(ParsedQuantity::Problem kind) {
    ParsedQuantity result;
    result.problem = kind;
    return result;
}

}  // namespace

const std::vector<UnitSpec>& unit_table() {
    static const std::vector<UnitSpec> table{
        {"deg", Quantity::angle, std::numbers::pi, 180},
        {"rad", Quantity::angle, 1, 1},
        {"s", Quantity::time, 1, 1},
        {"ms", Quantity::time, 1, 1000},
        {"f", Quantity::time, 1, 1},
        {"m", Quantity::length, 1, 1},
        {"cm", Quantity::length, 1, 100},
        {"mm", Quantity::length, 1, 1000},
        {"km", Quantity::length, 1000, 1},
        {"mm", Quantity::lens, 1, 1},
        {"cm", Quantity::lens, 10, 1},
        {"m", Quantity::lens, 1000, 1},
        {"px", Quantity::pixels, 1, 1},
        {"f", Quantity::frames, 1, 1},
        {"lux", Quantity::illuminance, 1, 1},
        {"lx", Quantity::illuminance, 1, 1},
        {"cd", Quantity::intensity, 1, 1},
        {"nt", Quantity::luminance, 1, 1},
        {"cd/m2", Quantity::luminance, 1, 1},
        {"lm", Quantity::power, 1, 1},
        {"stops", Quantity::stops, 1, 1},
        {"ev", Quantity::stops, 1, 1},
        {"dB", Quantity::gain, 1, 1},
    };
    return table;
}

std::string_view natural_unit(Quantity quantity) {
    for (const UnitSpec& unit : unit_table()) {
        if (unit.quantity == quantity) return unit.name;
    }
    return {};
}

std::string unit_names(Quantity quantity) {
    std::string names;
    for (const UnitSpec& unit : unit_table()) {
        if (unit.quantity != quantity) continue;
        if (!names.empty()) names += ", ";
        names += unit.name;
    }
    return names;
}

double from_natural(Quantity quantity, double value) {
    const UnitSpec* unit = find_unit(natural_unit(quantity), quantity);
    return unit ? value * unit->multiplier / unit->divisor : value;
}

ParsedQuantity parse_quantity(std::string_view text, Quantity quantity) {
    using Problem = ParsedQuantity::Problem;
    text = trimmed(text);
    if (is_not_finite(text)) return problem(Problem::not_finite);
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    if (!has_digit_soon(text)) return problem(Problem::not_a_number);
    double number = 0;
    auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error == std::errc::result_out_of_range) return problem(Problem::out_of_range);
    if (error != std::errc()) return problem(Problem::not_a_number);
    if (quantity == Quantity::time && !divide(end, text.data() + text.size(), number)) return problem(Problem::not_a_number);
    const std::string_view name = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
    ParsedQuantity result;
    result.unit = name;
    const UnitSpec* unit = find_unit(name.empty() ? natural_unit(quantity) : name, quantity);
    if (!name.empty() && !unit) {
        const bool starts_with_letter = name.front() >= 'A';
        const bool is_word =
            starts_with_letter && std::all_of(name.begin(), name.end(), [](char c) {
                return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '/' || c == '2' || c == '%';
            });
        result.problem = is_word ? Problem::wrong_unit : Problem::not_a_number;
        return result;
    }
    result.in_frames = quantity == Quantity::time && name == "f";
    result.value = unit ? number * unit->multiplier / unit->divisor : number;
    if (!std::isfinite(result.value)) return problem(Problem::out_of_range);
    return result;
}

double seconds_of_frames(double frames, Rational fps) {
    return frames * static_cast<double>(fps.denominator) / static_cast<double>(fps.numerator);
}

}  // namespace kadr
