#pragma once

#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "film/film.h"

namespace kadr {

/// A display-referred colour.
struct DisplayColor {
    float r = 1, g = 1, b = 1;
};

/// Lines, discs and text of one colour, with a dark outline so that they read on bright and on dark pictures alike.
/// Strokes are gathered first and laid onto the picture once: where they overlap nothing gets darker or brighter.
/// Points are pixels, x right and y down, the centre of the first pixel at (0.5, 0.5).
class Drawing {
public:
    Drawing(int width, int height);

    /// A line with round ends, anti-aliased over one pixel. @param strength  opacity in [0, 1]
    void line(const glm::dvec2& from, const glm::dvec2& to, double width_px, double strength = 1);
    void disc(const glm::dvec2& centre, double radius_px, double strength = 1) {
        line(centre, centre, 2 * radius_px, strength);
    }
    void circle(const glm::dvec2& centre, double radius_px, double width_px, double strength = 1);
    /// @param baseline   the left end of the line that the text stands on
    /// @param height_px  of capitals
    void text(const glm::dvec2& baseline, std::string_view text, double height_px, double strength = 1);

    /// Blends the outline and then the colour over a display-referred image of the same size.
    void lay_onto(Image& image, const DisplayColor& color) const;

private:
    /// Opacity a pixel, and the part of it that is not empty.
    struct Mask {
        std::vector<float> opacity;
        int left, top, right = 0, bottom = 0;
    };
    void stroke(Mask& mask, const glm::dvec2& from, const glm::dvec2& to, double width_px, double strength) const;
    void blend(Image& image, const Mask& mask, const DisplayColor& color, float opacity) const;

    int width_, height_;
    Mask fill_, outline_;
};

/// From the left end of a text's baseline to where the next letter would begin.
double text_width(std::string_view text, double height_px);

}  // namespace kadr
