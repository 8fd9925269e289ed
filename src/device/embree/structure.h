#pragma once

#include "device/device.h"
#include "device/embree/embree_api.h"

namespace kadr {

/// An empty acceleration structure that will be built as the settings say.
inline EmbreeSceneHandle new_structure(RTCDevice device, const BuildSettings& build) {
    constexpr RTCBuildQuality kQualities[] = {RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_MEDIUM, RTC_BUILD_QUALITY_HIGH};
    EmbreeSceneHandle structure(rtcNewScene(device));
    rtcSetSceneBuildQuality(structure.get(), kQualities[static_cast<std::size_t>(build.quality)]);
    if (build.robust != BuildSettings::Robust::no) rtcSetSceneFlags(structure.get(), RTC_SCENE_FLAG_ROBUST);
    return structure;
}

}  // namespace kadr
