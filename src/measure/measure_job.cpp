#include "measure/measure_job.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/cache_folder.h"
#include "base/error.h"
#include "output/atomic_file.h"
#include "output/frame_writer.h"
#include "render/frame_identity.h"
#include "render/output_plan.h"
#include "render/prepared_shot.h"

namespace kadr {

namespace {

namespace fs = std::filesystem;

// Seeds of the four images of a frame: any that differ.
constexpr std::uint32_t kReferenceSeeds[] = {3000017, 4000037}, kSeeds[] = {1000003, 2000003};

/// How much a run renders.
struct Extent {
    int longest_side;        ///< pixels; a --size of the command line wins
    int reference_samples;   ///< of each of its two images
    SweepSize sweep;
};
const Extent kFull{320, 2048, {64, {4, 16, 64, 256}, false}};
const Extent kQuick{128, 512, {16, {4, 16, 64}, true}};

/// One call of measure.
class MeasureJob {
public:
    MeasureJob(const MeasureOptions& options, const MeasureEvents& events)
        : options_(options), events_(events), extent_(options.quick ? kQuick : kFull) {}

    Measurement run() {
        const Shot shot = plan();
        render_reference(shot);
        look_at_reference();
        Sweep sweep = plan_sweep(shot.render, options_.axes, sweep_size_);
        result_.left_out = std::move(sweep.left_out);
        const int count = static_cast<int>(sweep.variants.size());
        for (int i = 0; i < count; ++i)
            if (auto measured = try_variant(sweep.variants[static_cast<std::size_t>(i)], i == 0)) {
                events_.variant_done(*measured, i + 1, count);
                result_.variants.push_back(std::move(*measured));
            }
        mark_front(result_.variants);
        result_.shares = shares_of(result_.variants);
        advise(shot);
        return std::move(result_);
    }

private:
    /// What is measured: frames and size of the shot.
    Shot plan() {
        Shot shot = parse_shot(options_.render.shot, options_.render.overrides);
        result_.shot = shot.name;
        result_.shot_width = shot.image.width, result_.shot_height = shot.image.height;
        if (options_.render.overrides.width == 0) shot.image = limited_width(shot.image, extent_.longest_side);
        result_.width = shot.image.width, result_.height = shot.image.height;
        result_.samples = extent_.sweep.samples;
        result_.reference_samples = 2 * extent_.reference_samples;
        result_.folder = fs::absolute(options_.output.empty() ? fs::path(shot.name + ".measure") : options_.output);
        prepare_folders({result_.folder});
        LoadOptions headers;
        headers.decode_textures = false;
        const LoadedShot loaded(shot, headers);
        result_.frames = chosen_frames(loaded.bound().timing().frames);
        sweep_size_ = extent_.sweep;
        for (const TextureData& texture : loaded.scene().textures) sweep_size_.largest_texture_px = std::max({sweep_size_.largest_texture_px, texture.width, texture.height});
        return shot;
    }

    /// Those of the command line; else neighbours in the middle of the shot, and without --quick its ends.
    std::vector<int> chosen_frames(const std::vector<int>& all) const {
        if (!options_.render.overrides.frames.empty() || all.size() <= 2) return all;
        const std::size_t middle = (all.size() - 1) / 2;
        std::vector<int> frames{all[middle], all[middle + 1]};
        if (!options_.quick) frames.insert(frames.end(), {all.front(), all.back()});
        std::sort(frames.begin(), frames.end());
        frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
        return frames;
    }

    /// The shot as a variant has it, rendered to EXR alone.
    Shot variant_of(const ShotOverrides& overrides, std::uint32_t seed, const std::string& pattern) const {
        Shot shot = parse_shot(options_.render.shot, overrides);
        shot.image.width = result_.width, shot.image.height = result_.height;
        shot.timing.frames = result_.frames;
        shot.frames_given = true;
        shot.render.seed = seed;
        shot.output.frames = {pattern};
        shot.output.frames_where.resize(1);
        shot.output.aovs.clear();
        shot.output.video.reset();
        return shot;
    }

