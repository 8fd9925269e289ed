#include "output/view.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace kadr {
namespace {

// Pixels that are transformed at once: a few kilobytes, so that every loop below runs in the first-level cache and the
// compiler can turn it into vector instructions.
constexpr int kBlock = 256;
struct Block {
    float r[kBlock], g[kBlock], b[kBlock], alpha[kBlock];
};

using Transform = void (*)(Block&);

// Brighter values give the same white in every view and would overflow inside.
constexpr float kLargestInput = 1e15f;

struct Matrix {
    float m[9];   ///< rows
};

struct Rgb {
    float r, g, b;
};

inline __attribute__((always_inline)) Rgb operator*(const Matrix& a, Rgb v) {
    return {a.m[0] * v.r + a.m[1] * v.g + a.m[2] * v.b, a.m[3] * v.r + a.m[4] * v.g + a.m[5] * v.b,
            a.m[6] * v.r + a.m[7] * v.g + a.m[8] * v.b};
}

inline __attribute__((always_inline)) float clamp01(float x) {
    const float positive = x > 0 ? x : 0;   // NaN becomes 0
    return positive < 1 ? positive : 1;
}

/// log2 of a positive normal number, relative error below 1e-6; no branch and no library call, so that it vectorises.
/// Source: log(m) = 2 artanh((m - 1) / (m + 1)), Abramowitz and Stegun 4.1.27.
inline __attribute__((always_inline)) float fast_log2(float x) {
    constexpr std::int32_t kSqrtHalf = 0x3f3504f3;
    const std::int32_t bits = std::bit_cast<std::int32_t>(x) - kSqrtHalf;
    const std::int32_t exponent = bits >> 23;
    const float m = std::bit_cast<float>((bits & 0x007fffff) + kSqrtHalf);   // in [sqrt(1/2), sqrt(2))
    const float s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
    const float series = 1.0f + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 * (1.0f / 9))));
    constexpr float kTwoOverLn2 = 2.8853900817779268f;
    return static_cast<float>(exponent) + kTwoOverLn2 * s * series;
}

/// 2^x for |x| < 126, relative error below 1e-6 (Taylor series of the fraction in [-1/2, 1/2], degree 7).
inline __attribute__((always_inline)) float fast_exp2(float x) {
    constexpr float kRound = 12582912.0f;   // 1.5 * 2^23: adding it leaves the nearest whole number
    const float whole = (x + kRound) - kRound;
    const float f = (x - whole) * 0.6931471805599453f;
    const float series =
        1.0f + f * (1.0f + f * (0.5f + f * (1.0f / 6 + f * (1.0f / 24 + f * (1.0f / 120 + f * (1.0f / 720 + f * (1.0f / 5040)))))));
    return series * std::bit_cast<float>((static_cast<std::int32_t>(whole) + 127) << 23);
}

/// x^p for x in [0, 1] and moderate p > 0; below 1e-9 the result is that of 1e-9.
inline __attribute__((always_inline)) float fast_pow(float x, float p) {
    return fast_exp2(p * fast_log2(x > 1e-9f ? x : 1e-9f));
}

/// Linear to sRGB in [0, 1].  Source: IEC 61966-2-1.
inline __attribute__((always_inline)) float srgb_encoded(float linear) {
    const float x = clamp01(linear);
    const float straight = 12.92f * x, curved = 1.055f * fast_pow(x, 1.0f / 2.4f) - 0.055f;
    const float inside = x <= 0.0031308f ? straight : curved;
    return x < 1 ? inside : 1.0f;   // the curve misses 1 by a rounding, and white must be white
}

void encode_srgb(Block& p) {
    for (float& x : p.r) x = srgb_encoded(x);
    for (float& x : p.g) x = srgb_encoded(x);
    for (float& x : p.b) x = srgb_encoded(x);
}

void clamp_only(Block& p) {
    for (float& x : p.r) x = clamp01(x);
    for (float& x : p.g) x = clamp01(x);
    for (float& x : p.b) x = clamp01(x);
}

void store(Block& p, int i, Rgb c) {
    p.r[i] = c.r;
    p.g[i] = c.g;
    p.b[i] = c.b;
}

// --- AgX -------------------------------------------------------------------------------------------------------------
// T. Sobotka's AgX as Blender ships it (working in Rec. 2020 with E. Akyildiz's inset and outset), with B. Wrensch's
// polynomial fit of the contrast curve ("Minimal AgX Implementation", 2022; mean squared error 3.7e-6).

