#include "measure/difference_picture.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "output/drawing.h"

namespace kadr {
namespace {

constexpr DisplayColor kLabel{0.96f, 0.96f, 0.94f};

int even(int size) { return size + size % 2; }

void place(Image& picture, const Image& panel, int left) {
    for (int y = 0; y < panel.height; ++y) {
        const auto row = panel.pixels.begin() + std::ptrdiff_t{3} * y * panel.width;
        std::copy(row, row + std::ptrdiff_t{3} * panel.width,
                  picture.pixels.begin() + std::ptrdiff_t{3} * (std::ptrdiff_t{y} * picture.width + left));
    }
}

}  // namespace

Image difference_picture(const ShownDifference& shown, const std::string& label) {
    const int width = shown.reference.width, height = shown.reference.height;
    Image picture{even(3 * width), even(height), {"R", "G", "B"}, {}};
    picture.pixels.assign(3 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height), 0.0f);
    place(picture, shown.reference, 0);
    place(picture, shown.test, width);
    place(picture, image_io().heat_map(shown.flip), 2 * width);

    const double letters = std::clamp(width / 36.0, 6.0, 24.0);
    const std::string texts[] = {"reference", label, fmt::format("FLIP {:.4f}", shown.difference.flip)};
    Drawing drawing(picture.width, picture.height);
    for (int i = 0; i < 3; ++i) drawing.text({i * width + letters, height - letters}, texts[i], letters);
    drawing.lay_onto(picture, kLabel);
    return picture;
}

}  // namespace kadr
