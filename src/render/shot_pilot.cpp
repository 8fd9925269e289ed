#include "render/shot_pilot.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "frame/snapshot_key.h"

namespace kadr {
namespace {

/// Frames that hold the same as an earlier one are free, as far as there is time to look.
void find_repeats(const PilotShot& pilot, double until_s, std::vector<PlannedFrame>& frames) {
    std::set<std::string> seen;
    for (PlannedFrame& frame : frames) {
        if (pilot.clock() > until_s) return;
        if (frame.free) continue;
        const Hash key = content_key(make_snapshots(pilot.shot, pilot.shot.sequence().frame(frame.number)));
        frame.free = !seen.insert(key.hex()).second;
    }
}

/// Renders the first round of a whole frame: pixels far from each other take longer than neighbours, and a frame has more to
/// do than its samples. @return what the forecasts' time of a sample, and their time before it, are off by
struct PilotError {
    double sample_factor = 1, setup_s = 0;
};
PilotError compare_with_whole(const PilotShot& pilot, const std::shared_ptr<const std::vector<SceneSnapshot>>& parts, const FrameForecast& forecast,
                              FrameRenderer& renderer, DeviceStatistics& statistics) {
    constexpr double kAnyError = 1e9, kAnyTime_s = 1e9;
    const RenderedFrame whole =
        renderer.render(pilot.shot, parts, {pilot.layers, std::nullopt, {}, FrameTarget{kAnyError, kAnyTime_s, {}}, {}});
    add(statistics, whole.statistics);
    PilotError error;
    if (!(whole.statistics.render_s > 0) || !(forecast.sample_s > 0)) return error;
    error.sample_factor = whole.statistics.render_s / whole.sampling.mean / forecast.sample_s;
    error.setup_s = std::max(0.0, whole.seconds - whole.statistics.render_s - forecast.setup_s);
    return error;
}

}  // namespace

std::vector<std::size_t> coarse_to_fine(std::size_t count) {
    std::vector<std::size_t> order;
    std::vector<bool> taken(count, false);
    const auto take = [&](std::size_t i) {
        if (!taken[i]) order.push_back(i), taken[i] = true;
    };
    if (count == 0) return order;
    for (std::size_t parts = 1; order.size() < count; parts *= 2)
        for (std::size_t i = 0; i <= parts; ++i) take(i * (count - 1) / parts);
    return order;
}

std::vector<PlannedFrame> pilot_frames(const PilotShot& pilot, FrameRenderer& renderer, DeviceStatistics& statistics) {
    std::vector<PlannedFrame> frames;
    for (const int number : pilot.frames) {
        const std::optional<double> reached = pilot.there(pilot.shot.sequence().frame(number));
        frames.push_back({number, reached.has_value(), std::nullopt, reached.value_or(0)});
    }
    const double begin_s = pilot.clock(), end_s = begin_s + kPilotShare * pilot.budget_s;
    find_repeats(pilot, begin_s + kPilotShare / 2 * pilot.budget_s, frames);
    std::vector<PlannedFrame*> ours;
    for (PlannedFrame& frame : frames)
        if (!frame.free) ours.push_back(&frame);
    // A frame alone has all the time there is.
    if (ours.size() < 2) return frames;
    const double share_s = pilot.budget_s * static_cast<double>(pilot.devices) / static_cast<double>(ours.size());
    std::optional<PilotError> error;
    for (const std::size_t i : coarse_to_fine(ours.size())) {
        const auto parts = std::make_shared<const std::vector<SceneSnapshot>>(
            make_snapshots(pilot.shot, pilot.shot.sequence().frame(ours[i]->number)));
        FrameForecast forecast = renderer.pilot(pilot.shot, parts, pilot.layers, share_s, statistics);
        if (!error) error = compare_with_whole(pilot, parts, forecast, renderer, statistics);
        forecast.sample_s *= error->sample_factor;
        forecast.setup_s += error->setup_s;
        ours[i]->forecast = std::move(forecast);
        if (pilot.clock() > end_s) break;
    }
    return frames;
}

}  // namespace kadr
