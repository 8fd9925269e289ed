#include "measure/device_comparison.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "device/exact/exact_device.h"
#include "kernels/sampler/sobol.h"
#include "output/atomic_file.h"
#include "output/frame_writer.h"
#include "render/environment_image.h"
#include "render/frame_renderer.h"
#include "render/output_plan.h"
#include "render/reel_plan.h"
#include "render/stopwatch.h"

namespace kadr {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNames = "expected two of cpu, cpu:1, cpu:8, hiprt, hiprt:N and exact, as in --devices cpu,hiprt";

bool is_name(const std::string& name) {
    if (name == "cpu" || name == "cpu:1" || name == "cpu:8" || name == "hiprt" || name == "exact") return true;
    return name.starts_with("hiprt:") && name.size() > 6 &&
           name.find_first_not_of("0123456789", 6) == std::string::npos;
}

std::vector<int> first_middle_last(const std::vector<int>& frames) {
    const std::set<int> some{frames.front(), frames[frames.size() / 2], frames.back()};
    return {some.begin(), some.end()};
}

/// Both devices draw other random numbers in every replicate.
unsigned seed_of(unsigned seed, int replicate, int device) {
    return seed ^ kernels::mix_bits(static_cast<unsigned>(2 * replicate + device + 1) * 0x9e3779b9u);
}

/// A device, its renderer and what both take.
struct Side {
    std::string name;
    std::unique_ptr<Device> device;
    std::optional<FrameRenderer> renderer;
    double load_s = 0;
};

/// What one device makes of a frame.
struct Rendered {
    ReplicateSums all, even, odd;
    DeviceTimes times;
    std::uint64_t dropped = 0;
};

/// One call of compare_devices.
class DeviceComparer {
public:
    DeviceComparer(const DeviceComparisonOptions& options,
                   const std::function<void(const ComparedDeviceFrame&)>& frame_done)
        : options_(options), frame_done_(frame_done), loaded_(parse(options)) {}

    DeviceComparison run() {
        open_image_io_in_background();
        prepare_output();
        load(0, options_.devices.first);
        load(1, options_.devices.second);
        begin_report();
        find_view();
        const std::vector<int>& all = loaded_.bound().timing().frames;
        for (const int frame : options_.render.overrides.frames.empty() ? first_middle_last(all) : all) {
            report_.frames.push_back(compare(frame));
            frame_done_(report_.frames.back());
        }
        write_json();
        return std::move(report_);
    }

private:
    static Shot parse(const DeviceComparisonOptions& options) {
        if (is_reel(options.render.shot))
            throw InputError(fmt::format("{} is a reel", options.render.shot.string()),
                             "expected a shot: kadr compare-devices renders one of its shots at a time");
        ShotOverrides overrides = options.render.overrides;
        overrides.samples = options.samples;
        overrides.set.emplace_back("render.denoise", "none");  // what is compared is the noise
        return parse_shot(options.render.shot, overrides);
    }

    void prepare_output() const {
        if (options_.output.empty()) return;
        const fs::path folder = fs::absolute(options_.output);
        if (const std::string reason = why_not_writable(folder); !reason.empty())
            throw InputError(fmt::format("cannot write to '{}': {}", folder.string(), reason));
        prepare_folders({folder});
    }

    void load(int i, const std::string& name) {
        Side& side = sides_[i];
        side.name = name;
        side.device = options_.make ? options_.make(name, loaded_)
                                    : make_compared_device(name, loaded_, options_.render.device.threads);
        const Stopwatch watch;
        load_device(*side.device, loaded_);
        side.load_s = watch.seconds();
        side.renderer.emplace(*side.device);
    }

    void begin_report() {
        const Shot& shot = loaded_.shot();
        report_.shot = options_.render.shot.string();
        for (int i = 0; i < 2; ++i) {
            report_.names[i] = sides_[i].name;
            report_.devices[i] = sides_[i].device->name();
        }
        report_.width = shot.image.width;
        report_.height = shot.image.height;
        report_.samples = options_.samples;
        report_.replicates = options_.replicates;
    }

