#include "render/reel_conform.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/text.h"
#include "frame/problem.h"
#include "shot/shot_hash.h"

namespace kadr {
namespace {

/// Nearest whole number, up on a tie.
std::int64_t rounded(Rational value) {
    const std::int64_t twice = 2 * value.numerator + value.denominator, whole = 2 * value.denominator;
    return twice >= 0 ? twice / whole : -((-twice + whole - 1) / whole);
}

std::int64_t frames_of(double seconds, Rational fps) { return std::llround(seconds * fps.value()); }

/// A duration; the longest that the format allows fits.
int length_of(const ReelTime& time, Rational fps) { return static_cast<int>(frames_of(time.seconds, fps)); }

std::string seconds_text(Rational seconds) { return fmt::format("{:.6g} s", seconds.value()); }

/// Where a shot begins and ends, in seconds: exact.
struct Range {
    Rational begin_s, end_s;
};

Range range_of(const Shot& shot, const std::vector<int>& frames) {
    const std::int64_t first = frames.front() - std::int64_t{shot.timing.first};
    const std::int64_t end = frames.back() + std::int64_t{1} - shot.timing.first;
    return {make_rational(first, 1) / shot.timing.fps, make_rational(end, 1) / shot.timing.fps};
}

/// Reads one in or out point.
class PointReader {
public:
    PointReader(const BoundEntry& bound, Rational rate, std::vector<Diagnostic>& problems)
        : bound_(bound), rate_(rate), range_(range_of(bound.entry->shot, bound.frames)), problems_(problems) {}

    /// Frames after 0 s at the rate of the reel. @param last  the latest that is allowed
    std::int64_t read(const char* key, const std::optional<ReelTime>& time, Rational otherwise) {
        if (!time) return rounded(otherwise * rate_);
        const std::int64_t at = frames_of(time->seconds, rate_);
        const bool is_in = std::string_view(key) == "in";
        if (at < rounded(range_.begin_s * rate_))
            refuse(*time, key, fmt::format("before the shot begins at {}", seconds_text(range_.begin_s)));
        else if (at > rounded(range_.end_s * rate_) || (is_in && at == rounded(range_.end_s * rate_)))
            refuse(*time, key, fmt::format("but the shot ends at {}", seconds_text(range_.end_s)));
        return at;
    }
    const Range& range() const { return range_; }

private:
    void refuse(const ReelTime& time, const char* key, const std::string& why) {
        const Timing& timing = bound_.entry->shot.timing;
        problems_.push_back(problem_at(
            time.where, fmt::format("{}.{} is {}, {}", bound_.name, key, time.written, why),
            fmt::format("expected a time from {} to {} (frames {} to {} at {} fps)", seconds_text(range_.begin_s),
                        seconds_text(range_.end_s), bound_.frames.front(), bound_.frames.back(),
                        format_number(timing.fps.value()))));
    }

