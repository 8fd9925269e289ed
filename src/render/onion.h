#pragma once

#include <vector>

#include "anim/timing.h"
#include "film/film.h"
#include "output/drawing.h"

namespace kadr {

/// The colour of a ghost by its place in the sequence, 0 the earliest and 1 the latest: from warm over white to cool.
DisplayColor ghost_color(double place);

/// Several display-referred frames of one size in one picture.
///
/// `still_camera`: what does not change stays as it is, the median of the frames; where a frame differs from it beyond
/// the noise, the frame is laid over in the tint of its time, the later over the earlier and the more opaque. Frames of
/// one seed have the same noise where nothing changes, so that the ground is exact there. Otherwise everything changes,
/// and the result is the mean of all frames.
Image overlay_frames(const std::vector<Image>& frames, bool still_camera);

/// Writes the frames' numbers along the lower edge, each in the colour of its ghost (white without tint).
void label_ghosts(Image& picture, const std::vector<FrameTime>& frames, bool tinted);

}  // namespace kadr
