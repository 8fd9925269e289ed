#pragma once

#include <string>
#include <utility>
#include <vector>

#include "shot/shot.h"

namespace kadr {

/// One way to render a shot that is measured: its own settings but for one.
struct Variant {
    std::string axis;   ///< "bounces"; "shot": the shot's own settings; "recommended": what the measurement advises
    std::string value;  ///< as one writes it: "4", "none", "0.5 px"; empty for the last two
    std::vector<std::pair<std::string, std::string>> set;  ///< over the shot: key paths and their values in YAML
    std::string device = {};                               ///< rendered on another one than the rest; empty: on the same
    /// A folder's name: "bounces-4", "motion_tolerance-0.5px".
    std::string id() const;
};

/// Why something was not measured.
struct LeftOut {
    std::string what, reason;
};

struct Sweep {
    std::vector<Variant> variants;  ///< the shot's own settings first, then by axis
    std::vector<LeftOut> left_out;
};

/// A device that a shot may be rendered on.
struct SweepDevice {
    std::string name;     ///< as --device has it
    std::string missing;  ///< why it is not usable; empty: it is
    bool own = false;     ///< the rest is rendered on it
};

/// Samples a pixel at which every axis but `samples` is measured; what a sweep of samples spans.
struct SweepSize {
    int samples = 64;
    std::vector<int> sample_counts{4, 16, 64, 256};
    bool quick = false;  ///< fewer values of each axis
    int largest_texture_px = 0;  ///< longest side of the shot's textures; 0: it has none
    bool moves = true;           ///< whether something moves while the shutter is open
    std::vector<SweepDevice> devices = {};
};

/// The names that --sweep takes. @throws InputError  for an unknown name
std::vector<std::string> parse_axes(const std::string& list);

/// The variants of a shot along the axes. @param axes  empty: all that there are
Sweep plan_sweep(const RenderSpec& render, const std::vector<std::string>& axes, const SweepSize& size);

}  // namespace kadr