constexpr Matrix kRec2020FromRec709{{0.6274038959f, 0.3292830384f, 0.0433130657f, 0.0690972894f, 0.9195403951f, 0.0113623156f,
                                     0.0163914389f, 0.0880133079f, 0.8955952532f}};
constexpr Matrix kRec709FromRec2020{{1.6604910021f, -0.5876411388f, -0.0728498633f, -0.1245504745f, 1.1328998971f, -0.0083494226f,
                                     -0.0181507634f, -0.1005788980f, 1.1187296614f}};
constexpr Matrix kAgxInset{{0.856627153315983f, 0.0951212405381588f, 0.0482516061458583f, 0.137318972929847f, 0.761241990602591f,
                            0.101439036467562f, 0.11189821299995f, 0.0767994186031903f, 0.811302368396859f}};
constexpr Matrix kAgxOutset{{1.1271005818144368f, -0.11060664309660323f, -0.016493938717834573f, -0.1413297634984383f,
                             1.157823702216272f, -0.016493938717834257f, -0.14132976349843826f, -0.11060664309660294f,
                             1.2519364065950405f}};
constexpr float kAgxMinStops = -12.47393f, kAgxMaxStops = 4.026069f;

inline __attribute__((always_inline)) float agx_curve(float scene) {
    const float stops = fast_log2(scene > 1e-10f ? scene : 1e-10f);
    const float x = clamp01((stops - kAgxMinStops) / (kAgxMaxStops - kAgxMinStops));
    const float x2 = x * x, x4 = x2 * x2;
    return 15.5f * x4 * x2 - 40.14f * x4 * x + 31.96f * x4 - 6.868f * x2 * x + 0.4298f * x2 + 0.1191f * x - 0.00232f;
}

/// The curve's values are encoded for a display with a power of 2.2; linear light is what mixes back to Rec. 709.
inline __attribute__((always_inline)) float from_display_2_2(float x) { return fast_pow(clamp01(x), 2.2f); }

void agx(Block& p) {
    for (int i = 0; i < kBlock; ++i) store(p, i, kAgxInset * (kRec2020FromRec709 * Rgb{p.r[i], p.g[i], p.b[i]}));
    for (float& x : p.r) x = agx_curve(x);
    for (float& x : p.g) x = agx_curve(x);
    for (float& x : p.b) x = agx_curve(x);
    for (int i = 0; i < kBlock; ++i) store(p, i, kAgxOutset * Rgb{p.r[i], p.g[i], p.b[i]});
    for (float& x : p.r) x = from_display_2_2(x);
    for (float& x : p.g) x = from_display_2_2(x);
    for (float& x : p.b) x = from_display_2_2(x);
    for (int i = 0; i < kBlock; ++i) store(p, i, kRec709FromRec2020 * Rgb{p.r[i], p.g[i], p.b[i]});
    encode_srgb(p);
}

// --- ACES ------------------------------------------------------------------------------------------------------------
// S. Hill's fit of the ACES reference rendering transform and the sRGB output device transform ("BakingLab", 2016).

constexpr Matrix kAcesInput{{0.59719f, 0.35458f, 0.04823f, 0.07600f, 0.90834f, 0.01566f, 0.02840f, 0.13383f, 0.83777f}};
constexpr Matrix kAcesOutput{{1.60475f, -0.53108f, -0.07367f, -0.10208f, 1.10813f, -0.00605f, -0.00327f, -0.07276f, 1.07602f}};

inline __attribute__((always_inline)) float aces_curve(float v) {
    return (v * (v + 0.0245786f) - 0.000090537f) / (v * (0.983729f * v + 0.4329510f) + 0.238081f);
}

void aces(Block& p) {
    for (int i = 0; i < kBlock; ++i) {
        const Rgb v = kAcesInput * Rgb{p.r[i], p.g[i], p.b[i]};
        store(p, i, kAcesOutput * Rgb{aces_curve(v.r), aces_curve(v.g), aces_curve(v.b)});
    }
    encode_srgb(p);
}

// --- Khronos PBR neutral ---------------------------------------------------------------------------------------------
// Khronos PBR Neutral Tone Mapper, specification of 2024.

constexpr float kNeutralStart = 0.8f - 0.04f, kNeutralDesaturation = 0.15f;