    /// @param device  empty: that of the command line
    RenderSummary render(Shot shot, bool view_wanted = false, const std::string& device = "") const {
        PreparedShot prepared{std::move(shot), std::nullopt, view_wanted};
        RenderOptions options;
        options.shot = options_.render.shot;
        options.device = options_.render.device;
        if (!device.empty()) options.device.name = device;
        return render_prepared(std::move(prepared), options, events_.render);
    }

    /// In the cache by what they were made of, so that other runs find them; without a cache beside the report.
    fs::path reference_folder(const Shot& shot) const {
        const std::optional<fs::path> cache = cache_folder();
        if (!cache) return result_.folder / "reference";
        const LoadedShot loaded(shot);
        const ShotIdentity identity(loaded, result_.frames.front());
        return *cache / "references" / identity.of(loaded.bound().sequence().frame(result_.frames.front())).linear.substr(0, 16);
    }

    void render_reference(const Shot& own) {
        ShotOverrides overrides = options_.render.overrides;
        overrides.quality = "reference";
        overrides.set.emplace_back("render.samples", std::to_string(extent_.reference_samples));
        const fs::path folder = reference_folder(variant_of(overrides, kReferenceSeeds[0], "r.{frame:04}.exr"));
        std::vector<std::string> patterns;
        for (const char* half : {"r1", "r2"}) {
            patterns.push_back((folder / half).string() + ".{frame:04}.exr");
            const RenderSummary summary = render(variant_of(overrides, kReferenceSeeds[patterns.size() - 1], patterns.back()), true);
            metered_ = summary.view;
            result_.device = summary.device;
        }
        for (const int frame : result_.frames) {
            const fs::path r1 = frame_path(patterns[0], frame), r2 = frame_path(patterns[1], frame);
            references_.push_back({read_stored(r1), read_stored(r2)});
            result_.references.insert(result_.references.end(), {r1, r2});
            result_.reference_noise += noise_of_mean(references_.back()) / static_cast<double>(result_.frames.size());
        }
        result_.reference_picture = write_picture("reference", mean_of(references_.front()).image, view_of(own, 0));
    }

    /// What the reference tells of the choices that there are.
    void look_at_reference() {
        sweep_size_.moves = std::any_of(result_.references.begin(), result_.references.end(), [](const fs::path& image) {
            const Metadata metadata = describe_image(image);
            const auto frames = metadata.find("motion_frames");
            return frames != metadata.end() && frames->second != "0" && frames->second != "1";
        });
        for (const DeviceReport& device : list_devices())
            sweep_size_.devices.push_back({device.name, device.usable ? "" : device.reason, result_.device.starts_with(device.name + " ") || result_.device.starts_with(device.name + ":")});
    }

    /// How a frame is looked at: an automatic exposure is the reference's.
    ViewSpec view_of(const Shot& own, std::size_t frame) const {
        if (own.view.automatic) return metered_;
        return view_at(own.view, (result_.frames[frame] - own.timing.first) / own.timing.fps.value());
    }

    /// Nothing where the shot cannot be rendered so: the reason is kept. The shot's own settings have to work.
    std::optional<MeasuredVariant> try_variant(const Variant& variant, bool must_work) {
        try {
            return measure_variant(variant);
        } catch (const InputError& error) {
            if (must_work) throw;
            result_.left_out.push_back({variant.axis + " " + variant.value, error.diagnostics().front().found});
            return std::nullopt;
        }
    }

    MeasuredVariant measure_variant(const Variant& variant) const {
        ShotOverrides overrides = options_.render.overrides;
        overrides.set.insert(overrides.set.end(), variant.set.begin(), variant.set.end());
        std::vector<std::string> patterns;
        for (const std::uint32_t seed : kSeeds) {
            patterns.push_back((result_.folder / "images" / variant.id() / fmt::format("s{}", patterns.size() + 1)).string() + ".{frame:04}.exr");
            render(variant_of(overrides, seed, patterns.back()), false, variant.device);
        }
        return figures(variant, patterns, parse_shot(options_.render.shot, overrides));
    }

