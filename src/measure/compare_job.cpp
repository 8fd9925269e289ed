#include "measure/compare_job.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text.h"
#include "measure/difference_picture.h"
#include "output/encoder.h"
#include "output/frame_writer.h"
#include "render/frame_identity.h"
#include "render/output_plan.h"
#include "render/reel_plan.h"

namespace kadr {
namespace {

namespace fs = std::filesystem;

struct MetricEntry {
    const char* name;
    double (*value)(const FrameDifference&);
};
/// [Metric]
constexpr std::array<MetricEntry, 5> kMetrics{{{"flip", [](const FrameDifference& d) { return d.flip; }},
                                               {"rmse", [](const FrameDifference& d) { return d.values.rms; }},
                                               {"relmse", [](const FrameDifference& d) { return d.relmse; }},
                                               {"psnr", [](const FrameDifference& d) { return d.values.psnr_db; }},
                                               {"ssim", [](const FrameDifference& d) { return d.ssim; }}}};

Limit parse_limit(const std::string& text) {
    const std::size_t at = text.find('=');
    const std::string name = at == std::string::npos ? "flip" : text.substr(0, at),
                      number = at == std::string::npos ? text : text.substr(at + 1);
    const auto entry =
        std::find_if(kMetrics.begin(), kMetrics.end(), [&](const MetricEntry& each) { return name == each.name; });
    std::size_t used = 0;
    double value = 0;
    try {
        value = std::stod(number, &used);
    } catch (const std::exception&) {
        used = 0;
    }
    if (entry == kMetrics.end() || used != number.size() || number.empty() || !std::isfinite(value) || value < 0)
        throw InputError(fmt::format("--fail-above is '{}'", text),
                         "expected flip, rmse, relmse, psnr or ssim and a number of at least 0, as in --fail-above "
                         "flip=0.05,psnr=30; a number alone is FLIP's");
    return {static_cast<Metric>(entry - kMetrics.begin()), value};
}

bool is_shot(const std::string& text) {
    const std::string ending = fs::path(text).extension().string();
    return ending == ".yaml" || ending == ".yml";
}

std::string as_list(const std::vector<int>& frames) { return fmt::format("{}", fmt::join(frames, ",")); }

/// One call of compare.
class Comparison {
public:
    Comparison(const CompareOptions& options, const CompareEvents& events) : options_(options), events_(events) {}

    CompareSummary run() {
        open_image_io_in_background();
        const FrameSequence reference = find(options_.reference), test = find(options_.test);
        const std::vector<FramePair> pairs = pair_frames(reference, test, options_.frames);
        check_outputs(pairs);
        render(options_.reference);
        render(options_.test);
        for (const FramePair& pair : pairs) compare_pair(pair);
        if (encoder_) encoder_->finish();
        summarise();
        return std::move(summary_);
    }

private:
    RenderOptions render_options(const std::string& shot) const {
        RenderOptions render;
        render.shot = shot;
        render.overrides.frames = as_list(options_.frames);
        render.overrides.video = "none";
        render.device = options_.device;
        return render;
    }

    /// The images of one side; those of a shot need not be there yet.
    FrameSequence find(const std::string& text) const {
        if (!is_shot(text)) return find_frames(text);
        if (is_reel(text))
            throw InputError(
                fmt::format("'{}' is a reel, and compare takes a shot, images, a folder or a pattern", text),
                "compare the images that its output.frames names");
        const RenderOptions render = render_options(text);
        const Shot shot = parse_shot(render.shot, render.overrides);
        std::vector<fs::path> files;
        for (const int frame : shot.timing.frames) files.push_back(best_of(frame_files(shot.output, frame)));
        if (files.empty())
            throw InputError(fmt::format("the shot '{}' writes no frames", text),
                             "expected output.frames in it, a pattern such as ../output/{name}/{name}.{frame:04}.exr");
        FrameSequence sequence{text, {}, false};
        for (std::size_t i = 0; i < files.size(); ++i)
            sequence.files.push_back({files[i], shot.name, shot.timing.frames[i]});
        return sequence;
    }

    /// Linear light says more than what a display shows of it.
    static fs::path best_of(const std::vector<fs::path>& files) {
        const auto linear = std::find_if(files.begin(), files.end(), is_linear_file);
        return linear == files.end() ? files.front() : *linear;
    }

    void render(const std::string& text) const {
        if (is_shot(text)) render_shot(render_options(text), events_.render);
    }

    /// Before the first ray: two shots that would overwrite each other's frames, folders that cannot be written to.
    void check_outputs(const std::vector<FramePair>& pairs) {
        for (const FramePair& pair : pairs)
            if (is_shot(options_.reference) && is_shot(options_.test) && pair.reference == pair.test)
                throw InputError(
                    fmt::format("'{}' and '{}' both write '{}'", options_.reference, options_.test, pair.test.string()),
                    "expected output.frames of different files");
        std::vector<fs::path> folders;
        if (!options_.maps.empty()) folders.push_back(fs::absolute(options_.maps));
        if (!options_.video.empty()) folders.push_back(fs::absolute(options_.video).parent_path());
        for (const fs::path& folder : folders)
            if (const std::string reason = why_not_writable(folder); !reason.empty())
                throw InputError(fmt::format("cannot write to '{}': {}", folder.string(), reason));
        prepare_folders(folders);
    }

