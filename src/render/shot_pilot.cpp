#include "render/shot_pilot.h"

#include <algorithm>
#include <memory>
#include <set>

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
    for (const int number : pilot.frames)
        frames.push_back({number, pilot.there(pilot.shot.sequence().frame(number)), std::nullopt});
    const double begin_s = pilot.clock(), end_s = begin_s + kPilotShare * pilot.budget_s;
    find_repeats(pilot, begin_s + kPilotShare / 2 * pilot.budget_s, frames);
    std::vector<PlannedFrame*> ours;
    for (PlannedFrame& frame : frames)
        if (!frame.free) ours.push_back(&frame);
    // A frame alone has all the time there is.
    if (ours.size() < 2) return frames;
    const double share_s = pilot.budget_s * static_cast<double>(pilot.devices) / static_cast<double>(ours.size());
    for (const std::size_t i : coarse_to_fine(ours.size())) {
        const auto parts = std::make_shared<const std::vector<SceneSnapshot>>(
            make_snapshots(pilot.shot, pilot.shot.sequence().frame(ours[i]->number)));
        ours[i]->forecast = renderer.pilot(pilot.shot, parts, pilot.layers, share_s, statistics);
        if (pilot.clock() > end_s) break;
    }
    return frames;
}

}  // namespace kadr