    ComparedDeviceFrame compare(int number) {
        const FrameTime time = loaded_.bound().sequence().frame(number);
        const std::vector<SceneSnapshot> parts = make_snapshots(loaded_.bound(), time);
        ComparedDeviceFrame frame;
        frame.frame = number;
        const Rendered first = render(0, parts), second = render(1, parts);
        frame.times[0] = first.times;
        frame.times[1] = second.times;
        frame.dropped[0] = first.dropped;
        frame.dropped[1] = second.dropped;
        frame.rays = trace(parts);
        frame.noise = compare_replicates(first.all, second.all, options_.samples);
        compare_pictures(frame, first, second, time);
        return frame;
    }

    Rendered render(int i, std::vector<SceneSnapshot> parts) {
        Rendered rendered;
        rendered.times.load_s = sides_[i].load_s;
        const unsigned seed = parts.front().settings.seed;
        for (int r = 0; r < options_.replicates; ++r) {
            for (SceneSnapshot& part : parts) part.settings.seed = seed_of(seed, r, i);
            const RenderedFrame frame = sides_[i].renderer->render(loaded_.bound(), std::make_shared<const std::vector<SceneSnapshot>>(parts), {});
            rendered.all.add(frame.image);
            (r % 2 == 0 ? rendered.even : rendered.odd).add(frame.image);
            if (r == 0) rendered.times.set_frame_s = frame.statistics.set_frame_s;
            rendered.times.render_s += frame.statistics.render_s;
            rendered.times.rays += frame.statistics.rays;
            rendered.dropped += frame.statistics.dropped_samples;
        }
        return rendered;
    }

    RayAgreement trace(const std::vector<SceneSnapshot>& parts) {
        RayAgreement sum;
        const bool exact = sides_[0].name == "exact" || sides_[1].name == "exact";
        for (const SceneSnapshot& part : parts) {
            for (Side& side : sides_) side.device->set_frame(part);
            const double motion_error_px = exact ? part.motion.max_error_px + part.camera_error_px : 0;
            sum = sum + compare_rays(loaded_.bound(), *sides_[0].device, *sides_[1].device, part, motion_error_px);
        }
        return sum;
    }

    void compare_pictures(ComparedDeviceFrame& frame, const Rendered& first, const Rendered& second,
                          const FrameTime& time) {
        const Image a = first.all.mean(), b = second.all.mean();
        DifferenceOptions options;
        options.view = view_at(view_, time.time_s());
        const ShownDifference shown = difference_between({a, true}, {b, true}, options);
        frame.pictures = shown.difference;
        frame.noise_alone = difference_between({first.even.mean(), true}, {first.odd.mean(), true}, options).difference;
        if (options_.output.empty()) return;
        write(frame, name_of(0) + ".exr", a);
        write(frame, name_of(1) + ".exr", b);
        write(frame, "flip.png", image_io().heat_map(shown.flip));
        write(frame, "z.png", z_picture(frame.noise, a.width, a.height));
    }

    /// The shot's; automatic exposure is metered by the first device.
    void find_view() {
        view_ = loaded_.shot().view;
        if (!view_.automatic) return;
        const FrameTime first = loaded_.bound().sequence().frame(loaded_.bound().timing().frames.front());
        view_.exposure_stops = meter_exposure(loaded_.shot(), loaded_.scene(), *sides_[0].renderer, first);
        view_.automatic = false;
    }

    /// |z| from 0 (black) to 8.
    static Image z_picture(const ZTest& test, int width, int height) {
        Image values{width, height, {"Y"}, test.z};
        for (float& z : values.pixels) z = std::min(std::abs(z) / 8, 1.0f);
        return image_io().heat_map(values);
    }

    /// Of a device, in file names.
    std::string name_of(int i) const {
        std::string name = sides_[i].name;
        std::replace(name.begin(), name.end(), ':', '-');
        return sides_[0].name == sides_[1].name ? fmt::format("{}.{}", name, i + 1) : name;
    }

