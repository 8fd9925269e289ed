#pragma once

#include <limits>
#include <vector>

#include "base/error.h"
#include "frame/node_rig.h"
#include "scene/property_channel.h"

namespace kadr {

/// What a property may be; a clip may drive it beyond with its keys or between them.
struct PropertyLimits {
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    bool operator==(const PropertyLimits&) const = default;
};
/// Of every component; angles in radians. Source: glTF 2.0 and its extensions' schemas, where the renderer needs them.
PropertyLimits limits_of(Property property);

/// One warning for each channel that leaves its property's limits in what is played of its clip from the first frame to
/// the last: what it drives is held at them.
std::vector<Diagnostic> warnings_of_limits(const Scene& scene, const std::vector<BoundScene>& scenes, double begin_s, double end_s);

}  // namespace kadr
