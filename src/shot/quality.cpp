#include "shot/quality.h"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>

#include "shot/quality_measured.h"

namespace kadr {

namespace {

using Value = std::pair<const char*, const char*>;

constexpr std::array<Value, 5> kDraft{{{"samples", "4"}, {"bounces", "1"}, {"motion_tolerance", "0.5 px"}, {"texture_limit", "1024 px"}, {"build", "low"}}};
constexpr std::array<Value, 5> kPreview{{{"samples", "16"}, {"bounces", "3"}, {"motion_tolerance", "0.25 px"}, {"texture_limit", "2048 px"}, {"build", "medium"}}};
constexpr std::array<Value, 5> kFinal{{{"samples", "{ max_error: 0.01, at_least: 64, at_most: 1024 }"}, {"bounces", "8"}, {"motion_tolerance", "0.1 px"}, {"texture_limit", "none"}, {"build", "medium"}}};
constexpr std::array<Value, 8> kReference{{{"samples", "4096"}, {"bounces", "32"}, {"motion_tolerance", "0.02 px"}, {"texture_limit", "none"}, {"build", "high"},
                                           {"robust", "true"}, {"denoise", "none"}, {"clamp", "{ direct: none, indirect: none }"}}};

constexpr std::array<QualityBlock, 4> kBlocks{{
    {"draft", "motion and framing; noisy, light after the first bounce is missing", kDraft},
    {"preview", "lighting and materials at a glance; visible noise", kPreview},
    {"final", "delivery: every pixel is sampled until its noise is below a hundredth of the display's range", kFinal},
    {"reference", "a measure for the others: no clamps, practically no noise", kReference},
}};

std::string row_of(std::string_view name, const std::array<MeasuredStep, kBlocks.size()>& steps) {
    std::string text = fmt::format("  {:<12}", name);
    for (const MeasuredStep& step : steps) text += fmt::format("  {:>9.3g} {:>8.2g} {:>7.4f}", step.cpu_s, step.relmse, step.flip);
    return text + "\n";
}

/// The middle one of an odd number, the mean of the middle two of an even one.
double median_of(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

MeasuredStep median_of(std::size_t step) {
    const auto median = [&](double MeasuredStep::* figure) {
        std::vector<double> values;
        for (const MeasuredShot& shot : kMeasuredShots) values.push_back(shot.steps[step].*figure);
        return median_of(values);
    };
    return {median(&MeasuredStep::cpu_s), median(&MeasuredStep::relmse), median(&MeasuredStep::flip)};
}

/// What each step costs and loses on every sample shot.
std::string measured_text() {
    std::string text = fmt::format("\n  seconds of processor time a frame of {}, relMSE and FLIP against another seed of `reference` (tools/bench/quality.py)\n\n", kMeasuredSize);
    text += fmt::format("  {:<12}", "");
    std::array<MeasuredStep, kBlocks.size()> medians;
    for (std::size_t i = 0; i < kBlocks.size(); ++i) text += fmt::format("  {:>9} {:>8} {:>7}", kBlocks[i].name, "relMSE", "FLIP"), medians[i] = median_of(i);
    text += "\n";
    for (const MeasuredShot& shot : kMeasuredShots) text += row_of(shot.name, shot.steps);
    return text + row_of("median", medians);
}

}  // namespace

std::string QualityBlock::yaml() const {
    std::string text = "{ ";
    for (const auto& [key, value] : values) text += fmt::format("{}{}: {}", text.size() > 2 ? ", " : "", key, value);
    return text + " }";
}

std::span<const QualityBlock> quality_blocks() { return kBlocks; }

const QualityBlock* find_quality(std::string_view name) {
    const auto found = std::find_if(kBlocks.begin(), kBlocks.end(), [&](const QualityBlock& block) { return block.name == name; });
    return found == kBlocks.end() ? nullptr : &*found;
}

std::string describe_quality() {
    std::string text = "quality\n  a step of the ladder: render.quality in a shot fills in what its render section does not give; --quality replaces it\n\n";
    for (const QualityBlock& block : kBlocks) text += fmt::format("  {:<10} {}\n  {:<10} {}\n", block.name, block.yaml(), "", block.purpose);
    return text + measured_text();
}

}  // namespace kadr
