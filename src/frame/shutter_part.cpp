#include "frame/shutter_part.h"

namespace kadr {

namespace {

static_assert(static_cast<int>(RollingShutter::Direction::none) == static_cast<int>(kernels::RollingDirection::none));
static_assert(static_cast<int>(RollingShutter::Direction::right) == static_cast<int>(kernels::RollingDirection::right));

/// Where a part lies in the shutter's window, in seconds from its opening. Taken from the shutter where the part ends
/// with it: equal frames then have equal parts, whatever the rounding of their own times.
struct Window {
    double length, delay;  ///< of one line; from the first line to the last
    double begin, end;     ///< of the part

    Window(const Shutter& shutter, Rational fps, const FrameTime& frame, const SceneSnapshot& part)
        : length(open_length_s(shutter, fps)),
          delay(shutter.rolling.duration_s),
          begin(part.open_s - frame.open_s),
          end(part.close_s == frame.close_s ? length + delay : part.close_s - frame.open_s) {}

    /// Share of its light that a line receives within the part.
    double share(const ShutterCurve& curve, double line) const {
        const double open = line * delay;
        if (!(length > 0)) return open >= begin && open < end ? 1 : 0;
        return (light_passed(curve, (end - open) / length) - light_passed(curve, (begin - open) / length)) / light_passed(curve, 1);
    }
};

int lines_of(const Shot& shot) {
    using Direction = RollingShutter::Direction;
    const Direction direction = shot.shutter.rolling.direction;
    if (direction == Direction::none) return 1;
    return direction == Direction::left || direction == Direction::right ? shot.image.width : shot.image.height;
}

double mean_share(const Shot& shot, const Window& window) {
    const int lines = lines_of(shot);
    double sum = 0;
    for (int line = 0; line < lines; ++line) sum += window.share(shot.shutter.curve, (line + 0.5) / lines);
    return sum / lines;
}

void set_table(const ShutterCurve& curve, kernels::Shutter& table) {
    constexpr int n = kernels::Shutter::kIntervals;
    for (int i = 0; i <= n; ++i) table.passed[i] = static_cast<float>(light_passed(curve, static_cast<double>(i) / n) / light_passed(curve, 1));
}

}  // namespace

void set_shutter(const BoundShot& shot, const FrameTime& frame, SceneSnapshot& snapshot) {
    const Shutter& shutter = shot.shot().shutter;
    const bool rolling = shutter.rolling.direction != RollingShutter::Direction::none;
    kernels::Shutter& part = snapshot.shutter;
    part.plain = shutter.curve.shape == ShutterCurve::Shape::box && !rolling;
    const double whole = frame.close_s - frame.open_s;
    if (part.plain || !(whole > 0)) {
        part.plain = true;
        snapshot.weight = whole > 0 ? (snapshot.close_s - snapshot.open_s) / whole : 1;
        return;
    }
    const Window window(shutter, shot.timing().fps, frame, snapshot);
    const double unit = window.end - window.begin;
    part.direction = static_cast<kernels::RollingDirection>(shutter.rolling.direction);
    part.first_open = static_cast<float>(-window.begin / unit);
    part.delay = static_cast<float>(window.delay / unit);
    part.length = static_cast<float>(window.length / unit);
    set_table(shutter.curve, part);
    snapshot.weight = mean_share(shot.shot(), window);
}

}  // namespace kadr
