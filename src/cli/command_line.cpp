#include "cli/command_line.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "anim/timing.h"
#include "base/error.h"
#include "base/text.h"
#include "base/version.h"

namespace kadr {
namespace {

constexpr const char* kShotHelp = "shot file (.yaml)";

/// Raw texts that need more than CLI11's conversions.
struct RawOptions {
    std::string shot, size, device = "auto";
    std::vector<std::string> set, shots;
    std::string frame, threads, samples, exposure, pixels_per_degree;
    std::string time, frames, sheet, from;
    bool onion = false, path = false;
    std::string limits, view, fps, time_budget_shot, sweep, devices, replicates;
};

int parse_number(const std::string& text, const std::string& option, const std::string& expected) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value <= 0)
        throw InputError(fmt::format("{} is '{}'", option, text), expected);
    return value;
}

/// Far beyond any machine; what is asked for is allocated.
constexpr int kMostThreads = 1024;

int parse_threads(const std::string& text) {
    const std::string expected = fmt::format("expected a whole number from 1 to {}, as in --threads 8", kMostThreads);
    const int threads = parse_number(text, "--threads", expected);
    if (threads > kMostThreads) throw InputError(fmt::format("--threads is '{}'", text), expected);
    return threads;
}

int parse_frame(const std::string& text) {
    int frame = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), frame);
    if (error != std::errc() || end != text.data() + text.size())
        throw InputError(fmt::format("--frame is '{}'", text), "expected the number of a frame, as in --frame 42");
    return frame;
}

/// "640x360" as two numbers above zero.
std::pair<int, int> parse_pair(const std::string& text, const std::string& option, const std::string& expected) {
    const std::size_t at = text.find('x');
    if (at == std::string::npos) throw InputError(fmt::format("{} is '{}'", option, text), expected);
    const auto part = [&](const std::string& number) {
        try {
            return parse_number(number, option, expected);
        } catch (const InputError&) {
            throw InputError(fmt::format("{} is '{}'", option, text), expected);
        }
    };
    return {part(text.substr(0, at)), part(text.substr(at + 1))};
}

std::pair<int, int> parse_size(const std::string& text) {
    return parse_pair(text, "--size", "expected WIDTHxHEIGHT in pixels, as in --size 640x360");
}

std::pair<int, int> parse_sheet(const std::string& text) {
    constexpr int kMostTiles = 400;
    const std::string expected = fmt::format("expected COLUMNSxROWS, at most {} tiles, as in --sheet 4x3", kMostTiles);
    const auto [columns, rows] = parse_pair(text, "--sheet", expected);
    if (columns > kMostTiles / rows) throw InputError(fmt::format("--sheet is '{}'", text), expected);
    return {columns, rows};
}

Viewpoint parse_viewpoint(const std::string& text) {
    static const std::map<std::string, Viewpoint> kViewpoints{
        {"camera", Viewpoint::camera}, {"side", Viewpoint::side}, {"top", Viewpoint::top}, {"iso", Viewpoint::iso}};
    const auto found = kViewpoints.find(text);
    if (found == kViewpoints.end())
        throw InputError(fmt::format("--from is '{}'", text), "expected camera, side, top or iso");
    return found->second;
}

std::pair<std::string, std::string> parse_setting(const std::string& text) {
    const std::size_t at = text.find('=');
    if (at == std::string::npos || at == 0)
        throw InputError(fmt::format("--set is '{}'", text), "expected KEY.PATH=VALUE, as in --set render.samples=16");
    return {text.substr(0, at), text.substr(at + 1)};
}

/// "1.75 s" as a number and what follows it without the blanks between; nothing where no number begins the text.
std::optional<std::pair<double, std::string>> number_and_unit(const std::string& text) {
    std::size_t used = 0;
    double value = 0;
    try {
        value = std::stod(text, &used);
    } catch (const std::exception&) {
        return std::nullopt;
    }
    return std::pair(value, text.substr(std::min(text.size(), text.find_first_not_of(' ', used))));
}

double parse_between(const std::string& text, const std::string& option, double low, double high) {
    const auto found = number_and_unit(text);
    if (!found || !found->second.empty() || !(found->first >= low && found->first <= high))
        throw InputError(fmt::format("{} is '{}'", option, text), fmt::format("expected a number from {} to {}", low, high));
    return found->first;
}

