#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "render/frame_renderer.h"

namespace kadr {

/// What a pilot may take of a shot's budget.
inline constexpr double kPilotShare = 0.04;

/// The order in which a few of `count` things tell most about all of them: the first, the last, the middle one, those
/// between, and so on by halves.
std::vector<std::size_t> coarse_to_fine(std::size_t count);

/// Looks ahead: which frames of a shot are free, and what the others take. As many of them, coarse to fine, as
/// kPilotShare of the time left pays for; which frames repeat others is looked for in half of that.
///
/// @param frames  the frames of the shot, in order
/// @param there   of a frame that is complete already its relative mean square error, 0 where that is not known
/// @param clock   seconds since some moment
struct PilotShot {
    const BoundShot& shot;
    const std::vector<int>& frames;
    std::function<std::optional<double>(const FrameTime&)> there;
    FilmLayers layers;
    double budget_s = 0;
    std::function<double()> clock;
    std::size_t devices = 1;  ///< that will share the frames
};
std::vector<PlannedFrame> pilot_frames(const PilotShot& pilot, FrameRenderer& renderer, DeviceStatistics& statistics);

}  // namespace kadr
