#include "render/path_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace kadr {
namespace {

constexpr double kThin = 1.3, kThick = 3.2, kThinStrength = 0.8, kBehind = 0.35;
constexpr double kTick = 3.5, kLongTick = 7, kTickApart = 4;
constexpr int kNumbered = 10;

constexpr DisplayColor kCamera{1.0f, 0.80f, 0.20f}, kTarget{0.98f, 0.45f, 0.70f};
constexpr std::array<DisplayColor, 6> kObjects{{{0.40f, 0.85f, 1.0f},
                                                {0.60f, 0.92f, 0.45f},
                                                {1.0f, 0.62f, 0.38f},
                                                {0.76f, 0.68f, 1.0f},
                                                {0.35f, 0.90f, 0.75f},
                                                {0.93f, 0.90f, 0.60f}}};

bool is_exposed(const std::vector<FrameTime>& frames, double time_s) {
    const auto after = std::upper_bound(frames.begin(), frames.end(), time_s,
                                        [](double time, const FrameTime& frame) { return time < frame.open_s; });
    // Shutters may overlap; the one that opened last closes last.
    return after != frames.begin() && std::prev(after)->close_s > time_s;
}

bool jumps_between(const std::vector<double>& jumps_s, double a_s, double b_s) {
    const auto next = std::lower_bound(jumps_s.begin(), jumps_s.end(), a_s);
    return next != jumps_s.end() && *next <= b_s;
}

/// The length of a segment within a picture with a margin around it.
double visible_length(const PathSegment& segment, const ScreenCamera& camera) {
    const glm::dvec2 middle = 0.5 * (segment.from + segment.to);
    const bool inside = middle.x >= 0 && middle.y >= 0 && middle.x <= camera.width() && middle.y <= camera.height();
    return inside ? glm::distance(segment.from, segment.to) : 0;
}

void add_segments(ScreenPath& screen, const MotionPath& path, const PathTimes& times, const ScreenCamera& camera) {
    glm::dvec3 last = path.position(times.samples_s.front());
    for (std::size_t i = 1; i < times.samples_s.size(); ++i) {
        const double a_s = times.samples_s[i - 1], b_s = times.samples_s[i];
        const glm::dvec3 from = std::exchange(last, path.position(b_s));
        if (jumps_between(times.jumps_s, a_s, b_s)) continue;
        const auto seen = camera.project(from, last);
        if (!seen) continue;
        PathSegment segment{seen->first.px, seen->second.px, 0.5 * (seen->first.depth + seen->second.depth),
                            is_exposed(times.frames, 0.5 * (a_s + b_s))};
        screen.length_px += visible_length(segment, camera);
        screen.segments.push_back(segment);
    }
}

/// Perpendicular to the way of a path on the picture about a time.
glm::dvec2 across_at(const MotionPath& path, const ScreenCamera& camera, double time_s, double begin_s, double end_s) {
    constexpr double kStep = 1e-4;
    const double step = kStep * (end_s - begin_s);
    const auto before = camera.project(path.position(std::max(begin_s, time_s - step)));
    const auto after = camera.project(path.position(std::min(end_s, time_s + step)));
    const glm::dvec2 along = before && after ? after->px - before->px : glm::dvec2(0);
    const double length = glm::length(along);
    if (!(length > 1e-9)) return {0, -1};
    const glm::dvec2 across = glm::dvec2(along.y, -along.x) / length;
    return across.y > 0 ? -across : across;  // upwards, so that numbers stand on one side
}

void add_ticks(ScreenPath& screen, const MotionPath& path, const PathTimes& times, const ScreenCamera& camera) {
    const double begin_s = times.samples_s.front(), end_s = times.samples_s.back();
    for (const FrameTime& frame : times.frames) {
        const auto point = camera.project(path.position(frame.time_s()));
        if (!point) continue;
        screen.ticks.push_back(
            {frame.number, point->px, across_at(path, camera, frame.time_s(), begin_s, end_s), point->depth});
    }
}

/// Numbers that are drawn already; a new one that would touch them is left out.
class Numbers {
public:
    Numbers(Drawing& drawing, double height) : drawing_(drawing), height_(height) {}
    void add(const PathTick& tick, double strength) {
        const std::string text = std::to_string(tick.frame);
        const glm::dvec2 size(text_width(text, height_), height_);
        const glm::dvec2 centre =
            tick.at + (kLongTick + 0.6 * height_ + 0.5 * size.x * std::abs(tick.across.x)) * tick.across;
        const Box box{centre - 0.5 * size, centre + 0.5 * size};
        for (const Box& other : boxes_)
            if (box.low.x < other.high.x + 3 && other.low.x < box.high.x + 3 && box.low.y < other.high.y + 2 &&
                other.low.y < box.high.y + 2)
                return;
        boxes_.push_back(box);
        drawing_.text({box.low.x, box.high.y}, text, height_, strength);
    }

private:
    struct Box {
        glm::dvec2 low, high;
    };
    Drawing& drawing_;
    double height_;
    std::vector<Box> boxes_;
};

/// One path's drawing on one picture.
class PathPen {
public:
    PathPen(Image& picture, const ScreenPath& path, const std::vector<float>& depth)
        : picture_(picture), path_(path), depth_(depth), drawing_(picture.width, picture.height) {}

