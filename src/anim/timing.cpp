#include "anim/timing.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"

namespace kadr {

namespace {

__extension__ using Wide = __int128;

constexpr int kLargestFrame = 10'000'000;
constexpr double kLongestSeconds = 8e6;  // what exact_seconds holds: 2^63 * 2^-40
constexpr std::size_t kMostFrames = 1'000'000;
constexpr std::string_view kFrameListForm = R"(expected frames as "0-95", "0-95x2" (every second one) or "5,9,12-20")";

Wide magnitude(Wide value) { return value < 0 ? -value : value; }

Wide common_divisor(Wide a, Wide b) {
    while (b != 0) std::swap(a %= b, b);
    return a;
}

/// Lowest terms from the products of 64-bit numbers, which always fit 128 bits.
Rational reduce(Wide numerator, Wide denominator) {
    if (denominator == 0) throw std::overflow_error("a fraction with the denominator 0");
    if (denominator < 0) numerator = -numerator, denominator = -denominator;
    const Wide divisor = common_divisor(magnitude(numerator), denominator);
    numerator /= divisor;
    denominator /= divisor;
    constexpr Wide largest = std::numeric_limits<std::int64_t>::max();
    if (magnitude(numerator) > largest || denominator > largest)
        throw std::overflow_error("a fraction that 64 bits do not hold");
    return {static_cast<std::int64_t>(numerator), static_cast<std::int64_t>(denominator)};
}

/// (frames + offset) / fps + seconds, rounded once: 80-bit floats hold every frame number and offset that is used in
/// practice.
double seconds_at(std::int64_t frames, double offset, Rational fps, double seconds) {
    const long double exact_frames = static_cast<long double>(frames) + static_cast<long double>(offset);
    return static_cast<double>(exact_frames * static_cast<long double>(fps.denominator) / static_cast<long double>(fps.numerator) + static_cast<long double>(seconds));
}

double closing_s(const Shutter& shutter) { return shutter.close_s + shutter.rolling.duration_s; }

/// A double is a fraction already; digits finer than 2^-40 s (a picosecond) are dropped where 64 bits do not hold them.
Rational exact_seconds(double seconds) {
    constexpr int kFinest = 40;
    const double scaled = std::ldexp(seconds, kFinest);
    return make_rational(static_cast<std::int64_t>(std::llround(scaled)), std::int64_t{1} << kFinest);
}

struct FrameRange {
    int first = 0, last = 0, step = 1;
};

[[noreturn]] void refuse(std::string_view list, std::string found) {
    throw InputError(fmt::format("frames \"{}\": {}", list, found), std::string(kFrameListForm));
}

std::string_view trimmed(std::string_view text) {
    const auto begin = text.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// Takes a whole number off the front of `text`; a sign belongs to it.
int take_number(std::string_view list, std::string_view part, std::string_view& text) {
    int value = 0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failed == std::errc::invalid_argument) refuse(list, fmt::format("'{}' is not a frame or a range", part));
    if (failed != std::errc{} || value > kLargestFrame || value < -kLargestFrame)
        refuse(list, fmt::format("'{}' is beyond \u00b1{} frames", part, kLargestFrame));
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
}

FrameRange parse_range(std::string_view list, std::string_view part) {
    std::string_view rest = part;
    FrameRange range;
    range.first = range.last = take_number(list, part, rest);
    if (rest.starts_with('-')) {
        rest.remove_prefix(1);
        range.last = take_number(list, part, rest);
        if (rest.starts_with('x')) {
            rest.remove_prefix(1);
            range.step = take_number(list, part, rest);
        }
    }
    if (!rest.empty()) refuse(list, fmt::format("'{}' is not a frame or a range", part));
    if (range.last < range.first)
        refuse(list, fmt::format("'{}' runs backwards; write {}-{}", part, range.last, range.first));
    if (range.step < 1) refuse(list, fmt::format("'{}' has the step {}; use 1 or more", part, range.step));
    return range;
}

}  // namespace

Rational make_rational(std::int64_t numerator, std::int64_t denominator) { return reduce(numerator, denominator); }

Rational operator*(Rational a, Rational b) {
    return reduce(Wide{a.numerator} * b.numerator, Wide{a.denominator} * b.denominator);
}

Rational operator/(Rational a, Rational b) {
    return reduce(Wide{a.numerator} * b.denominator, Wide{a.denominator} * b.numerator);
}

Rational operator+(Rational a, Rational b) {
    // Over the least common denominator, the sum of two 64-bit fractions stays within 128 bits.
    const std::int64_t divisor = std::gcd(a.denominator, b.denominator);
    const std::int64_t a_scale = b.denominator / divisor, b_scale = a.denominator / divisor;
    return reduce(Wide{a.numerator} * a_scale + Wide{b.numerator} * b_scale, Wide{a.denominator} * a_scale);
}

Sequence::Sequence(Timing timing, Shutter shutter) : timing_(std::move(timing)), shutter_(std::move(shutter)) {}

FrameTime Sequence::frame(int number) const {
    const std::int64_t frames = std::int64_t{number} - timing_.first;
    FrameTime result;
    result.number = number;
    result.time = make_rational(frames, 1) / timing_.fps;
    result.open_s = seconds_at(frames, shutter_.open_frames, timing_.fps, shutter_.open_s);
    result.close_s = seconds_at(frames, shutter_.close_frames, timing_.fps, closing_s(shutter_));
    return result;
}

FrameTime Sequence::at_time(double seconds) const {
    const double frames = seconds * timing_.fps.value();
    if (!(std::abs(frames) <= kLargestFrame) || !(std::abs(seconds) <= kLongestSeconds))
        throw InputError(fmt::format("the time {} s is beyond \u00b1{} frames or \u00b1{} s", format_number(seconds), kLargestFrame, kLongestSeconds));
    FrameTime result;
    result.number = timing_.first + static_cast<int>(std::llround(frames));
    result.time = exact_seconds(seconds);
    result.open_s = seconds + seconds_at(0, shutter_.open_frames, timing_.fps, shutter_.open_s);
    result.close_s = seconds + seconds_at(0, shutter_.close_frames, timing_.fps, closing_s(shutter_));
    return result;
}

std::vector<int> parse_frame_list(std::string_view text) {
    std::vector<int> frames;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t comma = std::min(text.find(',', begin), text.size());
        const std::string_view part = trimmed(text.substr(begin, comma - begin));
        if (part.empty()) refuse(text, trimmed(text).empty() ? "it is empty" : "there is nothing between two commas");
        const FrameRange range = parse_range(text, part);
        const std::size_t count = static_cast<std::size_t>(range.last - range.first) / static_cast<std::size_t>(range.step) + 1;
        if (frames.size() + count > kMostFrames) refuse(text, fmt::format("more than {} frames", kMostFrames));
        for (std::size_t i = 0; i < count; ++i) frames.push_back(range.first + static_cast<int>(i) * range.step);
        begin = comma + 1;
    }
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    return frames;
}

}  // namespace kadr
