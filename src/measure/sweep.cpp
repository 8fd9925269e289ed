#include "measure/sweep.h"

#include <algorithm>
#include <array>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text.h"

namespace kadr {

namespace {

constexpr std::array<const char*, 5> kAxes{"samples", "bounces", "integrator", "motion_tolerance", "clamp"};

/// What a renderer may offer a choice of, and this one does not.
constexpr std::pair<const char*, const char*> kNoChoice[] = {
    {"motion_frames", "their number follows from render.motion_tolerance: sweep motion_tolerance"},
    {"build", "structures are built in one quality"},
    {"denoise", "there is no denoiser"},
    {"texture", "textures are filtered in one way"},
    {"device", "the CPU is the only device"},
};

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
        if (axis == "clamp") clamp();
    }
    Sweep take() { return std::move(sweep_); }

private:
    void add(const char* axis, const std::string& value, std::vector<std::pair<std::string, std::string>> set, int samples = 0) {
        set.emplace_back("render.samples", std::to_string(samples > 0 ? samples : size_.samples));
        sweep_.variants.push_back({axis, value, std::move(set)});
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
    void integrator() {
        const char* other = render_.integrator == Integrator::direct ? "path" : "direct";
        add("integrator", other, {{"render.integrator", other}});
    }
    void motion_tolerance() {
        for (const double px : size_.quick ? std::vector{0.02, 0.5} : std::vector{0.02, 0.1, 0.5, 2.0})
            if (px != render_.motion_tolerance_px) add("motion_tolerance", format_number(px) + " px", {{"render.motion_tolerance", format_number(px) + " px"}});
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
        for (const auto& [name, reason] : kNoChoice)
            if (word == name) throw InputError(fmt::format("--sweep names '{}', which this Kadr has no choice in: {}", word, reason), fmt::format("expected some of {}", fmt::join(kAxes, ", ")));
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
