// measure.json, measure.csv and the page.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/version.h"
#include "measure/measure_job.h"
#include "measure/report_script.h"
#include "output/atomic_file.h"
#include "output/child_process.h"

namespace kadr {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void write_text(const fs::path& file, const std::string& text) {
    write_atomically(file, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

void add_error(Json& json, const FrameError& error, const std::optional<double>& flicker) {
    json["relmse"] = error.relmse;
    json["noise"] = error.noise;
    json["bias"] = error.bias;
    json["flip"] = error.flip;
    json["ssim"] = error.ssim;
    json["flicker"] = flicker ? Json(*flicker) : Json(nullptr);
}

Json json_of(const MeasuredVariant& measured) {
    Json json{{"axis", measured.variant.axis}, {"value", measured.variant.value}, {"set", measured.variant.set}, {"seconds", measured.seconds}};
    add_error(json, measured.error, measured.flicker);
    json["on_front"] = measured.on_front;
    json["picture"] = measured.picture.string();
    json["map"] = measured.map.string();
    for (const MeasuredFrame& frame : measured.frames) {
        Json each{{"frame", frame.frame}, {"seconds", frame.seconds}};
        add_error(each, frame.error, frame.flicker);
        each["images"] = {frame.a.string(), frame.b.string()};
        json["frames"].push_back(std::move(each));
    }
    return json;
}

Json json_of(const Measurement& m) {
    Json json{{"kadr", kVersion}, {"shot", m.shot}, {"size", {m.width, m.height}}, {"shot_size", {m.shot_width, m.shot_height}}, {"frames", m.frames},
              {"device", m.device}, {"samples", m.samples}};
    json["reference"] = {{"samples", m.reference_samples}, {"noise", m.reference_noise}, {"picture", m.reference_picture.string()}};
    for (const fs::path& file : m.references) json["reference"]["images"].push_back(file.string());
    for (const MeasuredVariant& variant : m.variants) json["variants"].push_back(json_of(variant));
    json["left_out"] = Json::array();
    for (const LeftOut& left : m.left_out) json["left_out"].push_back({{"what", left.what}, {"reason", left.reason}});
    json["shares"] = {{"noise", m.shares.noise}, {"bounces", m.shares.bounces}, {"motion", m.shares.motion}, {"clamp", m.shares.clamp}, {"denoise", m.shares.denoise}, {"texture", m.shares.texture}, {"other", m.shares.other}};
    json["recommendation"] = {{"text", m.recommendation.text}, {"yaml", m.recommendation.yaml()}, {"measured", json_of(m.recommendation.measured)}};
    return json;
}

std::string csv_of(const Measurement& m) {
    std::string text = "axis,value,frame,seconds,relmse,noise,bias,flip,ssim,flicker\n";
    const auto add = [&](const MeasuredVariant& measured) {
        for (const MeasuredFrame& frame : measured.frames)
            text += fmt::format("{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{}\n", measured.variant.axis, measured.variant.value, frame.frame, frame.seconds,
                                frame.error.relmse, frame.error.noise, frame.error.bias, frame.error.flip, frame.error.ssim,
                                frame.flicker ? fmt::format("{:.6g}", *frame.flicker) : std::string());
    };
    for (const MeasuredVariant& variant : m.variants) add(variant);
    add(m.recommendation.measured);
    return text;
}

void draw_page(const fs::path& json, const fs::path& page) {
    const std::string remedy = fmt::format("; '{}' and the .csv beside it are written; install python3-matplotlib (apt) for the page", json.string());
    const auto python = find_program("python3");
    if (!python) throw RenderError("cannot draw the page: there is no python3 on the PATH" + remedy);
    // The system's own python is the one that the distribution's matplotlib belongs to; another may come first on the PATH.
    std::string last;
    for (const fs::path& program : {fs::path("/usr/bin/python3"), *python}) {
        if (!fs::exists(program)) continue;
        const ProgramResult result = run_program({program.string(), "-c", kReportScript, json.string(), page.string()});
        if (result.status == 0) return;
        last = result.error_tail;
    }
    throw RenderError(fmt::format("cannot draw the page: {}{}", last, remedy));
}

}  // namespace

std::filesystem::path write_report(const Measurement& measurement) {
    const fs::path json = measurement.folder / "measure.json", page = measurement.folder / "measure.html";
    create_folder_of(json);
    write_text(json, json_of(measurement).dump(2) + "\n");
    write_text(measurement.folder / "measure.csv", csv_of(measurement));
    draw_page(json, page);
    return page;
}

}  // namespace kadr