/// "1.75s", "1.75 s" or "1.75".
double parse_seconds(const std::string& text) {
    const auto found = number_and_unit(text);
    if (!found || !(found->second.empty() || found->second == "s") || !(found->first > -1e9 && found->first < 1e9))
        throw InputError(fmt::format("--time is '{}'", text), "expected seconds, as in --time 1.75s");
    return found->first;
}

ViewTransform parse_view(const std::string& text) {
    static const std::map<std::string, ViewTransform> kViews{{"none", ViewTransform::none}, {"srgb", ViewTransform::srgb},
                                                             {"agx", ViewTransform::agx}, {"aces", ViewTransform::aces},
                                                             {"pbr-neutral", ViewTransform::pbr_neutral}};
    const auto found = kViews.find(text);
    if (found == kViews.end()) throw InputError(fmt::format("--view is '{}'", text), "expected none, srgb, agx, aces or pbr-neutral");
    return found->second;
}

/// "24" or "24000/1001".
Rational parse_fps(const std::string& text) {
    const std::string expected = "expected frames a second, as in --fps 24 or --fps 24000/1001";
    const std::size_t at = text.find('/');
    const int numerator = parse_number(text.substr(0, at), "--fps", expected);
    const Rational fps(numerator, at == std::string::npos ? 1 : parse_number(text.substr(at + 1), "--fps", expected));
    constexpr double kFewest = 0.001, kMost = 10000;  // ffmpeg writes no video of others
    if (fps.value() < kFewest || fps.value() > kMost)
        throw InputError(fmt::format("--fps is '{}'", text), fmt::format("expected {} to {} frames a second", kFewest, kMost));
    return fps;
}

/// "90s", "10m", "1.5 h"; a number alone is seconds.
double parse_duration(const std::string& text, const std::string& option) {
    static const std::map<std::string, double> kUnits{{"", 1}, {"s", 1}, {"m", 60}, {"min", 60}, {"h", 3600}};
    const auto found = number_and_unit(text);
    const auto unit = found ? kUnits.find(found->second) : kUnits.end();
    if (unit == kUnits.end() || !(found->first > 0 && found->first < 1e7))
        throw InputError(fmt::format("{} is '{}'", option, text),
                         fmt::format("expected a time above zero, as in {} 90s, 10m or 2h", option));
    return found->first * unit->second;
}

/// The parser and where its values go.
class Parser {
public:
    Parser();
    Invocation parse(std::vector<std::string> arguments);

private:
    CLI::App* add(Command command, const std::string& name, const std::string& description, const std::string& example);
    void add_shot(CLI::App* app);
    void add_overrides(CLI::App* app);
    void add_set(CLI::App* app);
    void add_device(CLI::App* app);
    void add_render();
    void add_preview();
    void add_check();
    void add_explain();
    void add_describe();
    void add_smoke();
    void add_compare();
    void add_compare_devices();
    void add_measure();
    void add_info();
    void add_devices();
    void add_stress();

    CLI::App* chosen(const std::vector<std::string>& arguments) const;
    [[noreturn]] void refuse(const std::vector<std::string>& arguments, const CLI::ParseError& error) const;
    void refuse_unknown_command(const std::vector<std::string>& arguments) const;
    void refuse_unknown_option(const CLI::App& app, const std::vector<std::string>& arguments) const;
    void fill_in();
    void fill_preview();
    void fill_compare();
    void fill_compare_devices();
    void fill_measure();
    void fill_overrides(RenderOptions& options) const;

    CLI::App app_{"kadr renders animated shots of glTF scenes to images and video.", "kadr"};
    std::map<Command, CLI::App*> commands_;
    Invocation invocation_;
    RawOptions raw_;
};

Parser::Parser() {
    app_.set_version_flag("--version", fmt::format("kadr {}", kVersion), "print the version");
    app_.require_subcommand(1);
    app_.footer("Example:\n  kadr render shots/turntable.yaml\n\n"
                "Exit codes: 0 done, 1 the render failed, 2 bad usage or input, 130 interrupted.\n"
                "`kadr COMMAND --help` shows the options of a command.");
    add_render();
    add_preview();
    add_check();
    add_explain();
    add_describe();
    add_smoke();
    add_compare();
    add_compare_devices();
    add_measure();
    add_info();
    add_devices();
    add_stress();
}

