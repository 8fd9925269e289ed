// What measured variants say: where the error comes from, what is dominated, what to change.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.h"
#include "measure/measure_job.h"

namespace kadr {

namespace {

constexpr double kGoodFlip = 0.05;       // mean; differences that an attentive viewer finds when flipping between the images
constexpr double kLostInNoise = 0.1;     // of the noise: a bias that nobody sees beneath it
constexpr double kWorthIt = 0.9;         // of the time: less of a saving may be the machine's mood
constexpr int kMostAdvised = 4096;       // samples

const MeasuredVariant* find(const std::vector<MeasuredVariant>& variants, const std::string& axis, const std::string& value) {
    const auto found = std::find_if(variants.begin(), variants.end(), [&](const MeasuredVariant& each) { return each.variant.axis == axis && each.variant.value == value; });
    return found == variants.end() ? nullptr : &*found;
}

/// Of the shot's own bias, what goes away with a better value of one axis.
double share(const std::vector<MeasuredVariant>& variants, const std::string& axis, const std::string& best) {
    const MeasuredVariant* better = find(variants, axis, best);
    return better ? std::max(variants.front().error.bias - better->error.bias, 0.0) : 0;
}

/// The fastest value of an axis whose bias is lost in the noise. @return null: the shot's own
const MeasuredVariant* cheapest(const std::vector<MeasuredVariant>& variants, const std::string& axis, double noise) {
    const MeasuredVariant& own = variants.front();
    double least = own.error.bias;
    for (const MeasuredVariant& each : variants)
        if (each.variant.axis == axis) least = std::min(least, each.error.bias);
    const double most = std::max(least, 0.0) + kLostInNoise * noise;
    const bool own_will_do = own.error.bias <= most;
    const MeasuredVariant* best = nullptr;
    for (const MeasuredVariant& each : variants) {
        const bool cheap = each.seconds < (best ? best->seconds : own_will_do ? kWorthIt * own.seconds : INFINITY);
        if (each.variant.axis == axis && each.error.bias <= most && cheap) best = &each;
    }
    return best;
}

/// The least samples whose error looks good; beyond what was measured by the square root.
int samples_for_good(const std::vector<MeasuredVariant>& variants, int own_samples) {
    int most = 0;
    double flip_of_most = 0;
    int least_good = 0;
    const auto look_at = [&](int samples, double flip) {
        if (flip <= kGoodFlip && (least_good == 0 || samples < least_good)) least_good = samples;
        if (samples > most) most = samples, flip_of_most = flip;
    };
    look_at(own_samples, variants.front().error.flip);
    for (const MeasuredVariant& each : variants)
        if (each.variant.axis == "samples") look_at(std::stoi(each.variant.value), each.error.flip);
    if (least_good > 0) return least_good;
    const double wanted = most * std::pow(flip_of_most / kGoodFlip, 2);
    return std::min(kMostAdvised, static_cast<int>(std::exp2(std::ceil(std::log2(wanted)))));
}

/// Whether the denoised picture of the samples at hand looks good, and is to be had for less than the samples that do without.
bool denoising_pays(const std::vector<MeasuredVariant>& variants, int samples, int wanted) {
    const MeasuredVariant* oidn = find(variants, "denoise", "oidn");
    return oidn && wanted > samples && oidn->error.flip <= kGoodFlip && oidn->seconds < kWorthIt * variants.front().seconds * wanted / samples;
}

std::string denoising_text(const MeasuredVariant& own, const MeasuredVariant& oidn, bool advised) {
    std::string text = fmt::format("Denoised, {} becomes FLIP {:.3f} in {:.3g} s", advised ? "that" : "it", oidn.error.flip, oidn.seconds);
    if (own.flicker && oidn.flicker) text += fmt::format(", and what flickers from frame to frame goes from {:.4f} to {:.4f}", *own.flicker, *oidn.flicker);
    return text + (advised ? ": less time than those samples take. " : ". ");
}

/// The key below `render` that makes a variant of the shot, and its value.
std::pair<std::string, std::string> setting_of(const Variant& variant) {
    constexpr std::string_view kRender = "render.";
    return {variant.set.front().first.substr(kRender.size()), variant.set.front().second};
}

std::string percent(double part, double whole) { return fmt::format("{:.0f} %", whole > 0 ? 100 * part / whole : 0.0); }

}  // namespace

void mark_front(std::vector<MeasuredVariant>& variants) {
    for (MeasuredVariant& each : variants)
        each.on_front = std::none_of(variants.begin(), variants.end(), [&](const MeasuredVariant& other) {
            return other.seconds <= each.seconds && other.error.flip <= each.error.flip && (other.seconds < each.seconds || other.error.flip < each.error.flip);
        });
}

ErrorShares shares_of(const std::vector<MeasuredVariant>& variants) {
    const FrameError& own = variants.front().error;
    ErrorShares shares{own.noise, share(variants, "bounces", "32"), share(variants, "motion_tolerance", "0.02 px"), share(variants, "clamp", "none"),
                       share(variants, "denoise", "none"), share(variants, "texture", "none"), 0};
    shares.other = std::max(own.bias - shares.bounces - shares.motion - shares.clamp - shares.denoise - shares.texture, 0.0);
    return shares;
}

Recommendation recommend(const std::vector<MeasuredVariant>& variants, const RenderSpec& render, int samples) {
    const MeasuredVariant& own = variants.front();
    const ErrorShares shares = shares_of(variants);
    const double whole = shares.noise + shares.bounces + shares.motion + shares.clamp + shares.denoise + shares.texture + shares.other;
    Recommendation advice;
    const int wanted = samples_for_good(variants, samples);
    const bool denoised = denoising_pays(variants, samples, wanted);
    advice.render.emplace_back("samples", std::to_string(denoised ? samples : wanted));
    advice.text = fmt::format("At {} samples a pixel a frame takes {:.3g} s and is off by FLIP {:.3f}: {} of the error is noise. ", samples, own.seconds, own.error.flip, percent(shares.noise, whole));
    advice.text += fmt::format("{} samples are the least that bring FLIP to {} or below{}. ", wanted, kGoodFlip, wanted == kMostAdvised ? ", as far as this advice goes" : "");
    if (const MeasuredVariant* oidn = find(variants, "denoise", "oidn")) advice.text += denoising_text(own, *oidn, denoised);
    if (denoised) advice.render.emplace_back("denoise", "oidn");
    const double noise = own.error.noise * samples / wanted;
    for (const char* axis : {"integrator", "bounces", "motion_tolerance", "texture", "build"})
        if (const MeasuredVariant* better = cheapest(variants, axis, noise)) {
            advice.render.push_back(setting_of(better->variant));
            const bool faster = better->seconds < own.seconds;
            advice.text += fmt::format("{}: {} {} {} of the time{}. ", axis, better->variant.value, faster ? "saves" : "costs", percent(std::abs(1 - better->seconds / own.seconds), 1),
                                       faster ? ", and what it leaves out is lost in the noise" : ", and takes away a bias that shows");
        }
    if (shares.clamp > kLostInNoise * shares.noise && render.clamp_indirect)
        advice.text += fmt::format("The clamp takes {} of the error upon itself; it is the shot's look and is left alone. ", percent(shares.clamp, whole));
    advice.text.pop_back();
    return advice;
}

std::string Recommendation::yaml() const {
    std::string block = "render: { ";
    for (std::size_t i = 0; i < render.size(); ++i) block += fmt::format("{}{}: {}", i > 0 ? ", " : "", render[i].first, render[i].second);
    return block + " }";
}

}  // namespace kadr
