#include "output/drawing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "output/stroke_font.h"

namespace kadr {
namespace {

Image picture(int width, int height, float value) {
    return {width, height, {"R", "G", "B"}, std::vector<float>(3u * width * height, value)};
}

/// The red of a drawing in pure red over grey: 1 where it covers, below the ground where the outline does.
float red(const Image& image, int x, int y) { return image.at(x, y, 0); }

TEST(DrawingTest, LineCoversItsPixelsAndNoOthers) {
    Drawing drawing(20, 20);
    drawing.line({5, 10}, {15, 10}, 2);  // rows 9 and 10
    Image image = picture(20, 20, 0.5f);
    drawing.lay_onto(image, {1, 0, 0});
    for (int x = 5; x < 15; ++x) {
        EXPECT_FLOAT_EQ(red(image, x, 9), 1.0f) << x;
        EXPECT_FLOAT_EQ(red(image, x, 10), 1.0f) << x;
        EXPECT_LT(red(image, x, 8), 0.5f) << "the dark outline";
        EXPECT_FLOAT_EQ(red(image, x, 5), 0.5f) << "untouched";
    }
    EXPECT_FLOAT_EQ(red(image, 1, 10), 0.5f);
    EXPECT_FLOAT_EQ(red(image, 19, 10), 0.5f);
}

TEST(DrawingTest, EdgesAreSmooth) {
    // The centres of row 8 are 1.5 pixels from the line's middle; half its width is 1.25, and 1.25 + 0.5 - 1.5 is
    // covered.
    Drawing drawing(20, 20);
    drawing.line({5, 10}, {15, 10}, 2.5);
    Image image = picture(20, 20, 0.0f);
    drawing.lay_onto(image, {1, 0, 0});
    EXPECT_NEAR(red(image, 10, 8), 0.25f, 0.02f) << "the outline below is nearly black";
    EXPECT_FLOAT_EQ(red(image, 10, 9), 1.0f);
}

TEST(DrawingTest, OverlappingStrokesOfOneDrawingDoNotAddUp) {
    Image once = picture(20, 20, 0.2f), twice = once;
    Drawing one(20, 20), two(20, 20);
    one.line({5, 10}, {15, 10}, 3, 0.5);
    two.line({5, 10}, {15, 10}, 3, 0.5);
    two.line({8, 10}, {18, 10}, 3, 0.5);
    one.lay_onto(once, {1, 0, 0});
    two.lay_onto(twice, {1, 0, 0});
    EXPECT_FLOAT_EQ(red(once, 10, 10), red(twice, 10, 10));
}

TEST(DrawingTest, ReadsOnBlackAndOnWhite) {
    for (const float ground : {0.0f, 1.0f}) {
        Drawing drawing(40, 20);
        drawing.text({5, 15}, "8", 10);
        Image image = picture(40, 20, ground);
        drawing.lay_onto(image, {1, 1, 1});
        float darkest = 1, brightest = 0;
        for (int y = 0; y < 20; ++y)
            for (int x = 0; x < 40; ++x) {
                darkest = std::min(darkest, red(image, x, y));
                brightest = std::max(brightest, red(image, x, y));
            }
        EXPECT_LT(darkest, 0.4f) << ground;
        EXPECT_GT(brightest, 0.8f) << ground;
    }
}

TEST(DrawingTest, WhatLiesOutsideOrNowhereIsHarmless) {
    Drawing drawing(10, 10);
    drawing.line({-1e12, 5}, {1e12, 5}, 1);
    drawing.line({NAN, 5}, {5, 5}, 1);
    drawing.line({INFINITY, 5}, {5, 5}, 1);
    drawing.disc({-50, -50}, 4);
    drawing.text({100, 100}, "far", 10);
    Image image = picture(10, 10, 0.0f);
    drawing.lay_onto(image, {1, 0, 0});
    EXPECT_FLOAT_EQ(red(image, 0, 5), red(image, 9, 5));
    EXPECT_GT(red(image, 5, 5), 0.4f);
    EXPECT_FLOAT_EQ(red(image, 5, 0), 0.0f);
}

TEST(DrawingTest, CircleHasItsRadius) {
    Drawing drawing(41, 41);
    drawing.circle({20.5, 20.5}, 15, 1);
    Image image = picture(41, 41, 0.0f);
    drawing.lay_onto(image, {1, 0, 0});
    EXPECT_GT(red(image, 35, 20), 0.9f);
    EXPECT_GT(red(image, 20, 5), 0.9f);
    EXPECT_FLOAT_EQ(red(image, 20, 20), 0.0f);
}

TEST(StrokeFontTest, HasEveryLetterThatLabelsNeed) {
    const Glyph box = glyph_of('\x01');
    for (char letter = 'a'; letter <= 'z'; ++letter) EXPECT_NE(glyph_of(letter), box) << letter;
    for (char letter = 'A'; letter <= 'Z'; ++letter) EXPECT_NE(glyph_of(letter), box) << letter;
    for (const char letter : std::string("0123456789.,-+:/_()!# ")) EXPECT_NE(glyph_of(letter), box) << letter;
    for (char a = '0'; a <= '9'; ++a)
        for (char b = '0'; b < a; ++b) EXPECT_NE(glyph_of(a), glyph_of(b)) << a << b;
}

TEST(StrokeFontTest, StaysOnItsGrid) {
    for (int code = 32; code < 127; ++code)
        for (const auto& stroke : glyph_of(static_cast<char>(code)))
            for (const glm::ivec2& point : stroke) {
                EXPECT_TRUE(point.x >= 0 && point.x <= 4) << static_cast<char>(code);
                EXPECT_TRUE(point.y >= 0 && point.y <= 8) << static_cast<char>(code);
            }
}

TEST(StrokeFontTest, WidthsAddUp) {
    EXPECT_DOUBLE_EQ(text_width("", 12), 0);
    EXPECT_DOUBLE_EQ(text_width("08", 12), 24);
    EXPECT_DOUBLE_EQ(text_width("0.8", 12), 28) << "a full stop is narrow";
    EXPECT_DOUBLE_EQ(text_width("\xc3\xa4", 12), text_width("\x01", 12)) << "one letter of two bytes";
}

}  // namespace
}  // namespace kadr
