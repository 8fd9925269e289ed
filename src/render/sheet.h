#pragma once

#include <string>
#include <vector>

#include "anim/timing.h"
#include "film/film.h"
#include "shot/shot.h"

namespace kadr {

/// Where the tiles of a contact sheet go: rows from the top, a thin gap between tiles and around them.
struct SheetLayout {
    int columns = 1, rows = 1;
    int tile_width = 0, tile_height = 0, gap = 4;
    bool operator==(const SheetLayout&) const = default;
    int tiles() const { return columns * rows; }
    int width() const { return columns * (tile_width + gap) + gap; }
    int height() const { return rows * (tile_height + gap) + gap; }
    int left(int tile) const { return gap + tile % columns * (tile_width + gap); }
    int top(int tile) const { return gap + tile / columns * (tile_height + gap); }
};

/// A sheet 1280 pixels wide, with tiles of the image's aspect, at least 96 pixels wide (the sheet grows then) and no
/// larger than the image.
SheetLayout sheet_layout(int columns, int rows, const ImageSpec& image);
/// @throws InputError  where the sheet would have more than 64 million pixels
void check_sheet_size(const SheetLayout& layout);

/// At most `count` of the frames, evenly spread, the first and the last among them.
std::vector<int> spread(const std::vector<int>& frames, int count);

/// The empty sheet: a dark, neutral ground.
Image empty_sheet(const SheetLayout& layout);
/// Copies a display-referred picture of the tile's size into the sheet.
void place_tile(Image& sheet, const SheetLayout& layout, int tile, const Image& picture);
/// Writes the frame's number into the lower left corner of each tile and its time into the lower right one.
void label_tiles(Image& sheet, const SheetLayout& layout, const std::vector<FrameTime>& frames);

}  // namespace kadr