    void compare_pair(const FramePair& pair) {
        if (interrupt_requested()) throw Interrupted();
        const StoredImage reference = read_stored(pair.reference), test = read_stored(pair.test);
        ComparedFrame frame{pair, {}, {}, {}};
        const ShownDifference shown = difference(pair, reference, test);
        frame.difference = shown.difference;
        frame.failures = failures_of(frame.difference);
        if (!options_.maps.empty()) frame.map = write_map(pair, shown.flip);
        if (!options_.video.empty()) push(difference_picture(shown, pair.label));
        events_.frame_done(frame);
        summary_.frames.push_back(std::move(frame));
    }

    ShownDifference difference(const FramePair& pair, const StoredImage& reference, const StoredImage& test) const {
        if (reference.image.width == test.image.width && reference.image.height == test.image.height)
            return difference_between(reference, test, options_.difference);
        throw InputError(
            fmt::format("'{}' has {}x{} pixels and '{}' {}x{}", pair.reference.string(), reference.image.width,
                        reference.image.height, pair.test.string(), test.image.width, test.image.height),
            "expected images of the same size");
    }

    std::vector<std::string> failures_of(const FrameDifference& difference) const {
        std::vector<std::string> failures;
        if (options_.limits.empty()) return failures;
        if (difference.not_finite > 0)
            failures.push_back(fmt::format("{} pixels hold NaN or infinity", difference.not_finite));
        for (const Limit& limit : options_.limits) {
            const double value = value_of(difference, limit.metric);
            const bool good =
                more_is_better(limit.metric) ? value >= limit.value : value <= limit.value;  // not so for NaN
            if (!good)
                failures.push_back(fmt::format("{} {:.4g} is {} {}", name_of(limit.metric), value,
                                               more_is_better(limit.metric) ? "below" : "above",
                                               format_number(limit.value)));
        }
        return failures;
    }

    fs::path write_map(const FramePair& pair, const Image& flip) const {
        ViewSpec as_it_is;
        as_it_is.transform = ViewTransform::none;
        const std::string name = pair.number ? fmt::format("flip.{:04}.png", *pair.number)
                                             : fmt::format("{}.flip.png", pair.test.stem().string());
        const fs::path file = options_.maps / name;
        write_frame(file, image_io().heat_map(flip), as_it_is, 8,
                    {{"flip", pair.label}, {"reference", pair.reference.string()}, {"test", pair.test.string()}});
        return file;
    }

    void push(const Image& picture) {
        if (!encoder_) {
            VideoSpec spec;
            spec.file = fs::absolute(options_.video);
            encoder_ = std::make_unique<Encoder>(plan_video(spec, picture.width, picture.height, options_.fps));
            summary_.video = spec.file;
        }
        encoder_->push(picture);
    }

    void summarise() {
        FrameDifference& mean = summary_.mean;
        mean.ssim = 0;
        const double count = static_cast<double>(summary_.frames.size());
        for (std::size_t i = 0; i < summary_.frames.size(); ++i) {
            const FrameDifference& each = summary_.frames[i].difference;
            mean.values.mean += each.values.mean / count;
            mean.values.rms += each.values.rms / count;
            mean.values.psnr_db += each.values.psnr_db / count;
            mean.values.largest = std::max(mean.values.largest, each.values.largest);
            mean.relmse += each.relmse / count;
            mean.ssim += each.ssim / count;
            mean.flip += each.flip / count;
            mean.not_finite += each.not_finite;
            if (each.flip > summary_.frames[summary_.worst].difference.flip) summary_.worst = i;
            summary_.failed = summary_.failed || !summary_.frames[i].failures.empty();
        }
    }

    const CompareOptions& options_;
    const CompareEvents& events_;
    std::unique_ptr<Encoder> encoder_;
    CompareSummary summary_;
};

}  // namespace

std::string name_of(Metric metric) { return kMetrics[static_cast<std::size_t>(metric)].name; }

double value_of(const FrameDifference& difference, Metric metric) {
    return kMetrics[static_cast<std::size_t>(metric)].value(difference);
}

std::vector<Limit> parse_limits(const std::string& text) {
    std::vector<Limit> limits;
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) limits.push_back(parse_limit(part));
    if (limits.empty() || text.back() == ',') limits.push_back(parse_limit(""));
    return limits;
}

CompareSummary compare(const CompareOptions& options, const CompareEvents& events) {
    return Comparison(options, events).run();
}

}  // namespace kadr
