#include "render/smoke.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "output/flip.h"
#include "output/frame_writer.h"
#include "output/image_io.h"
#include "output/view.h"
#include "render/environment_image.h"
#include "render/frame_renderer.h"
#include "render/image_checks.h"
#include "render/loaded_shot.h"
#include "render/reel_plan.h"
#include "render/stopwatch.h"
#include "shot/shot_parser.h"

namespace kadr {
namespace fs = std::filesystem;

namespace {

constexpr int kSmokeWidth = 160;
constexpr int kFewestSamples = 8, kMostSamples = 16;
constexpr std::uint32_t kGoldenSeed = 1, kOtherSeed = 2;
// An image of one seed may differ from its golden image by what another seed differs from it, and half as much again.
constexpr double kSeedTolerance = 1.5;
// Noise-free frames: golden images have 8 bits, and another compiler's last bit can turn one code value of an edge pixel.
constexpr double kQuantisation = 0.002;

Shot smoke_shot(const fs::path& file, std::uint32_t seed) {
    Shot shot = parse_shot(file);
    shot.image = limited_width(shot.image, kSmokeWidth);
    // The analytic model is free of noise with one sample already.
    const int fewest = shot.render.integrator == Integrator::direct ? 1 : kFewestSamples;
    shot.render.fix_samples(std::clamp(shot.render.samples, fewest, kMostSamples));
    shot.render.seed = seed;
    return shot;
}

std::vector<int> first_middle_last(const std::vector<int>& frames) {
    const std::set<int> chosen{frames.front(), frames[frames.size() / 2], frames.back()};
    return {chosen.begin(), chosen.end()};
}

Image as_stored(const Image& display) {
    Image stored = display;
    for (float& value : stored.pixels) value = std::round(value * 255.0f) / 255.0f;
    return stored;
}

Image colors_of(const Image& image) {
    Image colors{image.width, image.height, {"R", "G", "B"}, {}};
    const std::size_t channels = image.channels.size();
    for (std::size_t i = 0; i < image.pixels.size(); i += channels)
        for (std::size_t c = 0; c < 3; ++c) colors.pixels.push_back(image.pixels[i + std::min(c, channels - 1)]);
    return colors;
}

/// One shot, once with each seed; the scene and the device are shared.
class SmokeShot {
public:
    SmokeShot(const fs::path& file, const DeviceRequest& request)
        : loaded_(smoke_shot(file, kGoldenSeed)),
          other_seed_(smoke_shot(file, kOtherSeed)),
          other_bound_(other_seed_, loaded_.scene()),
          choice_(make_device(request)),
          renderer_(*choice_.device),
          view_(loaded_.shot().view) {
        load_device(*choice_.device, loaded_);
        const std::vector<int>& frames = loaded_.bound().timing().frames;
        if (view_.automatic)
            view_.exposure_stops = meter_exposure(loaded_.shot(), loaded_.scene(), renderer_, time_of(frames.front()));
        view_.automatic = false;
    }

    const std::string& name() const { return loaded_.shot().name; }
    std::vector<int> frames() const { return first_middle_last(loaded_.bound().timing().frames); }

    SmokeCase run(int frame, bool update) {
        const Stopwatch watch;
        SmokeCase result;
        result.shot = name();
        result.frame = frame;
        const Image linear = renderer_.render(loaded_.bound(), time_of(frame), {}).image;
        result.failures = obvious_faults(linear);
        const fs::path golden = golden_file(frame);
        if (update && result.failures.empty()) {
            write_display(golden, display(linear, frame));
            result.updated = true;
        } else if (fs::exists(golden)) {
            compare(result, golden, display(linear, frame));
        }
        result.seconds = watch.seconds();
        return result;
    }

private:
    FrameTime time_of(int frame) const { return loaded_.bound().sequence().frame(frame); }
    Image display(const Image& linear, int frame) const {
        return as_stored(colors_of(apply_view(linear, view_at(view_, time_of(frame).time_s()), false)));
    }

    fs::path golden_file(int frame) const {
        return fs::absolute(loaded_.shot().file).parent_path() / "golden" / fmt::format("{}.{:04}.png", name(), frame);
    }

    /// Writes values that are display-referred already, so that they come back as they are.
    void write_display(const fs::path& file, const Image& image) const {
        ViewSpec as_it_is;
        as_it_is.transform = ViewTransform::none;
        fs::create_directories(file.parent_path());
        write_frame(file, image, as_it_is, 8, {{"shot", name()}});
    }