    const BoundEntry& bound_;
    const Rational rate_;
    const Range range_;
    std::vector<Diagnostic>& problems_;
};

std::string frames_text(int frames) { return frames == 1 ? "1 frame" : fmt::format("{} frames", frames); }

std::string settings_identity(const Shot& shot) {
    Hasher hasher;
    hash_shot(shot, hasher);
    hash_view(shot, hasher);
    for (const SceneSpec& scene : shot.scenes) hasher.add(scene.gltf.string());
    hasher.add(shot.environment.image ? shot.environment.image->string() : std::string());
    hasher.add(shot.file.string());
    for (const std::string& pattern : shot.output.frames) hasher.add(pattern);
    return hasher.finish().hex();
}

}  // namespace

Rational conformed_rate(const Reel& reel, const ReelEntry& entry) {
    // Six decimals of a speed are kept exactly.
    constexpr std::int64_t kMillion = 1'000'000;
    return reel.fps / make_rational(std::llround(entry.speed * kMillion), kMillion);
}

ImageSpec fitted_size(const ImageSpec& shot, const ImageSpec& reel) {
    if (shot == reel) return reel;
    const double shape = shot.width * shot.pixel_aspect / shot.height;  // of the picture as it is seen
    ImageSpec fitted = reel;
    fitted.width = std::clamp(static_cast<int>(std::lround(reel.height * shape / reel.pixel_aspect)), 1, reel.width);
    fitted.height = std::clamp(static_cast<int>(std::lround(reel.width * reel.pixel_aspect / shape)), 1, reel.height);
    return fitted;
}

Cut cut_of(const Reel& reel, const BoundEntry& bound, std::vector<Diagnostic>& problems) {
    const ReelEntry& entry = *bound.entry;
    PointReader points(bound, conformed_rate(reel, entry), problems);
    const std::size_t before = problems.size();
    const std::int64_t in = points.read("in", entry.in, points.range().begin_s);
    const std::int64_t out = points.read("out", entry.out, points.range().end_s);
    if (out <= in && problems.size() == before) {
        const bool whole = !entry.in && !entry.out;
        problems.push_back(problem_at(entry.out ? entry.out->where : entry.in ? entry.in->where : entry.where,
                                      whole ? fmt::format("{} is shorter than a frame of the reel", bound.name)
                                            : fmt::format("nothing is left of {} between its in and its out point", bound.name),
                                      fmt::format("expected at least one frame at {} fps", format_number(reel.fps.value()))));
    }
    Cut cut;
    cut.first = static_cast<int>(in + entry.shot.timing.first);
    cut.count = std::max(1, static_cast<int>(out - in));
    cut.hold = length_of(entry.hold, reel.fps);
    cut.crossfade = length_of(entry.crossfade, reel.fps);
    cut.fade_in = length_of(entry.fade_in.duration, reel.fps);
    cut.fade_out = length_of(entry.fade_out.duration, reel.fps);
    cut.from = entry.fade_in.color;
    cut.to = entry.fade_out.color;
    return cut;
}

namespace {

/// A transition at one end of a shot.
struct Transition {
    std::string name;
    int frames = 0;
    const ReelTime* time = nullptr;
};

Transition entering(const Reel& reel, const std::vector<Cut>& cuts, std::size_t i) {
    if (i > 0 && cuts[i - 1].crossfade > 0)
        return {fmt::format("shots.{}.crossfade", i - 1), cuts[i - 1].crossfade, &reel.entries[i - 1].crossfade};
    return {fmt::format("shots.{}.fade_in", i), cuts[i].fade_in, &reel.entries[i].fade_in.duration};
}

Transition leaving(const Reel& reel, const std::vector<Cut>& cuts, std::size_t i) {
    if (cuts[i].crossfade > 0) return {fmt::format("shots.{}.crossfade", i), cuts[i].crossfade, &reel.entries[i].crossfade};
    return {fmt::format("shots.{}.fade_out", i), cuts[i].fade_out, &reel.entries[i].fade_out.duration};
}

}  // namespace

void check_lengths(const Reel& reel, const std::vector<Cut>& cuts, std::vector<Diagnostic>& problems) {
    for (std::size_t i = 0; i < cuts.size(); ++i) {
        const Transition begin = entering(reel, cuts, i), end = leaving(reel, cuts, i);
        const int length = cuts[i].length();
        bool alone = false;
        for (const Transition* each : {&begin, &end}) {
            if (each->frames <= length) continue;
            alone = true;
            problems.push_back(problem_at(
                each->time->where,
                fmt::format("{} is {} ({}), but shots.{} lasts {}", each->name, each->time->written, frames_text(each->frames), i,
                            frames_text(length)),
                fmt::format("expected at most {}; a longer hold makes a shot last longer", frames_text(length))));
        }
        if (alone || begin.frames + end.frames <= length) continue;
        problems.push_back(problem_at(
            end.time->where,
            fmt::format("{} ({}) begins before {} ({}) has ended: shots.{} lasts {}", end.name, frames_text(end.frames),
                        begin.name, frames_text(begin.frames), i, frames_text(length)),
            "shorten one of the two, or let the shot last longer"));
    }
}

ReelSource conform(const Reel& reel, const BoundEntry& bound) {
    const ReelEntry& entry = *bound.entry;
    ReelSource source;
    Shot& shot = source.prepared.shot;
    shot = entry.shot;
    const Rational rate = conformed_rate(reel, entry);
    const ImageSpec size = fitted_size(shot.image, reel.image);
    source.own = !entry.changed && rate == shot.timing.fps && size == shot.image;
    const std::int64_t begin = rounded(range_of(shot, bound.frames).begin_s * rate) + shot.timing.first;
    source.prepared.metered_frame = source.own ? bound.frames.front() : static_cast<int>(begin);
    source.prepared.view_wanted = true;
    shot.timing.fps = rate;
    shot.image = size;
    shot.timing.frames.clear();  // filled in with what the cuts show
    shot.frames_given = true;
    shot.output.video.reset();
    source.identity = settings_identity(shot);
    return source;
}

}  // namespace kadr
