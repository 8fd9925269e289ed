#include "render/sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "base/error.h"
#include "output/image_io.h"
#include "render/fake_device.h"
#include "render/render_job.h"
#include "render/tiny_shot.h"

namespace kadr {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

std::vector<int> numbers(int first, int last) {
    std::vector<int> all(static_cast<std::size_t>(last - first + 1));
    std::iota(all.begin(), all.end(), first);
    return all;
}

TEST(SpreadTest, KeepsTheEndsAndEvenSteps) {
    EXPECT_THAT(spread(numbers(0, 96), 5), ElementsAre(0, 24, 48, 72, 96));
    EXPECT_THAT(spread(numbers(10, 20), 2), ElementsAre(10, 20));
    EXPECT_THAT(spread(numbers(10, 20), 1), ElementsAre(10));
    EXPECT_THAT(spread({1, 5, 6}, 12), ElementsAre(1, 5, 6)) << "no frame twice";
    EXPECT_EQ(spread(numbers(0, 47), 48), numbers(0, 47));
}

TEST(SpreadTest, StepsDifferByOneFrameAtMost) {
    const std::vector<int> chosen = spread(numbers(0, 95), 12);
    ASSERT_EQ(chosen.size(), 12u);
    EXPECT_EQ(chosen.front(), 0);
    EXPECT_EQ(chosen.back(), 95);
    for (std::size_t i = 1; i < chosen.size(); ++i) EXPECT_NEAR(chosen[i] - chosen[i - 1], 95.0 / 11, 1.0);
}

TEST(SheetLayoutTest, FillsTheSheetsWidth) {
    ImageSpec image;
    image.width = 1280;
    image.height = 720;
    const SheetLayout layout = sheet_layout(4, 3, image);
    EXPECT_LE(layout.width(), 1280);
    EXPECT_GT(layout.width(), 1280 - 4);
    EXPECT_EQ(layout.tile_width, 315);
    EXPECT_EQ(layout.tile_height, 177);
    EXPECT_EQ(layout.left(0), 4);
    EXPECT_EQ(layout.top(0), 4);
    EXPECT_EQ(layout.left(5), 4 + 315 + 4);
    EXPECT_EQ(layout.top(5), 4 + 177 + 4);
    EXPECT_EQ(layout.left(11) + layout.tile_width + layout.gap, layout.width());
    EXPECT_EQ(layout.top(11) + layout.tile_height + layout.gap, layout.height());
}

TEST(SheetLayoutTest, TilesStayLegibleAndNoLargerThanTheImage) {
    ImageSpec image;
    image.width = 1280;
    image.height = 720;
    EXPECT_EQ(sheet_layout(40, 1, image).tile_width, 96) << "the sheet grows instead";
    image.width = 64;
    EXPECT_EQ(sheet_layout(4, 3, image).tile_width, 64);
}

TEST(SheetLayoutTest, RefusesWhatNobodyCanOpen) {
    ImageSpec image;
    image.width = 1280;
    image.height = 720;
    const SheetLayout layout = sheet_layout(1, 400, image);
    try {
        check_sheet_size(layout);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.diagnostics().front().found, "a sheet of 1x400 tiles would be 1280x288004 pixels large");
        EXPECT_EQ(error.diagnostics().front().expected,
                  "expected at most 64 million pixels: fewer tiles, or smaller ones by --size 160x90");
    }
}

TEST(SheetTest, TilesLandInTheirPlaces) {
    SheetLayout layout;
    layout.columns = 2;
    layout.rows = 2;
    layout.tile_width = 3;
    layout.tile_height = 2;
    Image sheet = empty_sheet(layout);
    place_tile(sheet, layout, 3, {3, 2, {"R", "G", "B"}, std::vector<float>(18, 1.0f)});
    for (int y = 0; y < sheet.height; ++y)
        for (int x = 0; x < sheet.width; ++x) {
            const bool inside = x >= 11 && x < 14 && y >= 10 && y < 12;
            EXPECT_EQ(sheet.at(x, y, 0) == 1.0f, inside) << x << " " << y;
        }
}

