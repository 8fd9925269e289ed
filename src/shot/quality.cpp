#include "shot/quality.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

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
    return text;
}

}  // namespace kadr
