#pragma once

#include <vector>

#include "base/error.h"
#include "render/reel_plan.h"

namespace kadr {

/// A shot of the list, what it has beyond its own grammar, and how messages call it.
struct BoundEntry {
    const ReelEntry* entry = nullptr;
    std::vector<int> frames;  ///< of the shot itself
    std::string name;         ///< "shots.2"
};

/// The rate at which a shot is rendered for a reel.
Rational conformed_rate(const Reel& reel, const ReelEntry& entry);

/// The size at which a shot fills the reel's picture as far as its shape allows; whole pixels.
ImageSpec fitted_size(const ImageSpec& shot, const ImageSpec& reel);

/// The cut of an entry in whole frames. Times of the shot are rounded to the nearest of its frames (at the reel's rate),
/// durations to the nearest of the reel's. Adds to `problems` what lies outside the shot, or is empty.
Cut cut_of(const Reel& reel, const BoundEntry& bound, std::vector<Diagnostic>& problems);

/// Adds cross-fades that are longer than a shot beside them, and transitions that meet within a shot.
void check_lengths(const Reel& reel, const std::vector<Cut>& cuts, std::vector<Diagnostic>& problems);

/// The shot at the reel's rate and size. Its files are its own where nothing differs.
ReelSource conform(const Reel& reel, const BoundEntry& bound);

}  // namespace kadr