CLI::App* Parser::add(Command command, const std::string& name, const std::string& description,
                      const std::string& example) {
    CLI::App* app = app_.add_subcommand(name, description);
    app->footer("Example:\n  " + example);
    commands_[command] = app;
    return app;
}

void Parser::add_shot(CLI::App* app) { app->add_option("SHOT", raw_.shot, kShotHelp)->required(); }

void Parser::add_set(CLI::App* app) {
    app->add_option("--set", raw_.set, "KEY.PATH=VALUE over the shot file's, YAML value; repeatable")
        ->allow_extra_args(false);
}

void Parser::add_device(CLI::App* app) {
    app->add_option("--device", raw_.device, "auto, cpu, hiprt, hiprt:N (a GPU by number) or hiprt:N,M (render: frames are dealt out to several)")->capture_default_str();
    app->add_option("--threads", raw_.threads, "threads of the CPU (default: all)");
}

void Parser::add_overrides(CLI::App* app) {
    add_set(app);
    app->add_option("--samples", raw_.samples, "samples a pixel; the most, with --max-error or a time budget");
    app->add_option("--size", raw_.size, "WIDTHxHEIGHT in pixels");
    add_device(app);
}

void Parser::add_render() {
    CLI::App* app = add(Command::render, "render", "render all frames, then the video; complete frames are kept",
                        "kadr render shots/turntable.yaml --frames 1-24x2,40 --samples 16 --video draft.mp4");
    RenderOptions& options = invocation_.render;
    add_shot(app);
    app->add_option("--frames", options.overrides.frames, "frames to render: 1-24x2,40");
    app->add_option("--output", options.overrides.output, "pattern of the frames' files: out/{name}.{frame:04}.png");
    app->add_option("--video", options.overrides.video, "video file, or none");
    app->add_option("--default-video", options.default_video,
                    "video file where neither the shot nor --video names one; {name} is the shot's name");
    add_overrides(app);
    app->add_option("--quality", options.overrides.quality, "draft, preview, final or reference: `kadr describe quality`");
    app->add_option("--max-error", options.overrides.max_error,
                    "sample each pixel until its standard error on the display (0 to 1) is below this: 0.01");
    app->add_option("--time-budget", options.overrides.time_budget, "wall time for a frame: 20s");
    app->add_option("--time-budget-shot", raw_.time_budget_shot, "wall time for all frames, dealt by difficulty: 90s, 10m, 2h");
    app->add_flag("--overwrite", options.overwrite, "render frames that are complete, too");
    app->add_flag("--stats", invocation_.stats, "print what the device counted for each frame");
    app->add_flag("--json", invocation_.json, "one JSON object a line");
}

void Parser::add_preview() {
    CLI::App* app = add(Command::preview, "preview", "one picture at preview quality: a frame, or how the shot moves",
                        "kadr preview shots/turntable.yaml --frame 42 --output still.png\n"
                        "  kadr preview shots/turntable.yaml --sheet 4x3        (twelve frames side by side)\n"
                        "  kadr preview shots/spin.yaml --onion --frames 0-12x3 (what moves, as ghosts in one picture)\n"
                        "  kadr preview shots/pan.yaml --path --frame 24        (the ways of camera, target and objects)\n"
                        "  kadr preview shots/pan.yaml --path --from top        (the same, and the camera, from above)");
    add_shot(app);
    app->add_option("--frame", raw_.frame, "number of the frame (default: the shot's first)");
    app->add_option("--time", raw_.time, "time in seconds instead: 1.75s");
    app->add_option("--sheet", raw_.sheet, "COLUMNSxROWS frames on a contact sheet; --size is that of a tile");
    app->add_flag("--onion", raw_.onion, "frames overlaid: what moves, from early (warm) to late (cool)");
    app->add_flag("--path", raw_.path, "the paths of camera, target and objects over a frame; thick: the shutter is open");
    app->add_option("--from", raw_.from, "where --path is seen from: camera, side, top or iso (default: camera)");
    app->add_option("--frames", raw_.frames, "frames of --sheet, --onion and --path: 0-95 or 0-40x5 (default: the shot's)");
    app->add_option("--output", invocation_.preview.output,
                    "image file (default: NAME.FRAME.preview.png, NAME.sheet.png, NAME.onion.png, NAME.FRAME.path.png)");
    add_overrides(app);
    app->add_flag("--stats", invocation_.stats, "print what the device counted");
    app->add_flag("--json", invocation_.json, "one JSON object a line");
}

