#include "render/timeline.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "frame/snapshot.h"
#include "frame/snapshot_key.h"
#include "render/track_list.h"

namespace kadr {
namespace {

constexpr int kBarColumns = 60, kNameColumns = 36;
constexpr std::size_t kMostCuts = 20;
constexpr const char* kClips = "clips";

/// "1.958333": without zeros at its end.
std::string decimal(double value, int digits = 6) {
    std::string text = fmt::format("{:.{}f}", value, digits);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text == "-0" ? "0" : text;
}

/// "1.958333 s (47/24)"; the fraction only where the decimals do not say all.
std::string exact(const Rational& time) {
    const std::string text = decimal(time.value());
    const bool is_all = std::stod(text) == time.value();
    return is_all ? text + " s" : fmt::format("{} s ({}/{})", text, time.numerator, time.denominator);
}

/// Names longer than their column keep both ends: the section and the field.
std::string fitted(const std::string& name) {
    if (name.size() <= static_cast<std::size_t>(kNameColumns)) return name;
    constexpr std::size_t kTail = 18, kHead = kNameColumns - kTail - 2;
    return name.substr(0, kHead) + ".." + name.substr(name.size() - kTail);
}

/// "open for 0.020833 s, 180 deg of a frame" and what is special about it.
std::string shutter_text(const Shutter& shutter, const Rational& fps) {
    constexpr const char* kShapes[] = {"box", "triangle", "smooth", "keys"};
    constexpr const char* kDirections[] = {"none", "down", "up", "left", "right"};
    const double open_s = open_length_s(shutter, fps);
    if (!(open_s > 0)) return "  shutter: closed, no motion blur\n";
    std::string text = fmt::format("  shutter: open for {} s, {} deg of a frame", decimal(open_s),
                                   decimal(360 * open_s * fps.value(), 3));
    if (shutter.curve.shape != ShutterCurve::Shape::box)
        text += fmt::format(", curve {}", kShapes[static_cast<int>(shutter.curve.shape)]);
    if (shutter.rolling.direction != RollingShutter::Direction::none)
        text += fmt::format(", rolling {} over {} s", kDirections[static_cast<int>(shutter.rolling.direction)],
                            decimal(shutter.rolling.duration_s));
    return text + (shutter.physical ? ", physical exposure\n" : "\n");
}

/// The text of one shot's timeline, section by section.
class Timeline {
public:
    explicit Timeline(const BoundShot& shot) : shot_(shot), tracks_(tracks_of(shot.shot())) {
        const FrameTime first = frame(frames().front()), last = frame(frames().back());
        begin_s_ = std::min(first.open_s, first.time_s());
        end_s_ = std::max(last.close_s, last.time_s());
        if (!(end_s_ > begin_s_)) end_s_ = begin_s_ + 1 / fps();
    }
    std::string text() const { return timing() + table() + bars() + cuts() + repeats(); }

private:
    const std::vector<int>& frames() const { return shot_.timing().frames; }
    double fps() const { return shot_.timing().fps.value(); }
    FrameTime frame(int number) const { return shot_.sequence().frame(number); }
    std::string frame_text(double time_s) const {
        return fmt::format("f {}", decimal(time_s * fps() + shot_.timing().first, 2));
    }

    std::string timing() const;
    std::string shutter_line(int number) const;
    std::string table() const;
    std::string row(const TrackInfo& track) const;
    std::string bars() const;
    std::string bar(const TrackInfo& track) const;
    int column_of(double time_s) const;
    double time_of(double column) const { return begin_s_ + (end_s_ - begin_s_) * column / kBarColumns; }
    struct Cut {
        double time_s;
        std::string name;
    };
    std::vector<Cut> all_cuts() const;
    std::string cuts() const;
    std::string split_frames(double time_s) const;
    std::string repeats() const;