    void compare(SmokeCase& result, const fs::path& golden, const Image& rendered) {
        const Image reference = colors_of(image_io().read(golden));
        if (reference.width != rendered.width || reference.height != rendered.height) {
            result.failures.push_back(fmt::format("the golden image {} is {}x{}, the frame {}x{}; render it anew with --update",
                                                  golden.string(), reference.width, reference.height, rendered.width,
                                                  rendered.height));
            return;
        }
        const Image other = display(renderer_.render(other_bound_, time_of(result.frame), {}).image, result.frame);
        result.compared = true;
        result.flip = mean_flip(reference, rendered);
        result.tolerance = kSeedTolerance * mean_flip(rendered, other) + kQuantisation;
        if (result.flip <= result.tolerance) return;
        const fs::path evidence = write_evidence(result.frame, rendered);
        result.failures.push_back(fmt::format("mean FLIP {:.4f} against {} is above {:.4f}; the frame is in {}", result.flip,
                                              golden.string(), result.tolerance, evidence.string()));
    }

    fs::path write_evidence(int frame, const Image& rendered) const {
        const fs::path file = fs::path("output/smoke") / fmt::format("{}.{:04}.png", name(), frame);
        write_display(file, rendered);
        return fs::absolute(file);
    }

    LoadedShot loaded_;
    Shot other_seed_;
    BoundShot other_bound_;
    DeviceChoice choice_;
    FrameRenderer renderer_;
    ViewSpec view_;
};

SmokeCase failed_shot(const fs::path& file, std::string reason, bool bad_input) {
    SmokeCase result;
    result.shot = file.string();
    result.failures.push_back(std::move(reason));
    result.bad_input = bad_input;
    return result;
}

std::string all_texts(const InputError& error) {
    std::string text;
    for (const Diagnostic& diagnostic : error.diagnostics()) text += diagnostic.text() + "\n";
    return text;
}

/// A reel is checked; its pictures are those of its shots.
SmokeCase checked_reel(const fs::path& file) {
    check_reel(file, {});
    SmokeCase result;
    result.shot = file.string();
    result.skipped = "a reel: it is checked, and its shots are rendered as files of their own";
    return result;
}

void smoke_one(const fs::path& file, const SmokeOptions& options, const std::function<void(SmokeCase)>& add) {
    try {
        if (is_reel(file)) return add(checked_reel(file));
        SmokeShot shot(file, options.device);
        for (const int frame : shot.frames()) add(shot.run(frame, options.update));
    } catch (const InputError& error) {
        add(failed_shot(file, all_texts(error), true));
    }
}

std::string xml_escaped(const std::string& text) {
    std::string escaped;
    for (const char letter : text) switch (letter) {
            case '&': escaped += "&amp;"; break;
            case '<': escaped += "&lt;"; break;
            case '>': escaped += "&gt;"; break;
            case '"': escaped += "&quot;"; break;
            default:
                // XML 1.0 has no control characters but these three.
                if (static_cast<unsigned char>(letter) >= 0x20 || letter == '\n' || letter == '\t' || letter == '\r')
                    escaped += letter;
        }
    return escaped;
}

std::string junit_case(const SmokeCase& result) {
    std::string xml = fmt::format("  <testcase classname=\"{}\" name=\"frame {}\" time=\"{:.3f}\">\n",
                                  xml_escaped(result.shot), result.frame, result.seconds);
    for (const std::string& failure : result.failures)
        xml += fmt::format("    <failure message=\"{}\"/>\n", xml_escaped(failure));
    if (!result.skipped.empty()) xml += fmt::format("    <skipped message=\"{}\"/>\n", xml_escaped(result.skipped));
    return xml + "  </testcase>\n";
}

}  // namespace

std::vector<SmokeCase> smoke(const SmokeOptions& options, const std::function<void(const SmokeCase&)>& done) {
    open_image_io_in_background();
    std::vector<SmokeCase> cases;
    for (const fs::path& file : options.shots)
        smoke_one(file, options, [&](SmokeCase result) {
            done(result);
            cases.push_back(std::move(result));
        });
    return cases;
}

std::string junit_xml(const std::vector<SmokeCase>& cases) {
    const auto failures = std::count_if(cases.begin(), cases.end(), [](const SmokeCase& c) { return !c.failures.empty(); });
    std::string xml = fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"kadr smoke\" tests=\"{}\" failures=\"{}\">\n",
                                  cases.size(), failures);
    for (const SmokeCase& result : cases) xml += junit_case(result);
    return xml + "</testsuite>\n";
}

}  // namespace kadr
