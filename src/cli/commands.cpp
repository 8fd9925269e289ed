#include "cli/commands.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/device_comparison_text.h"
#include "cli/explain_text.h"
#include "cli/reporter.h"
#include "device/device.h"
#include "device/gpu_report.h"
#include "output/frame_writer.h"
#include "render/denoising.h"
#include "render/reel_job.h"
#include "render/reel_plan.h"
#include "shot/shot_parser.h"
#include "stress/report.h"

namespace kadr {
namespace {

constexpr int kDone = 0, kFailed = 1, kBadInput = 2;

void print(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stdout); }

std::string json_line(const nlohmann::ordered_json& value) {
    return value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

int run_render(const Invocation& invocation) {
    const std::unique_ptr<Reporter> reporter = make_reporter(invocation.json, invocation.stats);
    const auto render = is_reel(invocation.render.shot) ? render_reel : render_shot;
    reporter->summary(render(invocation.render, reporter->events()));
    return kDone;
}

int run_preview(const Invocation& invocation) {
    if (is_reel(invocation.preview.render.shot)) refuse_reel_preview(invocation.preview);
    const std::unique_ptr<Reporter> reporter = make_reporter(invocation.json, invocation.stats);
    RenderEvents events = reporter->events();
    if (!invocation.json && !invocation.stats) events.frame_done = [](const FrameReport&) {};  // the line below says it
    const FrameReport report = render_preview(invocation.preview, events);
    reporter->clear();
    if (invocation.json) return kDone;
    print(fmt::format("{}: {} in {:.2f} s\n", report.preview.empty() ? "preview" : report.preview,
                      report.files.front().string(), report.seconds));
    if (!report.note.empty()) print(fmt::format("  {}\n", report.note));
    return kDone;
}

void print_checked(const Invocation& invocation, const std::filesystem::path& shot, const CheckReport& report) {
    if (!invocation.json) return print(fmt::format("{}: ok\n{}", shot.string(), report.details));
    if (invocation.verbose) print(json_line({{"event", "details"}, {"file", shot.string()}, {"text", report.details}}));
}

int run_check(const Invocation& invocation) {
    const std::unique_ptr<Reporter> reporter = make_reporter(invocation.json, false);
    std::vector<Diagnostic> problems;
    for (const std::filesystem::path& shot : invocation.shots) {
        try {
            const auto check = is_reel(shot) ? check_reel : check_shot;
            const CheckReport report = check(shot, invocation.render.overrides, invocation.verbose);
            for (const Diagnostic& warning : report.warnings) reporter->warning(warning);
            print_checked(invocation, shot, report);
        } catch (const InputError& error) {
            problems.insert(problems.end(), error.diagnostics().begin(), error.diagnostics().end());
        }
    }
    if (!problems.empty()) throw InputError(problems);
    return kDone;
}

int run_explain(const Invocation& invocation) {
    const RenderOptions& render = invocation.render;
    if (is_reel(render.shot))
        throw InputError(fmt::format("{} is a reel", render.shot.string()), "expected a shot: kadr explain tells of one of its shots at a time");
    const Explanation explanation = explain_shot({render.shot, render.overrides, render.device, invocation.trial});
    if (invocation.json) {
        print(json_line(explanation_json(explanation)));
        return kDone;
    }
    const std::unique_ptr<Reporter> reporter = make_reporter(false, false);
    for (const Diagnostic& warning : explanation.warnings) reporter->warning(warning);
    print(explanation_text(explanation));
    return kDone;
}

int run_describe(const Invocation& invocation) {
    std::string text = invocation.json_schema ? schema_as_json(invocation.key) : describe_schema(invocation.key);
    if (text.empty() || text.back() != '\n') text += '\n';
    print(text);
    return kDone;
}

std::string smoke_line(const SmokeCase& result) {
    if (!result.skipped.empty()) return fmt::format("skip   {}: {}\n", result.shot, result.skipped);
    const std::string compared =
        result.compared ? fmt::format(", FLIP {:.4f} of {:.4f}", result.flip, result.tolerance) : std::string();
    std::string line = fmt::format("{} {} frame {}{}{}\n", result.failures.empty() ? "ok    " : "FAILED", result.shot,
                                   result.frame, compared, result.updated ? ", golden image written" : "");
    for (const std::string& failure : result.failures) line += fmt::format("  {}\n", failure);
    return line;
}

void write_junit(const std::filesystem::path& file, const std::vector<SmokeCase>& cases) {
    if (file.empty()) return;
    std::ofstream stream(file);
    stream << junit_xml(cases);
    stream.close();
    if (!stream) throw RenderError(fmt::format("cannot write {}", file.string()));
}

int run_smoke(const Invocation& invocation) {
    const std::vector<SmokeCase> cases = smoke(invocation.smoke, [](const SmokeCase& result) {
        print(smoke_line(result));
        std::fflush(stdout);
    });
    write_junit(invocation.junit, cases);
    const auto any = [&](auto test) { return std::any_of(cases.begin(), cases.end(), test); };
    if (any([](const SmokeCase& result) { return result.bad_input; })) return kBadInput;
    return any([](const SmokeCase& result) { return !result.failures.empty(); }) ? kFailed : kDone;
}

/// JSON has no infinity: the PSNR of equal images is null.
nlohmann::ordered_json json_of(const FrameDifference& difference) {
    nlohmann::ordered_json json;
    for (const Metric metric : {Metric::rmse, Metric::relmse, Metric::psnr, Metric::ssim, Metric::flip}) {
        const double value = value_of(difference, metric);
        json[name_of(metric)] = std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
    }
    json["largest"] = difference.values.largest;
    json["not_finite"] = difference.not_finite;
    return json;
}

std::string figures_of(const FrameDifference& d) {
    return fmt::format("{:>10.6f} {:>10.6f} {:>7.2f} {:>8.5f} {:>8.5f}", d.values.rms, d.relmse, d.values.psnr_db, d.ssim, d.flip);
}

void print_compared(const Invocation& invocation, const ComparedFrame& frame, std::size_t label_width) {
    const FrameDifference& d = frame.difference;
    if (invocation.json) {
        nlohmann::ordered_json json{{"event", "frame"}, {"frame", frame.pair.label}, {"reference", frame.pair.reference.string()},
                                    {"test", frame.pair.test.string()}};
        json.update(json_of(d));
        json["largest_at"] = {d.values.x, d.values.y};
        json["largest_channel"] = d.largest_channel;
        if (!frame.map.empty()) json["map"] = frame.map.string();
        json["failures"] = frame.failures;
        print(json_line(json));
    } else {
        print(fmt::format("{:<{}} {}   {:.4g} at {},{} in {}{}\n", frame.pair.label, label_width, figures_of(d), d.values.largest, d.values.x, d.values.y,
                          d.largest_channel, d.not_finite > 0 ? fmt::format("; {} pixels are NaN or infinite", d.not_finite) : ""));
        for (const std::string& failure : frame.failures) print(fmt::format("  FAILED: {}\n", failure));
    }
    std::fflush(stdout);
}

void print_compared_all(const Invocation& invocation, const CompareSummary& summary, std::size_t label_width) {
    const std::string worst = summary.frames[summary.worst].pair.label;
    if (invocation.json) {
        nlohmann::ordered_json json{{"event", "summary"}, {"frames", summary.frames.size()}};
        json.update(json_of(summary.mean));
        json["worst"] = worst;
        if (!summary.video.empty()) json["video"] = summary.video.string();
        json["failed"] = summary.failed;
        return print(json_line(json));
    }
    if (summary.frames.size() > 1)
        print(fmt::format("{:<{}} {}   worst: {}, FLIP {:.5f}\n", "mean", label_width, figures_of(summary.mean), worst,
                          summary.frames[summary.worst].difference.flip));
    if (!summary.video.empty()) print(fmt::format("video: {}\n", summary.video.string()));
}

int run_compare(const Invocation& invocation) {
    const std::unique_ptr<Reporter> reporter = make_reporter(invocation.json, false);
    CompareEvents events;
    events.render = reporter->events();
    bool headed = invocation.json;
    std::size_t label_width = 8;
    events.frame_done = [&](const ComparedFrame& frame) {
        reporter->clear();
        label_width = std::max(label_width, frame.pair.label.size());
        if (!headed)
            print(fmt::format("{:<{}} {:>10} {:>10} {:>7} {:>8} {:>8}   {}\n", "frame", label_width, "RMSE", "relMSE", "PSNR", "SSIM", "FLIP", "largest difference"));
        headed = true;
        print_compared(invocation, frame, label_width);
    };
    const CompareSummary summary = compare(invocation.compare, events);
    print_compared_all(invocation, summary, label_width);
    return summary.failed ? kFailed : kDone;
}

int run_compare_devices(const Invocation& invocation) {
    const DeviceComparison comparison = compare_devices(invocation.compare_devices, [&](const ComparedDeviceFrame& frame) {
        if (invocation.json) return;
        print(comparison_text(frame, invocation.compare_devices));
        std::fflush(stdout);
    });
    if (invocation.json) {
        print(json_of(comparison) + "\n");
    } else {
        if (!comparison.json.empty()) print(fmt::format("report: {}\n", comparison.json.string()));
        print(comparison.verdict() + "\n");
    }
    return comparison.differs() ? kFailed : kDone;
}

std::string row_of(const MeasuredVariant& v) {
    return fmt::format("{:<26} {:>9.3f} {:>8.4f} {:>8.4f} {:>10.3g} {:>10.3g} {:>10.2g}\n", fmt::format("{} {}", v.variant.axis, v.variant.value), v.seconds, v.error.flip,
                       v.error.ssim, v.error.relmse, v.error.noise, v.error.bias);
}

void print_measured(const Invocation& invocation, const MeasuredVariant& v, int done, int count) {
    if (invocation.json)
        print(json_line({{"event", "variant"}, {"axis", v.variant.axis}, {"value", v.variant.value}, {"done", done}, {"count", count}, {"seconds", v.seconds},
                         {"flip", v.error.flip}, {"ssim", v.error.ssim}, {"relmse", v.error.relmse}, {"noise", v.error.noise}, {"bias", v.error.bias}}));
    else
        print(row_of(v));
    std::fflush(stdout);
}

int run_measure(const Invocation& invocation) {
    const std::unique_ptr<Reporter> reporter = make_reporter(invocation.json, false);
    MeasureEvents events;
    events.render = reporter->events();
    events.render.frame_done = [](const FrameReport&) {};
    std::set<std::string> warned;  // every variant would say the same again
    events.render.warning = [&](const Diagnostic& warning) {
        if (warned.insert(warning.text()).second) reporter->warning(warning);
    };
    if (!invocation.json)
        print(fmt::format("{:<26} {:>9} {:>8} {:>8} {:>10} {:>10} {:>10}\n", "settings", "s a frame", "FLIP", "SSIM", "relMSE", "noise", "bias"));
    events.variant_done = [&](const MeasuredVariant& variant, int done, int count) {
        reporter->clear();
        print_measured(invocation, variant, done, count);
    };
    const Measurement measurement = measure(invocation.measure, events);
    reporter->clear();
    const Recommendation& advice = measurement.recommendation;
    if (!invocation.json) print(fmt::format("{}\n{}\n{}\n", row_of(advice.measured), advice.text, advice.yaml()));
    const std::filesystem::path page = write_report(measurement);
    if (invocation.json)
        print(json_line({{"event", "summary"}, {"page", page.string()}, {"advice", advice.text}, {"yaml", advice.yaml()}}));
    else
        print(fmt::format("report: {}\n", page.string()));
    return kDone;
}

constexpr const char* kStressHead = "       cell                               image error, 1/255: mean, largest, pixels beyond 1   holes, wrong surfaces, false shadows, leaks; hit error px, ulp\n";

std::string stress_json(const stress::CellResult& result) {
    nlohmann::ordered_json json{{"event", "cell"}};
    json.update(nlohmann::ordered_json::parse(stress::json_of(result)));
    return json_line(json);
}

std::string stress_line(const stress::CellResult& r) {
    const std::string cell = fmt::format("{} {:<34}", r.sound() ? "ok    " : r.fault() ? "FAILED" : "beyond", stress::name_of(r.cell));
    if (!r.refused.empty()) return fmt::format("{} refused: {}\n", cell, r.refused);
    std::string line = cell;
    if (r.picture) line += fmt::format(" {:>8.3f} {:>8.1f} {:>7.2f}%", 255 * r.picture->mean, 255 * r.picture->largest, 100 * r.picture->beyond);
    if (r.rays)
        line += fmt::format(" {:>6} {:>6} {:>6} {:>6} {:>9.2g} {:>9.2g}", r.rays->holes, r.rays->wrong_surfaces, r.rays->false_shadows, r.rays->leaks, r.rays->position_error_px,
                            r.rays->position_error_ulp);
    if (r.drift) line += fmt::format("  drift {:.2g}", 255 * r.drift->mean);
    if (r.dropped_samples > 0) line += fmt::format("  {} samples dropped", r.dropped_samples);
    if (r.not_finite > 0) line += fmt::format("  {} values not finite", r.not_finite);
    return line + fmt::format("  {:.2f} s\n", r.seconds);
}

void print_stress_summary(const Invocation& invocation, const std::vector<stress::CellResult>& results, const std::filesystem::path& page) {
    const stress::RayFigures rays = stress::total_rays(results);
    if (invocation.json)
        return print(json_line({{"event", "summary"}, {"page", page.string()}, {"cells", results.size()}, {"shadow_rays", rays.shadow_rays}, {"light_rays", rays.light_rays}, {"false_shadows", rays.false_shadows}, {"leaks", rays.leaks}}));
    print("\nsafe ranges:\n");
    for (const stress::SafeRange& range : stress::safe_ranges(results)) print(fmt::format("  {:<18} {}{}\n", range.axis->name, range.text(), range.complete ? "" : "   (the sweep goes on)"));
    print(fmt::format("{} camera rays, {} shadow rays, {} rays to lights: {} holes, {} wrong surfaces, {} false shadows, {} leaks\nreport: {}\n", rays.camera_rays, rays.shadow_rays, rays.light_rays, rays.holes,
                      rays.wrong_surfaces, rays.false_shadows, rays.leaks, page.string()));
}

int run_stress(const Invocation& invocation) {
    bool first = !invocation.json;
    const auto results = stress::run_sweep(invocation.stress, [&](const stress::CellResult& result, std::size_t, std::size_t) {
        if (std::exchange(first, false)) print(kStressHead);  // now that the names of the axes are known to be right
        print(invocation.json ? stress_json(result) : stress_line(result));
        std::fflush(stdout);
    });
    const std::filesystem::path page = stress::write_report(results, invocation.stress.output);
    print_stress_summary(invocation, results, page);
    return std::none_of(results.begin(), results.end(), [](const stress::CellResult& r) { return r.fault(); }) ? kDone : kFailed;
}

int run_info(const Invocation& invocation) {
    const Metadata metadata = describe_image(invocation.file);
    if (invocation.json) {
        print(json_line(nlohmann::ordered_json(metadata)));
        return kDone;
    }
    for (const auto& [key, value] : metadata) print(fmt::format("{:<16} {}\n", key, value));
    return kDone;
}

/// Not a device, but as much a part of the machine: whether render.denoise: oidn would work.
void print_denoiser(bool json) {
    RenderSpec asked;
    asked.denoise = DenoiserKind::oidn;
    std::string version, reason;
    try {
        version = denoiser_of(asked)->version();
    } catch (const InputError& error) {
        reason = error.diagnostics().front().found;
    }
    if (json)
        print(json_line({{"name", "oidn"}, {"description", "Open Image Denoise " + version}, {"usable", reason.empty()}, {"reason", reason}}));
    else
        print(fmt::format("{:<6} {}; the denoiser of render.denoise\n", "oidn", reason.empty() ? "usable: version " + version : "not usable: " + reason));
}

void print_gpu_report(bool json) {
    const std::vector<std::string> needs = describe_gpu_needs(), unproven = unproven_on_gpu();
    if (json) return print(json_line({{"gpu_needs", needs}, {"unproven_on_gpu", unproven}}));
    print("to use a GPU, in this order:\n");
    for (const std::string& need : needs) print(fmt::format("  {}\n", need));
    print("what no GPU has shown yet:\n");
    for (const std::string& what : unproven) print(fmt::format("  {}\n", what));
}

int run_devices(const Invocation& invocation) {
    for (const DeviceReport& device : list_devices()) {
        if (invocation.json)
            print(json_line({{"name", device.name}, {"description", device.description}, {"usable", device.usable},
                             {"reason", device.reason}}));
        else
            print(fmt::format("{:<6} {}{}\n", device.name, device.usable ? "usable" : "not usable: " + device.reason,
                              device.description.empty() ? "" : "; " + device.description));
    }
    print_denoiser(invocation.json);
    if (invocation.verbose) print_gpu_report(invocation.json);
    return kDone;
}

}  // namespace

int run_command(const Invocation& invocation) {
    static const std::map<Command, int (*)(const Invocation&)> kCommands = {
        {Command::render, run_render}, {Command::preview, run_preview}, {Command::check, run_check},
        {Command::explain, run_explain},
        {Command::describe, run_describe}, {Command::smoke, run_smoke}, {Command::compare, run_compare},
        {Command::compare_devices, run_compare_devices},
        {Command::measure, run_measure}, {Command::info, run_info},
        {Command::devices, run_devices}, {Command::stress, run_stress},
    };
    return kCommands.at(invocation.command)(invocation);
}

}  // namespace kadr
