#include "measure/sweep.h"

#include <algorithm>
#include <array>
#include <bit>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text.h"

namespace kadr {

namespace {

constexpr std::array<const char*, 11> kAxes{"samples", "bounces", "integrator", "motion_tolerance", "motion_frames", "clamp", "denoise", "texture", "build", "robust", "device"};

constexpr int kLeastTexture = 16;   // smaller ones cost nothing

class Planner {
public:
    Planner(const RenderSpec& render, const SweepSize& size) : render_(render), size_(size) {
        add("shot", "", {});
    }

    void add_axis(const std::string& axis) {
        if (axis == "samples") samples();
        if (axis == "bounces") bounces();
        if (axis == "integrator") integrator();
        if (axis == "motion_tolerance") motion_tolerance();
        if (axis == "motion_frames") motion_frames();
        if (axis == "clamp") clamp();
        if (axis == "denoise") other("denoise", render_.denoise == DenoiserKind::none ? "oidn" : "none");
        if (axis == "texture") texture();
        if (axis == "build") build();
        if (axis == "robust") other("robust", render_.robust.value_or(false) ? "false" : "true");
        if (axis == "device") devices();
    }
    Sweep take() { return std::move(sweep_); }

private:
    void add(const char* axis, const std::string& value, std::vector<std::pair<std::string, std::string>> set, int samples = 0) {
        set.emplace_back("render.samples", std::to_string(samples > 0 ? samples : size_.samples));
        sweep_.variants.push_back({axis, value, std::move(set), {}});
    }
    void samples() {
        for (const int count : size_.sample_counts)
            if (count != size_.samples) add("samples", std::to_string(count), {}, count);
    }
    void bounces() {
        if (render_.integrator == Integrator::direct) return sweep_.left_out.push_back({"bounces", "render.integrator is direct, which has none"});
        const std::vector<int> counts = size_.quick ? std::vector{0, 1, 2, 4, 32} : std::vector{0, 1, 2, 4, 8, 16, 32};
        const RenderSpec::Bounces& own = render_.bounces;
        const bool uniform = own.diffuse == own.total && own.glossy == own.total && own.transmission == own.total;
        for (const int count : counts)
            if (!uniform || count != own.total) add("bounces", std::to_string(count), {{"render.bounces", std::to_string(count)}});
    }
    void integrator() { other("integrator", render_.integrator == Integrator::direct ? "path" : "direct"); }
    /// The one value that the shot does not have.
    void other(const char* axis, const char* value) { add(axis, value, {{fmt::format("render.{}", axis), value}}); }
    /// Down to an eighth of the largest one, and without a limit where the shot has one.
    void texture() {
        if (size_.largest_texture_px <= kLeastTexture) return sweep_.left_out.push_back({"texture", fmt::format("no texture of the shot is larger than {} px", kLeastTexture)});
        if (render_.texture_limit_px > 0) add("texture", "none", {{"render.texture_limit", "none"}});
        const int largest = std::bit_ceil(static_cast<unsigned>(size_.largest_texture_px));
        for (int limit = largest / 2; limit >= std::max(kLeastTexture, largest / 8); limit /= size_.quick ? 4 : 2)
            if (limit != render_.texture_limit_px) add("texture", fmt::format("{} px", limit), {{"render.texture_limit", fmt::format("{} px", limit)}});
    }
    void build() {
        constexpr std::pair<const char*, BuildQuality> kQualities[] = {{"low", BuildQuality::low}, {"medium", BuildQuality::medium}, {"high", BuildQuality::high}};
        for (const auto& [name, quality] : kQualities)
            if (quality != render_.build) other("build", name);
    }
    void motion_tolerance() {
        for (const double px : size_.quick ? std::vector{0.02, 0.5} : std::vector{0.02, 0.1, 0.5, 2.0})
            if (px != render_.motion_tolerance_px) add("motion_tolerance", format_number(px) + " px", {{"render.motion_tolerance", format_number(px) + " px"}});
    }
    /// Few and many, each way to mix them; and what the tolerance asks for, where the shot says a number.
    void motion_frames() {
        if (!size_.moves) return sweep_.left_out.push_back({"motion_frames", "nothing moves while the shutter is open, in the frames at hand"});
        if (render_.motion_frames) add("motion_frames", "auto", {{"render.motion_frames", "auto"}});
        for (const int count : size_.quick ? std::vector{2, 5} : std::vector{2, 5, 17})
            for (const auto& [name, mix] : {std::pair{"srt", MotionMix::srt}, std::pair{"matrix", MotionMix::matrix}})
                if (render_.motion_frames != FixedMotionFrames{count, mix})
                    add("motion_frames", fmt::format("{} {}", count, name), {{"render.motion_frames", fmt::format("{{ count: {}, mix: {} }}", count, name)}});
    }
    /// Every other one; what is not usable is left out with its reason.
    void devices() {
        for (const SweepDevice& device : size_.devices) {
            if (device.own) continue;
            if (!device.missing.empty()) {
                sweep_.left_out.push_back({"device " + device.name, device.missing});
                continue;
            }
            add("device", device.name, {});
            sweep_.variants.back().device = device.name;
        }
        sweep_.left_out.push_back({"device exact", "the reference of `kadr stress` in double; no shot is rendered on it"});
    }
    void clamp() {
        const auto limit = [](const std::optional<double>& value) { return value ? format_number(*value) : std::string("none"); };
        for (const char* indirect : {"none", "10", "3", "1"})
            if (!(limit(render_.clamp_indirect) == indirect && !render_.clamp_direct))
                add("clamp", indirect, {{"render.clamp", fmt::format("{{ direct: none, indirect: {} }}", indirect)}});
    }

    const RenderSpec& render_;
    const SweepSize& size_;
    Sweep sweep_;
};

}  // namespace

std::string Variant::id() const {
    std::string name = value.empty() ? axis : axis + "-" + value;
    std::erase(name, ' ');
    return name;
}

std::vector<std::string> parse_axes(const std::string& list) {
    std::vector<std::string> axes;
    std::istringstream words(list);
    for (std::string word; std::getline(words, word, ',');) {
        if (std::find(kAxes.begin(), kAxes.end(), word) == kAxes.end())
            throw InputError(fmt::format("--sweep names '{}'", word), fmt::format("expected some of {}", fmt::join(kAxes, ", ")));
        if (std::find(axes.begin(), axes.end(), word) == axes.end()) axes.push_back(word);
    }
    return axes;
}

Sweep plan_sweep(const RenderSpec& render, const std::vector<std::string>& axes, const SweepSize& size) {
    Planner planner(render, size);
    for (const char* axis : kAxes)
        if (axes.empty() || std::find(axes.begin(), axes.end(), axis) != axes.end()) planner.add_axis(axis);
    return planner.take();
}

}  // namespace kadr
