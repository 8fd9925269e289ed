#include "output/drawing.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "output/stroke_font.h"

namespace kadr {
namespace {

constexpr double kOutlinePx = 1.25;
constexpr float kOutlineOpacity = 0.75f;
constexpr DisplayColor kOutline{0.02f, 0.02f, 0.03f};

/// Distance from a point to a segment.
double distance_to(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
    const glm::dvec2 along = b - a;
    const double length2 = glm::dot(along, along);
    const double t = length2 > 0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
    return glm::distance(p, a + t * along);
}

bool is_finite(const glm::dvec2& p) { return std::isfinite(p.x) && std::isfinite(p.y); }

/// The pixel that holds a coordinate, within [0, size].
int pixel_in(double coordinate, int size) {
    return static_cast<int>(std::clamp(coordinate, 0.0, static_cast<double>(size)));
}

/// Bytes that continue a letter of UTF-8 take no place of their own.
bool continues_letter(char byte) { return (static_cast<unsigned char>(byte) & 0xc0) == 0x80; }

}  // namespace

Drawing::Drawing(int width, int height) : width_(width), height_(height) {
    const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    fill_ = outline_ = Mask{std::vector<float>(count, 0.0f), width, height, 0, 0};
}

void Drawing::stroke(Mask& mask, const glm::dvec2& from, const glm::dvec2& to, double width_px, double strength) const {
    // Thinner lines than a pixel get fainter instead.
    const double radius = 0.5 * std::max(width_px, 1.0), reach = radius + 0.5;
    const double full = strength * std::min(width_px, 1.0);
    const glm::dvec2 low = glm::min(from, to) - reach, high = glm::max(from, to) + reach;
    const int left = pixel_in(std::floor(low.x), width_), right = pixel_in(std::ceil(high.x), width_);
    const int top = pixel_in(std::floor(low.y), height_), bottom = pixel_in(std::ceil(high.y), height_);
    for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) {
            const double coverage = std::clamp(reach - distance_to({x + 0.5, y + 0.5}, from, to), 0.0, 1.0);
            float& opacity = mask.opacity[static_cast<std::size_t>(y) * width_ + x];
            opacity = std::max(opacity, static_cast<float>(full * coverage));
        }
    if (left >= right || top >= bottom) return;
    mask.left = std::min(mask.left, left), mask.right = std::max(mask.right, right);
    mask.top = std::min(mask.top, top), mask.bottom = std::max(mask.bottom, bottom);
}

void Drawing::line(const glm::dvec2& from, const glm::dvec2& to, double width_px, double strength) {
    if (!is_finite(from) || !is_finite(to)) return;
    stroke(fill_, from, to, width_px, strength);
    stroke(outline_, from, to, width_px + 2 * kOutlinePx, strength);
}

void Drawing::circle(const glm::dvec2& centre, double radius_px, double width_px, double strength) {
    const int sides = std::max(12, static_cast<int>(2 * radius_px));
    const auto corner = [&](int i) {
        const double angle = 2 * std::numbers::pi * i / sides;
        return centre + radius_px * glm::dvec2(std::cos(angle), std::sin(angle));
    };
    for (int i = 0; i < sides; ++i) line(corner(i), corner(i + 1), width_px, strength);
}

void Drawing::text(const glm::dvec2& baseline, std::string_view text, double height_px, double strength) {
    const double unit = height_px / kGlyphHeight, pen = std::max(1.0, 0.13 * height_px);
    glm::dvec2 origin = baseline - glm::dvec2(0, height_px);
    for (const char letter : text) {
        if (continues_letter(letter)) continue;
        for (const auto& points : glyph_of(letter))
            for (std::size_t i = 0; i < points.size(); ++i)
                line(origin + unit * glm::dvec2(points[i]),
                     origin + unit * glm::dvec2(points[i + 1 < points.size() ? i + 1 : i]), pen, strength);
        origin.x += unit * advance_of(letter);
    }
}

void Drawing::blend(Image& image, const Mask& mask, const DisplayColor& color, float opacity) const {
    const float rgb[] = {color.r, color.g, color.b};
    const std::size_t stride = image.channels.size();
    for (int y = mask.top; y < mask.bottom; ++y)
        for (int x = mask.left; x < mask.right; ++x) {
            const std::size_t at = static_cast<std::size_t>(y) * width_ + x;
            const float amount = opacity * mask.opacity[at];
            for (std::size_t c = 0; c < 3; ++c) {
                float& value = image.pixels[at * stride + c];
                value += amount * (rgb[c] - value);
            }
        }
}

void Drawing::lay_onto(Image& image, const DisplayColor& color) const {
    assert(image.width == width_ && image.height == height_ && image.channels.size() >= 3);
    blend(image, outline_, kOutline, kOutlineOpacity);
    blend(image, fill_, color, 1);
}

double text_width(std::string_view text, double height_px) {
    int width = 0;
    for (const char letter : text)
        if (!continues_letter(letter)) width += advance_of(letter);
    return height_px / kGlyphHeight * width;
}

}  // namespace kadr