/// The whole of `kadr preview --sheet` on the fake device, whose frames get brighter by one 64th each.
class SheetPreviewTest : public testing::Test {
protected:
    void SetUp() override {
        fake_device() = {};
        interrupt_requested() = false;
        options_.kind = PreviewKind::sheet;
        options_.render.shot = write_tiny_shot(folder_.path(), "  frames: out/{name}.{frame:04}.png\n");
        options_.render.overrides.set = {{"view.transform", "none"}};
        options_.output = folder_.path() / "sheet.png";
        options_.columns = options_.rows = 2;
    }
    FrameReport run() { return render_preview(options_, {}); }
    Image image() const { return image_io().read(options_.output); }

    TemporaryFolder folder_;
    PreviewOptions options_;
};

TEST_F(SheetPreviewTest, ShowsTheFramesInTheirTiles) {
    const FrameReport report = run();
    EXPECT_THAT(report.frames, ElementsAre(0, 1, 2, 3));
    EXPECT_EQ(report.preview, "sheet");
    EXPECT_THAT(report.files, ElementsAre(options_.output));
    const Image sheet = image();
    EXPECT_EQ(sheet.width, 2 * 12 + 3 * 4);
    EXPECT_EQ(sheet.height, 2 * 8 + 3 * 4);
    // The upper right corner of a tile is free of labels: x + y + frame = 11 + frame 64ths.
    for (int tile = 0; tile < 4; ++tile)
        EXPECT_NEAR(sheet.at(4 + 16 * (tile % 2) + 11, 4 + 12 * (tile / 2), 0), (11 + tile) / 64.0, 0.5 / 255) << tile;
}

TEST_F(SheetPreviewTest, SpreadsTheFramesThatAreAskedFor) {
    options_.frames = {{0, 1, 2, 3, 4, 5, 6}};
    options_.columns = 3;
    options_.rows = 1;
    EXPECT_THAT(run().frames, ElementsAre(0, 3, 6));
    EXPECT_EQ(fake_device().renders, 3);
}

TEST_F(SheetPreviewTest, SizeIsThatOfATile) {
    options_.render.overrides.width = 30;
    options_.render.overrides.height = 10;
    run();
    EXPECT_EQ(image().width, 2 * 30 + 3 * 4);
    EXPECT_EQ(image().height, 2 * 10 + 3 * 4);
}

TEST_F(SheetPreviewTest, SaysWhatItIsAndNeverPassesForAFrame) {
    run();
    Metadata metadata = image_io().read_metadata(options_.output);
    EXPECT_EQ(metadata["preview"], "sheet");
    EXPECT_EQ(metadata["frames"], "0,1,2,3");
    EXPECT_EQ(metadata["shot"], "tiny");
    EXPECT_EQ(metadata.count("settings"), 0u);
    EXPECT_EQ(metadata.count("frame"), 0u);
}

TEST_F(SheetPreviewTest, RefusesLinearFilesBeforeItRenders) {
    options_.output = folder_.path() / "sheet.exr";
    try {
        run();
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.diagnostics().front().found, HasSubstr("sheet.exr'"));
        EXPECT_EQ(error.diagnostics().front().expected,
                  "expected a name that ends in .png or .jpg: it is a picture for people, not linear light");
    }
    EXPECT_EQ(fake_device().renders, 0);
}

TEST_F(SheetPreviewTest, AnInterruptLeavesNothingBehind) {
    fake_device().before_render = [](int render) { interrupt_requested() = render == 1; };
    EXPECT_THROW(run(), Interrupted);
    interrupt_requested() = false;
    EXPECT_FALSE(fs::exists(options_.output));
}

}  // namespace
}  // namespace kadr
