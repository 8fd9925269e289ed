#include "render/sheet.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "output/drawing.h"

namespace kadr {
namespace {

constexpr int kSheetWidth = 1280, kNarrowestTile = 96;
constexpr std::int64_t kMostPixels = 64'000'000;
constexpr float kGround = 0.09f;
constexpr DisplayColor kLabel{0.96f, 0.96f, 0.94f};

double label_height(const SheetLayout& layout) { return std::clamp(layout.tile_width / 28.0, 7.0, 18.0); }

}  // namespace

SheetLayout sheet_layout(int columns, int rows, const ImageSpec& image) {
    SheetLayout layout;
    layout.columns = columns;
    layout.rows = rows;
    const int room = (kSheetWidth - layout.gap) / columns - layout.gap;
    layout.tile_width = std::min(std::max(room, kNarrowestTile), image.width);
    const double height = static_cast<double>(layout.tile_width) * image.height / image.width;
    layout.tile_height = std::max(1, static_cast<int>(std::lround(height)));
    return layout;
}

void check_sheet_size(const SheetLayout& layout) {
    if (static_cast<std::int64_t>(layout.width()) * layout.height() <= kMostPixels) return;
    throw InputError(fmt::format("a sheet of {}x{} tiles would be {}x{} pixels large", layout.columns, layout.rows,
                                 layout.width(), layout.height()),
                     "expected at most 64 million pixels: fewer tiles, or smaller ones by --size 160x90");
}

std::vector<int> spread(const std::vector<int>& frames, int count) {
    const int last = static_cast<int>(frames.size()) - 1;
    if (last < count) return frames;
    if (count == 1) return {frames.front()};
    std::vector<int> chosen;
    for (int i = 0; i < count; ++i) {
        const double at = static_cast<double>(i) * last / (count - 1);
        chosen.push_back(frames[static_cast<std::size_t>(std::lround(at))]);
    }
    return chosen;
}

Image empty_sheet(const SheetLayout& layout) {
    const std::size_t pixels = static_cast<std::size_t>(layout.width()) * static_cast<std::size_t>(layout.height());
    return {layout.width(), layout.height(), {"R", "G", "B"}, std::vector<float>(3 * pixels, kGround)};
}

void place_tile(Image& sheet, const SheetLayout& layout, int tile, const Image& picture) {
    for (int y = 0; y < picture.height; ++y) {
        const auto row = picture.pixels.begin() + std::ptrdiff_t{3} * y * picture.width;
        const std::ptrdiff_t to = std::ptrdiff_t{layout.top(tile) + y} * sheet.width + layout.left(tile);
        std::copy_n(row, std::ptrdiff_t{3} * picture.width, sheet.pixels.begin() + 3 * to);
    }
}

void label_tiles(Image& sheet, const SheetLayout& layout, const std::vector<FrameTime>& frames) {
    Drawing labels(sheet.width, sheet.height);
    const double height = label_height(layout), margin = 0.6 * height;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const int tile = static_cast<int>(i);
        const double left = layout.left(tile) + margin, right = layout.left(tile) + layout.tile_width - margin;
        const double baseline = layout.top(tile) + layout.tile_height - margin;
        const std::string number = std::to_string(frames[i].number), time = fmt::format("{:.3f} s", frames[i].time_s());
        labels.text({left, baseline}, number, height);
        const double time_left = right - text_width(time, height);
        if (time_left > left + text_width(number, height) + height) labels.text({time_left, baseline}, time, height);
    }
    labels.lay_onto(sheet, kLabel);
}

}  // namespace kadr
