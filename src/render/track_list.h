#pragma once

#include <functional>
#include <string>
#include <vector>

#include "shot/shot.h"

namespace kadr {

/// A value of a shot that changes over time, as a person who looks at a timeline sees it.
struct TrackInfo {
    std::string name;            ///< its path in the shot file: "camera.position"
    std::string kind;            ///< "linear", "smooth, eased"
    std::string outside;         ///< what happens before the first key and after the last; empty: the ends hold
    std::vector<double> keys_s;  ///< ascending
    std::function<bool(double begin_s, double end_s)> changes;  ///< whether the value differs between two times
    std::function<std::vector<double>(double begin_s, double end_s)> jumps;  ///< as of discontinuities()
};

/// Every value with two keys or more, in the order of the shot file's sections. The shot has to outlive the result.
std::vector<TrackInfo> tracks_of(const Shot& shot);

}  // namespace kadr