    const BoundShot& shot_;
    const std::vector<TrackInfo> tracks_;
    double begin_s_ = 0, end_s_ = 0;  ///< from the first opening of the shutter to the last closing
};

std::string Timeline::shutter_line(int number) const {
    const FrameTime time = frame(number);
    return fmt::format("  frame {}: at {}, shutter {} s to {} s\n", number, exact(time.time), decimal(time.open_s),
                       decimal(time.close_s));
}

std::string Timeline::timing() const {
    const Timing& timing = shot_.timing();
    const Rational& fps = timing.fps;
    const std::string rate = fps.denominator == 1
                                 ? decimal(fps.value())
                                 : fmt::format("{}/{} ({})", fps.numerator, fps.denominator, decimal(fps.value()));
    std::string text =
        fmt::format("timing: {} frame{} from {} to {}, {} a second, frame {} is at 0 s\n", frames().size(),
                    frames().size() == 1 ? "" : "s", frames().front(), frames().back(), rate, timing.first);
    text += shutter_text(shot_.shot().shutter, fps);
    text += shutter_line(frames().front());
    if (frames().size() > 1) text += shutter_line(frames().back());
    return text;
}

std::string Timeline::row(const TrackInfo& track) const {
    const auto key = [&](double time_s) { return fmt::format("{} s ({})", decimal(time_s, 4), frame_text(time_s)); };
    return fmt::format("  {:<{}} {:<13} {:>4}  {} to {}\n{}", fitted(track.name), kNameColumns, track.kind,
                       track.keys_s.size(), key(track.keys_s.front()), key(track.keys_s.back()),
                       track.outside.empty() ? "" : "    " + track.outside + "\n");
}

std::string Timeline::table() const {
    if (tracks_.empty()) return "tracks: none; every value of the shot file is constant\n";
    std::string text = fmt::format("tracks: {}\n  {:<{}} {:<13} {:>4}  {}\n", tracks_.size(), "value", kNameColumns,
                                   "interpolation", "keys", "first to last key");
    for (const TrackInfo& track : tracks_) text += row(track);
    return text;
}

int Timeline::column_of(double time_s) const {
    const double column = (time_s - begin_s_) / (end_s_ - begin_s_) * kBarColumns;
    return std::clamp(static_cast<int>(column), 0, kBarColumns - 1);
}

std::string Timeline::bar(const TrackInfo& track) const {
    std::string bar(kBarColumns, '.');
    // A jump at a column's end belongs to the next one.
    constexpr double kBeforeTheEnd = 1 - 1e-6;
    for (int c = 0; c < kBarColumns; ++c)
        if (track.changes(time_of(c), time_of(c + kBeforeTheEnd))) bar[static_cast<std::size_t>(c)] = '=';
    for (const double time : track.keys_s) {
        const char mark = time < begin_s_ ? '<' : time > end_s_ ? '>' : '|';
        bar[static_cast<std::size_t>(column_of(time))] = mark;
    }
    for (const double time : track.jumps(begin_s_, end_s_)) bar[static_cast<std::size_t>(column_of(time))] = '!';
    return fmt::format("  {:<{}} {}\n", fitted(track.name), kNameColumns, bar);
}

std::string Timeline::bars() const {
    if (tracks_.empty()) return {};
    const std::string left = fmt::format("f {}", frames().front()), right = fmt::format("f {}", frames().back());
    std::string text =
        fmt::format("bars: | a key, ! a jump, = changes, . holds, < > keys outside the shot\n  {:<{}} {}{:>{}}\n", "",
                    kNameColumns, left, right, kBarColumns - static_cast<int>(left.size()));
    for (const TrackInfo& track : tracks_) text += bar(track);
    return text;
}

/// The frames that are exposed while a value jumps.
std::string Timeline::split_frames(double time_s) const {
    std::string text;
    for (const int number : frames()) {
        const FrameTime time = frame(number);
        const double rounding = 1e-9 * (time.close_s - time.open_s);
        if (time_s - time.open_s <= rounding || time.close_s - time_s <= rounding) continue;
        text += fmt::format("{}{}", text.empty() ? "" : " and ", number);
    }
    return text.empty() ? "while the shutter is closed" : "splits the shutter of frame " + text;
}

std::vector<Timeline::Cut> Timeline::all_cuts() const {
    std::vector<Cut> cuts;
    const auto add = [&](const std::string& name, const std::vector<double>& times) {
        for (const double time : times) cuts.push_back({time, name});
    };
    for (const TrackInfo& track : tracks_) add(track.name, track.jumps(begin_s_, end_s_));
    // All there are; those of the tracks have their names already, the others come out of the scenes' files.
    add(kClips, shot_discontinuities(shot_, begin_s_, end_s_));
    std::stable_sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.time_s < b.time_s; });
    return cuts;
}

std::string Timeline::cuts() const {
    const double together = 1e-9 * (end_s_ - begin_s_);
    std::vector<Cut> merged;
    for (const Cut& cut : all_cuts()) {
        const bool is_new = merged.empty() || cut.time_s - merged.back().time_s > together;
        if (is_new)
            merged.push_back(cut);
        else if (cut.name != kClips)
            merged.back().name += ", " + cut.name;
    }
    if (merged.empty()) return "cuts: none\n";
    std::string text = fmt::format("cuts: {}\n", merged.size());
    for (std::size_t i = 0; i < std::min(merged.size(), kMostCuts); ++i)
        text += fmt::format("  {} s ({}): {}: {}\n", decimal(merged[i].time_s), frame_text(merged[i].time_s),
                            fitted(merged[i].name), split_frames(merged[i].time_s));
    if (merged.size() > kMostCuts) text += fmt::format("  and {} more\n", merged.size() - kMostCuts);
    return text;
}

/// "3-8, 12".
std::string as_ranges(const std::vector<int>& frames) {
    std::string text;
    for (std::size_t i = 0; i < frames.size();) {
        std::size_t last = i;
        while (last + 1 < frames.size() && frames[last + 1] == frames[last] + 1) ++last;
        text += (text.empty() ? "" : ", ") + std::to_string(frames[i]);
        if (last > i) text += fmt::format("-{}", frames[last]);
        i = last + 1;
    }
    return text;
}

std::string Timeline::repeats() const {
    constexpr std::size_t kMostCompared = 500;
    if (frames().size() < 2) return {};
    if (frames().size() > kMostCompared) return fmt::format("static: not looked at beyond {} frames\n", kMostCompared);
    std::vector<int> same;
    Hash before = content_key(make_snapshots(shot_, frame(frames().front())));
    for (std::size_t i = 1; i < frames().size(); ++i) {
        const Hash key = content_key(make_snapshots(shot_, frame(frames()[i])));
        if (key == std::exchange(before, key)) same.push_back(frames()[i]);
    }
    if (same.empty()) return "static: no frame repeats the one before\n";
    constexpr std::size_t kColumns = 40;
    std::string list = as_ranges(same);
    if (list.size() > kColumns) list = list.substr(0, list.rfind(',', kColumns)) + ", ..";
    return fmt::format("static: {} of {} frames repeat the one before: {}\n", same.size(), frames().size(), list);
}

}  // namespace

std::string timeline_text(const BoundShot& shot) { return Timeline(shot).text(); }

}  // namespace kadr