void Parser::add_check() {
    CLI::App* app = add(Command::check, "check", "all that can be known before rendering; writes nothing",
                        "kadr check shots/turntable.yaml shots/pan.yaml --verbose");
    app->add_option("SHOT", raw_.shots, kShotHelp)->required();
    add_set(app);
    app->add_flag("--verbose", invocation_.verbose, "print the timeline: frames, shutter, tracks, cuts");
    app->add_flag("--json", invocation_.json, "one JSON object a line");
}

void Parser::add_explain() {
    CLI::App* app = add(Command::explain, "explain", "what a shot needs and why, what is left out of its files, and what it will take",
                        "kadr explain shots/turntable.yaml --json");
    add_shot(app);
    app->add_option("--frames", invocation_.render.overrides.frames, "frames to look at: 1-24x2,40 (default: the shot's)");
    add_overrides(app);
    app->add_option("--quality", invocation_.render.overrides.quality, "draft, preview, final or reference: `kadr describe quality`");
    app->add_flag("--measure", invocation_.trial, "render a little of the middle frame, to say how long a frame takes");
    app->add_flag("--json", invocation_.json, "as a JSON object");
}

void Parser::add_describe() {
    CLI::App* app = add(Command::describe, "describe", "the manual of the shot format, or of one key",
                        "kadr describe camera.focal_length");
    app->add_option("KEY", invocation_.key, "a section or a key, as in render.samples");
    app->add_flag("--json-schema", invocation_.json_schema, "the format as a JSON Schema, for editors");
}

void Parser::add_smoke() {
    CLI::App* app = add(Command::smoke, "smoke", "small quick renders with sanity checks, for continuous integration",
                        "kadr smoke shots/turntable.yaml shots/room.yaml --junit smoke.xml");
    app->add_option("SHOT", raw_.shots, kShotHelp)->required();
    app->add_option("--junit", invocation_.junit, "write the outcome as JUnit XML");
    app->add_flag("--update", invocation_.smoke.update, "write the golden images beside the shots");
    add_device(app);
}

void Parser::add_compare() {
    CLI::App* app = add(Command::compare, "compare", "how far two frames, or two sequences, are apart",
                        "kadr compare golden/pan.0012.exr output/pan/pan.0012.exr\n"
                        "  kadr compare golden shots/pan.yaml --fail-above 0.05         (renders what is missing; exit code 1 above)\n"
                        "  kadr compare a.{frame:04}.exr b.####.exr --maps maps --video maps/heat.mp4");
    CompareOptions& options = invocation_.compare;
    const char* what = "an image, a folder of images, a pattern with {frame:04}, %04d or ####, or a shot";
    app->add_option("REFERENCE", options.reference, what)->required();
    app->add_option("TEST", options.test, what)->required();
    app->add_option("--frames", raw_.frames, "frames to compare: 1-24x2,40 (default: all)");
    app->add_option("--fail-above", raw_.limits, "exit with 1 where a frame's FLIP is above this, or flip=0.05,rmse=0.01,relmse=0.1; of psnr=30 "
                                                 "and ssim=0.95: below");
    app->add_option("--maps", options.maps, "folder for the FLIP error maps, a PNG a frame");
    app->add_option("--video", options.video, "reference, test and error map side by side, a video file");
    app->add_option("--fps", raw_.fps, "frames a second of --video (default: 24)");
    app->add_option("--view", raw_.view, "how linear images (.exr) are looked at: none, srgb, agx, aces, pbr-neutral (default: srgb)");
    app->add_option("--exposure", raw_.exposure, "stops that linear images are brightened by first (default: 0)");
    app->add_option("--pixels-per-degree", raw_.pixels_per_degree,
                    fmt::format("how large the viewer sees a pixel (default: {:.6g})", options.difference.pixels_per_degree));
    add_device(app);
    app->add_flag("--json", invocation_.json, "one JSON object a line");
}

