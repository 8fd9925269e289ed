#include <cmath>

#include <nlohmann/json.hpp>

#include "base/version.h"
#include "measure/device_comparison.h"

namespace kadr {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinity.
Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json json_of(const SeenSurface& seen) {
    if (!seen.met) return nullptr;
    return {{"node", seen.node}, {"mesh", seen.mesh}, {"triangle", seen.primitive}, {"distance_m", seen.distance_m}};
}

Json json_of(const RayAgreement& rays) {
    Json json{{"rays", rays.rays},
              {"other_ids", rays.other_ids},
              {"at_edges", rays.at_edges},
              {"same_place", rays.same_place},
              {"wrong_ids", rays.wrong_ids},
              {"wrong_places", rays.wrong_places},
              {"error_bar_px", rays.error_bar_px},
              {"place_error", rays.place_error},
              {"first_bad", nullptr}};
    if (const auto& bad = rays.first_bad)
        json["first_bad"] = {{"frame", bad->frame},
                             {"x", bad->x},
                             {"y", bad->y},
                             {"time", bad->time},
                             {"seen", {json_of(bad->first), json_of(bad->second)}}};
    return json;
}

Json json_of(const ZTest& test) {
    Json json{{"level", kLevel},
              {"mean", {test.mean[0], test.mean[1]}},
              {"difference", test.difference},
              {"interval95", {test.difference_from, test.difference_to}},
              {"normal_beyond", kNormalBeyond}};
    for (const ScaleResult& scale : test.scales)
        json["scales"].push_back({{"name", scale.name},
                                  {"tests", scale.tests},
                                  {"beyond", scale.beyond},
                                  {"largest_z", finite(scale.largest_z)},
                                  {"at", {scale.x, scale.y, scale.channel}},
                                  {"rejected", scale.rejected},
                                  {"smallest_p", scale.smallest_p}});
    return json;
}

Json json_of(const FrameDifference& d) {
    return {{"flip", d.flip}, {"relmse", d.relmse},          {"rmse", d.values.rms},
            {"ssim", d.ssim}, {"largest", d.values.largest}, {"not_finite", d.not_finite}};
}

Json json_of(const DeviceTimes& times) {
    return {{"load_s", times.load_s},
            {"set_frame_s", times.set_frame_s},
            {"render_s", times.render_s},
            {"rays", times.rays},
            {"rays_per_s", times.rays_per_s()}};
}

Json json_of(const ComparedDeviceFrame& frame) {
    Json json{{"frame", frame.frame},
              {"differs", frame.differs()},
              {"rays", json_of(frame.rays)},
              {"noise", json_of(frame.noise)},
              {"pictures", json_of(frame.pictures)},
              {"noise_alone", json_of(frame.noise_alone)},
              {"times", {json_of(frame.times[0]), json_of(frame.times[1])}},
              {"dropped", frame.dropped}};
    json["files"] = Json::array();
    for (const auto& file : frame.files) json["files"].push_back(file.string());
    return json;
}

}  // namespace

std::string json_of(const DeviceComparison& comparison) {
    Json json{{"kadr", kVersion},
              {"shot", comparison.shot},
              {"devices", Json::array()},
              {"size", {comparison.width, comparison.height}},
              {"samples", comparison.samples},
              {"replicates", comparison.replicates},
              {"differs", comparison.differs()},
              {"verdict", comparison.verdict()}};
    for (int i = 0; i < 2; ++i)
        json["devices"].push_back({{"name", comparison.names[i]}, {"description", comparison.devices[i]}});
    json["frames"] = Json::array();
    for (const ComparedDeviceFrame& frame : comparison.frames) json["frames"].push_back(json_of(frame));
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace kadr