    MeasuredVariant figures(const Variant& variant, const std::vector<std::string>& patterns, const Shot& shot) const {
        MeasuredVariant measured{variant, {}, 0, {}, {}, false, {}, {}};
        std::vector<Replicates> images;
        for (std::size_t i = 0; i < result_.frames.size(); ++i) {
            const int number = result_.frames[i];
            MeasuredFrame frame{number, 0, {}, {}, frame_path(patterns[0], number), frame_path(patterns[1], number)};
            images.push_back({read_stored(frame.a), read_stored(frame.b)});
            DifferenceOptions look;
            look.view = view_of(shot, i);
            frame.error = error_of(references_[i], images[i], look);
            frame.seconds = std::min(seconds_of(frame.a), seconds_of(frame.b));  // what else the machine did only adds to it
            if (i > 0 && number == result_.frames[i - 1] + 1)
                measured.frames.back().flicker = flicker(mean_of(references_[i - 1]), mean_of(references_[i]), images[i - 1].a, images[i].a, look.view);
            measured.frames.push_back(std::move(frame));
        }
        average(measured);
        draw(measured, images.front(), view_of(shot, 0));
        return measured;
    }

    static double seconds_of(const fs::path& image) {
        const Metadata metadata = describe_image(image);
        const auto found = metadata.find("seconds");
        return found == metadata.end() ? 0 : std::stod(found->second);
    }

    static void average(MeasuredVariant& measured) {
        const double count = static_cast<double>(measured.frames.size());
        measured.error.ssim = 0;
        double flicker_sum = 0;
        int pairs = 0;
        for (const MeasuredFrame& frame : measured.frames) {
            measured.seconds += frame.seconds / count;
            measured.error.relmse += frame.error.relmse / count;
            measured.error.noise += frame.error.noise / count;
            measured.error.bias += frame.error.bias / count;
            measured.error.flip += frame.error.flip / count;
            measured.error.ssim += frame.error.ssim / count;
            if (frame.flicker) flicker_sum += *frame.flicker, ++pairs;
        }
        if (pairs > 0) measured.flicker = flicker_sum / pairs;
    }

    fs::path write_picture(const std::string& name, const Image& linear, const ViewSpec& view) const {
        const fs::path file = result_.folder / "pictures" / (name + ".png");
        write_frame(file, linear, view, 8, {{"picture", name}});
        return file;
    }

    void draw(MeasuredVariant& measured, const Replicates& images, const ViewSpec& view) const {
        DifferenceOptions look;
        look.view = view;
        const ShownDifference shown = difference_between(mean_of(references_.front()), images.a, look);
        measured.picture = write_picture(measured.variant.id(), images.a.image, view);
        measured.map = result_.folder / "pictures" / (measured.variant.id() + ".flip.png");
        ViewSpec as_it_is;
        as_it_is.transform = ViewTransform::none;
        write_frame(measured.map, image_io().heat_map(shown.flip), as_it_is, 8, {{"flip", measured.variant.id()}});
    }

    void advise(const Shot& shot) {
        result_.recommendation = recommend(result_.variants, shot.render, extent_.sweep.samples);
        Variant variant{"recommended", "", {}};
        for (const auto& [key, value] : result_.recommendation.render) variant.set.emplace_back("render." + key, value);
        result_.recommendation.measured = measure_variant(variant);
    }

    const MeasureOptions& options_;
    const MeasureEvents& events_;
    const Extent& extent_;
    SweepSize sweep_size_;
    Measurement result_;
    ViewSpec metered_;   ///< the reference's, where the exposure is automatic
    std::vector<Replicates> references_;
};

}  // namespace

Measurement measure(const MeasureOptions& options, const MeasureEvents& events) { return MeasureJob(options, events).run(); }

}  // namespace kadr