void Parser::add_compare_devices() {
    CLI::App* app = add(Command::compare_devices, "compare-devices", "whether two devices render the same",
                        "kadr compare-devices shots/turntable.yaml --size 320x180\n"
                        "  kadr compare-devices shots/spin.yaml --devices cpu,exact --frames 12 --output parity    (exit code 1 where they differ)");
    DeviceComparisonOptions& options = invocation_.compare_devices;
    add_shot(app);
    app->add_option("--devices", raw_.devices, "two of cpu, cpu:1, cpu:8 (lanes), hiprt, hiprt:N, exact (the reference in double) (default: cpu,hiprt)");
    app->add_option("--frames", invocation_.render.overrides.frames, "frames to compare: 1-24x2,40 (default: the first, the middle and the last)");
    app->add_option("--samples", raw_.samples, fmt::format("of a pixel in each replicate (default: {})", options.samples));
    app->add_option("--replicates", raw_.replicates, fmt::format("renders of every frame by each device, with other random numbers (default: {})", options.replicates));
    app->add_option("--size", raw_.size, "pixels, as in 320x180 (default: the shot's)");
    add_set(app);
    app->add_option("--output", options.output, "folder for both pictures, the maps of z and FLIP, and the report as JSON");
    app->add_option("--threads", raw_.threads, "threads of the CPU (default: all)");
    app->add_flag("--json", invocation_.json, "the report as a JSON object");
}

void Parser::add_measure() {
    CLI::App* app = add(Command::measure, "measure", "what accuracy costs in a shot: a page of curves, tables, pictures and advice",
                        "kadr measure shots/room.yaml --quick\n"
                        "  kadr measure shots/room.yaml --sweep samples,bounces --frames 0,40 --output room.measure");
    MeasureOptions& options = invocation_.measure;
    add_shot(app);
    app->add_option("--output", options.output, "folder of the report (default: NAME.measure in the working folder)");
    app->add_flag("--quick", options.quick, "smaller, fewer frames and values: under a minute for a shot such as the samples");
    app->add_option("--frames", invocation_.render.overrides.frames, "frames to measure: 0,40-41 (default: some of the shot's)");
    app->add_option("--sweep", raw_.sweep, "some of samples, bounces, integrator, motion_tolerance, motion_frames, clamp, denoise, texture, build, robust, device (default: all)");
    add_set(app);
    app->add_option("--size", raw_.size, "WIDTHxHEIGHT in pixels (default: the shot's, at most 320 pixels long, 128 with --quick)");
    add_device(app);
    app->add_flag("--json", invocation_.json, "one JSON object a line");
}

void Parser::add_info() {
    CLI::App* app = add(Command::info, "info", "what an image that Kadr wrote says about itself",
                        "kadr info output/turntable/turntable.0042.png");
    app->add_option("FILE", invocation_.file, "image file")->required();
    app->add_flag("--json", invocation_.json, "as a JSON object");
}

void Parser::add_stress() {
    CLI::App* app = add(Command::stress, "stress", "where numbers stop being right: generated shots at the extremes, against a reference in double",
                        "kadr stress --quick\n"
                        "  kadr stress distance telephoto --output far --html far/page.html");
    stress::StressOptions& options = invocation_.stress;
    app->add_option("AXIS", options.axes, "quantities to sweep (default: all)");
    app->add_flag("--quick", options.quick, "fewer values: under a minute");
    app->add_option("--output", options.output, "folder of the generated shots and of the report")->capture_default_str();
    add_device(app);
    app->add_flag("--json", invocation_.json, "one JSON object a line");
}

void Parser::add_devices() {
    CLI::App* app = add(Command::devices, "devices", "what there is to render on, what is usable and why not",
                        "kadr devices --verbose");
    app->add_flag("--verbose", invocation_.verbose,
                  "what was looked for to use a GPU, and what no GPU has shown yet");
    app->add_flag("--json", invocation_.json, "one JSON object a line");
}