    void write(ComparedDeviceFrame& frame, const std::string& ending, const Image& image) const {
        ViewSpec as_it_is;
        as_it_is.transform = ViewTransform::none;
        const fs::path file = options_.output / fmt::format("{}.{:04}.{}", loaded_.shot().name, frame.frame, ending);
        write_frame(file, image, as_it_is, 8,
                    {{"shot", report_.shot},
                     {"frame", std::to_string(frame.frame)},
                     {"devices", report_.names[0] + "," + report_.names[1]}});
        frame.files.push_back(file);
    }

    void write_json() {
        if (options_.output.empty()) return;
        report_.json = options_.output / fmt::format("{}.devices.json", loaded_.shot().name);
        const std::string text = json_of(report_) + "\n";
        write_atomically(report_.json, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
    }

    const DeviceComparisonOptions& options_;
    const std::function<void(const ComparedDeviceFrame&)>& frame_done_;
    const LoadedShot loaded_;
    Side sides_[2];
    ViewSpec view_;
    DeviceComparison report_;
};

/// The frames of which something holds, as "12, 24".
template <class Holds>
std::string frames_where(const DeviceComparison& comparison, const Holds& holds) {
    std::string list;
    for (const ComparedDeviceFrame& frame : comparison.frames)
        if (holds(frame)) list += fmt::format("{}{}", list.empty() ? "" : ", ", frame.frame);
    return list;
}

}  // namespace

std::pair<std::string, std::string> parse_device_pair(const std::string& text) {
    const std::size_t comma = text.find(',');
    const std::string first = text.substr(0, comma), second = comma == std::string::npos ? "" : text.substr(comma + 1);
    if (!is_name(first) || !is_name(second)) throw InputError(fmt::format("--devices is '{}'", text), kNames);
    return {first, second};
}

std::unique_ptr<Device> make_compared_device(const std::string& name, const LoadedShot& shot, int threads) {
    if (name == "exact") return make_exact_device(shot.bound());
    DeviceRequest request;
    request.threads = threads;
    request.name = name.substr(0, name.starts_with("cpu") ? 3 : std::string::npos);
    if (name == "cpu:1" || name == "cpu:8") request.width = name.back() - '0';
    try {
        return make_device(request).device;
    } catch (const InputError& error) {
        std::string found = error.diagnostics().front().found;
        const std::string asked = fmt::format("--device {}: ", name);
        if (found.starts_with(asked)) found.erase(0, asked.size());
        throw InputError(fmt::format("--devices: {}: {}", name, found),
                         "expected two devices that work here, as in --devices cpu,cpu:1; see kadr devices");
    }
}

bool DeviceComparison::differs() const {
    return std::any_of(frames.begin(), frames.end(), [](const ComparedDeviceFrame& frame) { return frame.differs(); });
}

std::string DeviceComparison::verdict() const {
    if (!differs())
        return fmt::format(
            "{} and {} show the same: in {} frame{} no ray contradicts, and the pictures differ by noise alone",
            names[0], names[1], frames.size(), frames.size() == 1 ? "" : "s");
    const std::string rays = frames_where(*this, [](const ComparedDeviceFrame&f) { return f.rays.wrong() > 0; }),
                      noise = frames_where(*this, [](const ComparedDeviceFrame&f) { return f.noise.differs(); });
    std::string text = fmt::format("{} and {} differ:", names[0], names[1]);
    if (!rays.empty()) text += fmt::format(" rays in frame {}", rays);
    if (!noise.empty()) text += fmt::format("{} pictures beyond noise in frame {}", rays.empty() ? "" : ",", noise);
    return text;
}

DeviceComparison compare_devices(const DeviceComparisonOptions& options,
                                 const std::function<void(const ComparedDeviceFrame&)>& frame_done) {
    return DeviceComparer(options, frame_done).run();
}

}  // namespace kadr