void pbr_neutral(Block& p) {
    for (int i = 0; i < kBlock; ++i) {
        const float smallest = std::min(p.r[i], std::min(p.g[i], p.b[i]));
        const float offset = smallest < 0.08f ? smallest - 6.25f * smallest * smallest : 0.04f;
        const Rgb c{p.r[i] - offset, p.g[i] - offset, p.b[i] - offset};
        const float peak = std::max(c.r, std::max(c.g, c.b));
        constexpr float d = 1.0f - kNeutralStart;
        const float new_peak = 1.0f - d * d / (std::max(peak, kNeutralStart) + d - kNeutralStart);
        const float scale = peak < kNeutralStart ? 1.0f : new_peak / std::max(peak, kNeutralStart);
        const float to_white =
            peak < kNeutralStart ? 0.0f : 1.0f - 1.0f / (kNeutralDesaturation * (peak - new_peak) + 1.0f);
        const auto mixed = [&](float x) { return x * scale * (1.0f - to_white) + new_peak * to_white; };
        store(p, i, {mixed(c.r), mixed(c.g), mixed(c.b)});
    }
    encode_srgb(p);
}

// --- The whole image -------------------------------------------------------------------------------------------------

/// [ViewTransform]
constexpr Transform kTransforms[] = {clamp_only, encode_srgb, agx, aces, pbr_neutral};

/// Where R, G, B and A are; a missing colour channel repeats the first (grey images), missing alpha is -1.
struct Channels {
    int r, g, b, alpha;
};

int index_of(const Image& image, const char* name, int otherwise) {
    const auto found = std::find(image.channels.begin(), image.channels.end(), name);
    return found == image.channels.end() ? otherwise : static_cast<int>(found - image.channels.begin());
}

Channels channels_of(const Image& image) {
    return {index_of(image, "R", 0), index_of(image, "G", 0), index_of(image, "B", 0), index_of(image, "A", -1)};
}

float within_input(float x) { return x > 0 ? std::min(x, kLargestInput) : 0.0f; }   // NaN becomes 0

/// Fills a block from `count` pixels; colour times exposure. The rest of the block keeps what it had.
void load(Block& block, const float* pixel, int count, int stride, const Channels& channels, float exposure, bool divide) {
    for (int i = 0; i < count; ++i, pixel += stride) {
        const float alpha = channels.alpha < 0 ? 1.0f : clamp01(pixel[channels.alpha]);
        const float factor = divide && alpha > 0 ? exposure / alpha : exposure;
        block.r[i] = within_input(pixel[channels.r] * factor);
        block.g[i] = within_input(pixel[channels.g] * factor);
        block.b[i] = within_input(pixel[channels.b] * factor);
        block.alpha[i] = alpha;
    }
}

float* unload(const Block& block, float* out, int count, bool multiply, bool keep_alpha) {
    for (int i = 0; i < count; ++i) {
        const float factor = multiply ? block.alpha[i] : 1.0f;
        *out++ = block.r[i] * factor;
        *out++ = block.g[i] * factor;
        *out++ = block.b[i] * factor;
        if (keep_alpha) *out++ = block.alpha[i];
    }
    return out;
}

}  // namespace

Image apply_view(const Image& linear, const ViewSpec& view, bool keep_alpha) {
    const Channels channels = channels_of(linear);
    const Transform transform = kTransforms[static_cast<int>(view.transform)];
    const bool encodes = view.transform != ViewTransform::none;
    const float exposure = static_cast<float>(std::exp2(view.exposure_stops));
    Image display{linear.width, linear.height, {"R", "G", "B"}, {}};
    if (keep_alpha) display.channels.emplace_back("A");
    const int count = linear.width * linear.height, stride = static_cast<int>(linear.channels.size());
    display.pixels.resize(static_cast<std::size_t>(count) * display.channels.size());
    float* out = display.pixels.data();
    Block block{};
    for (int first = 0; first < count; first += kBlock) {
        const int size = std::min(kBlock, count - first);
        load(block, linear.pixels.data() + static_cast<std::size_t>(first) * stride, size, stride, channels, exposure, encodes);
        transform(block);
        out = unload(block, out, size, encodes, keep_alpha);
    }
    return display;
}

double metered_exposure(const Image& linear) {
    const Channels channels = channels_of(linear);
    const std::size_t stride = linear.channels.size();
    double sum = 0;
    std::size_t lit = 0;
    for (std::size_t i = 0; i < linear.pixels.size(); i += stride) {
        const float* p = linear.pixels.data() + i;
        const double luminance = 0.2126 * p[channels.r] + 0.7152 * p[channels.g] + 0.0722 * p[channels.b];
        if (!(luminance > 0) || !std::isfinite(luminance)) continue;
        sum += std::log2(luminance);
        ++lit;
    }
    constexpr double kMidGrey = 0.18;
    return lit == 0 ? 0 : std::log2(kMidGrey) - sum / static_cast<double>(lit);
}

}  // namespace kadr