CLI::App* Parser::chosen(const std::vector<std::string>& arguments) const {
    for (const std::string& argument : arguments)
        for (const auto& [command, app] : commands_)
            if (app->get_name() == argument) return app;
    return nullptr;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates, const std::string& otherwise) {
    const std::optional<std::string> nearest = nearest_name(word, candidates);
    return nearest ? fmt::format("did you mean '{}'?", *nearest) : otherwise;
}

void Parser::refuse_unknown_command(const std::vector<std::string>& arguments) const {
    std::vector<std::string> names;
    for (const auto& [command, app] : commands_) names.push_back(app->get_name());
    const std::string all = fmt::format("expected one of {}; see kadr --help", fmt::join(names, ", "));
    const auto word = std::find_if(arguments.begin(), arguments.end(),
                                   [](const std::string& argument) { return argument.rfind('-', 0) != 0; });
    if (word == arguments.end()) throw InputError("no command was given", all);
    throw InputError(fmt::format("unknown command '{}'", *word), did_you_mean(*word, names, all));
}

void Parser::refuse_unknown_option(const CLI::App& app, const std::vector<std::string>& arguments) const {
    std::vector<std::string> known{"--help"};
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    for (const std::string& argument : arguments) {
        const std::string word = argument.substr(0, argument.find('='));
        if (word.rfind("--", 0) != 0 || word == "--" || std::find(known.begin(), known.end(), word) != known.end()) continue;
        throw InputError(fmt::format("unknown option '{}' of kadr {}", word, app.get_name()),
                         did_you_mean(word, known, fmt::format("see kadr {} --help", app.get_name())));
    }
}

void Parser::refuse(const std::vector<std::string>& arguments, const CLI::ParseError& error) const {
    const CLI::App* app = chosen(arguments);
    if (!app) refuse_unknown_command(arguments);
    refuse_unknown_option(*app, arguments);
    throw InputError(error.what(), fmt::format("see kadr {} --help", app->get_name()));
}

void Parser::fill_overrides(RenderOptions& options) const {
    options.shot = raw_.shot;
    options.device.name = raw_.device;
    if (!raw_.threads.empty()) options.device.threads = parse_threads(raw_.threads);
    if (!raw_.samples.empty()) options.overrides.samples = parse_number(raw_.samples, "--samples", "expected a whole number above zero, as in --samples 64");
    for (const std::string& text : raw_.set) options.overrides.set.push_back(parse_setting(text));
    if (raw_.size.empty()) return;
    const auto [width, height] = parse_size(raw_.size);
    options.overrides.width = width;
    options.overrides.height = height;
}

/// Two options of `kadr preview` that do not go together.
struct Conflict {
    const char *first, *second, *expected;
};
constexpr const char* kOneKind = "expected one of --sheet, --onion and --path";
constexpr const char* kSeveralFrames = "several frames are shown: choose them by --frames, as in --frames 0-95";
constexpr Conflict kConflicts[] = {
    {"--frame", "--time", "expected one of them"},
    {"--sheet", "--onion", kOneKind},
    {"--sheet", "--path", kOneKind},
    {"--onion", "--path", kOneKind},
    {"--sheet", "--frame", kSeveralFrames},
    {"--sheet", "--time", kSeveralFrames},
    {"--onion", "--frame", kSeveralFrames},
    {"--onion", "--time", kSeveralFrames},
};

void check_conflicts(const CLI::App& app) {
    const auto given = [&](const char* option) { return app.count(option) > 0; };
    for (const Conflict& conflict : kConflicts)
        if (given(conflict.first) && given(conflict.second))
            throw InputError(fmt::format("{} and {} exclude each other", conflict.first, conflict.second), conflict.expected);
    if (given("--from") && !given("--path"))
        throw InputError("--from stands without --path", "--from says where --path is seen from: --path --from top");
    if (given("--frames") && !given("--sheet") && !given("--onion") && !given("--path"))
        throw InputError("--frames stands without --sheet, --onion or --path",
                         "expected --frame N for one frame; `kadr render` renders many");
}

