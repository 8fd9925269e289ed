#include "render/onion.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

namespace kadr {
namespace {

// Differences below the first are noise or the faint change of bounced light, above the second they are another thing;
// in values of the display, largest of the three channels.
constexpr float kNoise = 0.025f, kDifferent = 0.1f;
constexpr float kTint = 0.55f;
constexpr float kFirstOpacity = 0.5f, kLastOpacity = 0.9f;
constexpr DisplayColor kWarm{1.0f, 0.50f, 0.16f}, kMiddle{0.92f, 0.92f, 0.88f}, kCool{0.22f, 0.60f, 1.0f};

DisplayColor mix(const DisplayColor& a, const DisplayColor& b, float t) {
    return {a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b)};
}

double place_of(std::size_t frame, std::size_t count) {
    return count < 2 ? 1.0 : static_cast<double>(frame) / static_cast<double>(count - 1);
}

float smooth_step(float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

/// The lower median of each channel: a value that some frame has.
void median(const std::vector<Image>& frames, std::size_t at, float rgb[3]) {
    std::vector<float> values(frames.size());
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < frames.size(); ++i) values[i] = frames[i].pixels[at + c];
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
        std::nth_element(values.begin(), middle, values.end());
        rgb[c] = *middle;
    }
}

/// Lays a frame's pixel over the picture's as far as it differs from the ground.
void lay_ghost(float* picture, const float* ground, const float* frame, const DisplayColor& tint, float opacity) {
    float difference = 0;
    for (int c = 0; c < 3; ++c) difference = std::max(difference, std::abs(frame[c] - ground[c]));
    const float amount = opacity * smooth_step(kNoise, kDifferent, difference);
    if (amount == 0) return;
    const float luma = 0.2126f * frame[0] + 0.7152f * frame[1] + 0.0722f * frame[2];
    const float tints[] = {tint.r, tint.g, tint.b};
    for (int c = 0; c < 3; ++c) {
        // The tint keeps light and shade: it colours the frame's grey, lifted so that dark things show their colour.
        const float tinted = tints[c] * (0.25f + 0.75f * luma);
        picture[c] += amount * (frame[c] + kTint * (tinted - frame[c]) - picture[c]);
    }
}

Image mean_of(const std::vector<Image>& frames) {
    Image mean = frames.front();
    for (std::size_t i = 1; i < frames.size(); ++i)
        for (std::size_t p = 0; p < mean.pixels.size(); ++p) mean.pixels[p] += frames[i].pixels[p];
    for (float& value : mean.pixels) value /= static_cast<float>(frames.size());
    return mean;
}

}  // namespace

DisplayColor ghost_color(double place) {
    const float t = static_cast<float>(2 * place);
    return t < 1 ? mix(kWarm, kMiddle, t) : mix(kMiddle, kCool, t - 1);
}

Image overlay_frames(const std::vector<Image>& frames, bool still_camera) {
    assert(!frames.empty());
    if (!still_camera) return mean_of(frames);
    Image picture = frames.front();
    std::vector<DisplayColor> tints;
    for (std::size_t i = 0; i < frames.size(); ++i) tints.push_back(ghost_color(place_of(i, frames.size())));
    for (std::size_t at = 0; at < picture.pixels.size(); at += 3) {
        float ground[3];
        median(frames, at, ground);
        std::copy_n(ground, 3, picture.pixels.begin() + static_cast<std::ptrdiff_t>(at));
        for (std::size_t i = 0; i < frames.size(); ++i) {
            const float place = static_cast<float>(place_of(i, frames.size()));
            lay_ghost(&picture.pixels[at], ground, &frames[i].pixels[at], tints[i],
                      kFirstOpacity + place * (kLastOpacity - kFirstOpacity));
        }
    }
    return picture;
}

void label_ghosts(Image& picture, const std::vector<FrameTime>& frames, bool tinted) {
    const double height = std::clamp(picture.width / 55.0, 7.0, 16.0), margin = height;
    glm::dvec2 pen(margin, picture.height - margin);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const std::string number = std::to_string(frames[i].number);
        const double width = text_width(number, height);
        if (pen.x + width + margin > picture.width) return;
        Drawing label(picture.width, picture.height);
        label.text(pen, number, height);
        label.lay_onto(picture, tinted ? ghost_color(place_of(i, frames.size())) : DisplayColor{});
        pen.x += width + height;
    }
}

}  // namespace kadr
