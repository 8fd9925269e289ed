#include "output/flip.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/error.h"
#include "output_fixtures.h"

namespace kadr {
namespace {

constexpr int kWidth = 48, kHeight = 32;

/// Red and green ramps and a blue checkerboard: smooth parts, edges and colour.
Image reference_image() {
    Image image{kWidth, kHeight, {"R", "G", "B"}, {}};
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            image.pixels.push_back(static_cast<float>(x) / (kWidth - 1));
            image.pixels.push_back(static_cast<float>(y) / (kHeight - 1));
            image.pixels.push_back((x / 8 + y / 8) % 2 == 1 ? 0.9f : 0.1f);
        }
    return image;
}

Image noisy(Image image) {
    std::uint32_t state = 12345;
    for (float& value : image.pixels) {
        state = (state * 1103515245u + 12345u) & 0x7fffffffu;
        const double noise = static_cast<double>((state >> 16) % 256) / 255.0;
        value = static_cast<float>(std::clamp(static_cast<double>(value) + 0.2 * (noise - 0.5), 0.0, 1.0));
    }
    return image;
}

Image shifted(const Image& image) {
    Image result = image;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int c = 0; c < 3; ++c)
                result.pixels[static_cast<std::size_t>((y * kWidth + (x + 2) % kWidth) * 3 + c)] = image.at(x, y, c);
    return result;
}

Image scaled(Image image, float factor) {
    for (float& value : image.pixels) value *= factor;
    return image;
}

TEST(Flip, EqualImagesDoNotDiffer) { EXPECT_EQ(mean_flip(reference_image(), reference_image()), 0); }

// The figures are those of the authors' own program (flip-evaluator 1.7, LDR) for the same images; it filters in single
// precision.
TEST(Flip, AgreesWithTheAuthorsProgram) {
    constexpr double kTolerance = 1e-3;
    const Image reference = reference_image();
    struct Case {
        Image test;
        double at_67, at_30;
    };
    const Case cases[] = {{noisy(reference), 0.127813, 0.228003},
                          {shifted(reference), 0.320588, 0.396151},
                          {scaled(reference, 0.8f), 0.542334, 0.535638},
                          {scaled(reference, 0.0f), 0.953114, 0.939072}};
    for (const Case& each : cases) {
        EXPECT_NEAR(mean_flip(reference, each.test, 67), each.at_67, kTolerance);
        EXPECT_NEAR(mean_flip(reference, each.test, 30), each.at_30, kTolerance);
    }
}

TEST(Flip, TakesColoursByTheirNames) {
    Image reordered{kWidth, kHeight, {"A", "B", "G", "R"}, {}};
    const Image reference = reference_image();
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (const float value : {1.0f, reference.at(x, y, 2), reference.at(x, y, 1), reference.at(x, y, 0)})
                reordered.pixels.push_back(value);
    EXPECT_EQ(mean_flip(reference, reordered), 0);
}

TEST(Flip, RefusesDifferentSizes) {
    EXPECT_EQ(test::message_of<InputError>([] { mean_flip(reference_image(), test::gradient(4, 4)); }),
              "error: the images to compare are 48 x 32 and 4 x 4\n  expected the same size");
}

}  // namespace
}  // namespace kadr