void Parser::fill_preview() {
    const CLI::App& app = *commands_[Command::preview];
    check_conflicts(app);
    PreviewOptions& preview = invocation_.preview;
    preview.render = invocation_.render;
    if (app.count("--frame") > 0) preview.frame = parse_frame(raw_.frame);
    if (!raw_.time.empty()) preview.time_s = parse_seconds(raw_.time);
    if (!raw_.frames.empty()) preview.frames = parse_frame_list(raw_.frames);
    if (!raw_.from.empty()) preview.from = parse_viewpoint(raw_.from);
    if (raw_.onion) preview.kind = PreviewKind::onion;
    if (raw_.path) preview.kind = PreviewKind::path;
    if (app.count("--sheet") == 0) return;
    preview.kind = PreviewKind::sheet;
    std::tie(preview.columns, preview.rows) = parse_sheet(raw_.sheet);
}

void Parser::fill_compare() {
    if (!commands_[Command::compare]->parsed()) return;
    CompareOptions& compare = invocation_.compare;
    compare.device = invocation_.render.device;
    if (!raw_.frames.empty()) compare.frames = parse_frame_list(raw_.frames);
    if (commands_[Command::compare]->count("--fail-above") > 0) compare.limits = parse_limits(raw_.limits);
    if (!raw_.view.empty()) compare.difference.view.transform = parse_view(raw_.view);
    if (!raw_.fps.empty()) compare.fps = parse_fps(raw_.fps);
    if (!raw_.exposure.empty()) compare.difference.view.exposure_stops = parse_between(raw_.exposure, "--exposure", -100, 100);
    if (!raw_.pixels_per_degree.empty()) compare.difference.pixels_per_degree = parse_between(raw_.pixels_per_degree, "--pixels-per-degree", 1, 1000);
}

void Parser::fill_compare_devices() {
    if (!commands_[Command::compare_devices]->parsed()) return;
    DeviceComparisonOptions& compare = invocation_.compare_devices;
    compare.render = invocation_.render;
    if (!raw_.devices.empty()) compare.devices = parse_device_pair(raw_.devices);
    if (compare.render.overrides.samples > 0) compare.samples = compare.render.overrides.samples;
    if (compare.samples < 2) throw InputError(fmt::format("--samples is {}", compare.samples), "expected at least 2: one sample is a pixel's centre, which has no noise to compare");
    if (!raw_.replicates.empty()) compare.replicates = parse_number(raw_.replicates, "--replicates", "expected a whole number of at least 3, as in --replicates 8");
    if (compare.replicates < 3) throw InputError(fmt::format("--replicates is {}", compare.replicates), "expected a whole number of at least 3: fewer say too little about noise");
}

void Parser::fill_measure() {
    if (!commands_[Command::measure]->parsed()) return;
    invocation_.measure.render = invocation_.render;
    invocation_.measure.axes = parse_axes(raw_.sweep);
}

void Parser::fill_in() {
    fill_overrides(invocation_.render);
    if (!raw_.time_budget_shot.empty()) invocation_.render.overrides.time_budget_shot = fmt::format("{} s", parse_duration(raw_.time_budget_shot, "--time-budget-shot"));
    fill_preview();
    fill_compare();
    fill_compare_devices();
    fill_measure();
    invocation_.shots.assign(raw_.shots.begin(), raw_.shots.end());
    invocation_.smoke.shots = invocation_.shots;
    invocation_.smoke.device = invocation_.render.device;
}

Invocation Parser::parse(std::vector<std::string> arguments) {
    // Options may stand before the command, too: CLI11 wants the command first.
    const CLI::App* command = chosen(arguments);
    if (command && !arguments.empty() && arguments.front().rfind('-', 0) == 0) {
        const auto at = std::find(arguments.begin(), arguments.end(), command->get_name());
        std::rotate(arguments.begin(), at, at + 1);
    }
    try {
        app_.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::CallForHelp&) {
        invocation_.text = (command ? command->help() : app_.help());
        return invocation_;
    } catch (const CLI::CallForVersion&) {
        invocation_.text = fmt::format("kadr {}\n", kVersion);
        return invocation_;
    } catch (const CLI::ParseError& error) {
        refuse(arguments, error);
    }
    for (const auto& [name, app] : commands_)
        if (app->parsed()) invocation_.command = name;
    fill_in();
    return invocation_;
}

}  // namespace

Invocation parse_command_line(const std::vector<std::string>& arguments) { return Parser().parse(arguments); }

}  // namespace kadr