    void draw(int now, const DisplayColor& color) {
        for (const PathSegment& segment : path_.segments) draw_segment(segment);
        draw_ticks(now);
        drawing_.lay_onto(picture_, color);
    }

private:
    double visibility(const glm::dvec2& px, double depth) const {
        if (depth_.empty() || !(px.x >= 0 && px.y >= 0 && px.x < picture_.width && px.y < picture_.height)) return 1;
        const std::size_t at = static_cast<std::size_t>(px.y) * picture_.width + static_cast<std::size_t>(px.x);
        return depth > depth_[at] + path_.tolerance + 0.01 * depth ? kBehind : 1.0;
    }
    void draw_segment(const PathSegment& segment) {
        const double strength = visibility(0.5 * (segment.from + segment.to), segment.depth);
        drawing_.line(segment.from, segment.to, segment.exposed ? kThick : kThin,
                      strength * (segment.exposed ? 1 : kThinStrength));
    }
    void draw_ticks(int now) {
        const int step = tick_step(path_);
        Numbers numbers(drawing_, std::clamp(picture_.width / 70.0, 7.0, 14.0));
        for (const PathTick& tick : path_.ticks) {
            const double strength = visibility(tick.at, tick.depth);
            const bool is_long = tick.frame % (kNumbered * step) == 0;
            const glm::dvec2 half = (is_long ? kLongTick : kTick) * tick.across;
            if (tick.frame % step == 0) drawing_.line(tick.at - half, tick.at + half, kThin, strength);
            if (tick.frame == now) drawing_.circle(tick.at, kLongTick, 1.8);
            if (is_long || tick.frame == now) numbers.add(tick, std::max(strength, 0.6));
        }
    }

    Image& picture_;
    const ScreenPath& path_;
    const std::vector<float>& depth_;
    Drawing drawing_;
};

void draw_legend(Image& picture, const std::vector<ScreenPath>& paths, const std::vector<DisplayColor>& colors) {
    const double height = std::clamp(picture.width / 64.0, 7.0, 16.0);
    glm::dvec2 pen(height, 2 * height);
    for (std::size_t i = 0; i < paths.size(); ++i, pen.y += 1.8 * height) {
        Drawing name(picture.width, picture.height);
        name.line(pen - glm::dvec2(0, 0.5 * height), pen + glm::dvec2(1.6 * height, -0.5 * height), kThick);
        name.text(pen + glm::dvec2(2.4 * height, 0), paths[i].name, height);
        name.lay_onto(picture, colors[i]);
    }
}

}  // namespace

ScreenPath project(const MotionPath& path, const PathTimes& times, const ScreenCamera& camera) {
    ScreenPath screen{path.subject, path.name, {}, {}, path.radius, 0};
    add_segments(screen, path, times, camera);
    add_ticks(screen, path, times, camera);
    return screen;
}

int keep_most_prominent(std::vector<ScreenPath>& paths, int most) {
    constexpr double kShows = 4;  // pixels
    std::erase_if(paths, [](const ScreenPath& path) { return path.length_px < kShows; });
    const auto objects = std::find_if(
        paths.begin(), paths.end(), [](const ScreenPath& path) { return path.subject >= MotionPath::Subject::light; });
    std::stable_sort(objects, paths.end(),
                     [](const ScreenPath& a, const ScreenPath& b) { return a.length_px > b.length_px; });
    const auto count = paths.end() - objects;
    if (count <= most) return 0;
    paths.erase(objects + most, paths.end());
    return static_cast<int>(count) - most;
}

int tick_step(const ScreenPath& path) {
    const double apart = path.ticks.empty() ? 0 : path.length_px / static_cast<double>(path.ticks.size());
    int step = 1;
    constexpr int kFactors[] = {2, 5, 10};
    for (int decade = 1; decade <= 100000; decade *= 10)
        for (const int factor : kFactors) {
            if (apart * step >= kTickApart) return step;
            step = decade * factor;
        }
    return step;
}

DisplayColor path_color(MotionPath::Subject subject, int index) {
    if (subject == MotionPath::Subject::camera) return kCamera;
    if (subject == MotionPath::Subject::target) return kTarget;
    return kObjects[static_cast<std::size_t>(index) % kObjects.size()];
}

void draw_paths(Image& picture, const std::vector<ScreenPath>& paths, int now, const std::vector<float>& depth) {
    std::vector<DisplayColor> colors;
    int objects = 0;
    for (const ScreenPath& path : paths)
        colors.push_back(path_color(path.subject, path.subject >= MotionPath::Subject::light ? objects++ : 0));
    // The most important last, so that it lies on top.
    for (std::size_t i = paths.size(); i-- > 0;) PathPen(picture, paths[i], depth).draw(now, colors[i]);
    draw_legend(picture, paths, colors);
}

}  // namespace kadr
