#include "film/film.h"

#include <cmath>
#include <limits>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kadr {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

FilmLayers all_layers() { return {true, true, true, true, true, true}; }

int channel(const Image& image, const std::string& name) {
    for (std::size_t i = 0; i < image.channels.size(); ++i)
        if (image.channels[i] == name) return static_cast<int>(i);
    ADD_FAILURE() << "no channel " << name;
    return 0;
}

TEST(Film, NamesTheChannelsInOrder) {
    EXPECT_THAT(Film(1, 1, {}).develop().channels, testing::ElementsAre("R", "G", "B", "A"));
    EXPECT_THAT(Film(1, 1, all_layers()).develop().channels,
                testing::ElementsAre("R", "G", "B", "A", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z",
                                     "depth.Z", "motion.X", "motion.Y", "samples.N", "error.Y"));
}

TEST(Film, AMillionSamplesAddUp) {
    Film film(1, 1, {});
    const float value = 0.1f;
    for (int i = 0; i < 1'000'000; ++i) {
        film.beauty(0, 0, i % 2).r += value;
        ++film.samples(0, 0, i % 2);
    }
    // Sums of floats would be off by more than a percent: added to 50,000, a tenth counts as 0.1016.
    EXPECT_EQ(film.develop().at(0, 0, 0), value);
}

TEST(Film, DividesSumsBySamples) {
    Film film(2, 1, all_layers());
    film.beauty(1, 0) = {4, 8, 12, 2};
    film.samples(1, 0) = 4;
    film.add_surface(1, 0, {{1, 2, 3}, {0, 3, 4}, 6, 2, {5, -1}});
    const Image image = film.develop();
    const auto at = [&](const char* name) { return image.at(1, 0, channel(image, name)); };
    EXPECT_EQ(at("R"), 1);
    EXPECT_EQ(at("G"), 2);
    EXPECT_EQ(at("B"), 3);
    EXPECT_EQ(at("A"), 0.5f);
    EXPECT_EQ(at("albedo.B"), 0.75f);
    EXPECT_FLOAT_EQ(at("normal.Y"), 0.6f);
    EXPECT_FLOAT_EQ(at("normal.Z"), 0.8f);
    EXPECT_EQ(at("depth.Z"), 3);
    EXPECT_EQ(at("motion.X"), 2.5f);
    EXPECT_EQ(at("motion.Y"), -0.5f);
    EXPECT_EQ(at("samples.N"), 4);
}

TEST(Film, OpaqueStaysOpaqueForEveryNumberOfSamples) {
    Film film(1, 1, {});
    for (std::uint32_t n = 1; n <= 4096; ++n) {
        film.clear();
        film.beauty(0, 0).alpha = static_cast<float>(n);
        film.samples(0, 0) = n;
        ASSERT_EQ(film.develop().at(0, 0, 3), 1.0f) << n;
    }
}

TEST(Film, APixelWithoutSamplesIsTransparentAndInfinitelyFar) {
    const Image image = Film(1, 1, all_layers()).develop();
    for (std::size_t i = 0; i < image.channels.size(); ++i)
        EXPECT_EQ(image.pixels[i], image.channels[i] == "depth.Z" ? kInfinity : 0.0f) << image.channels[i];
}

TEST(Film, HoldsNoNanAndNoInfinityButTheBackgroundsDepth) {
    Film film(1, 1, all_layers());
    film.beauty(0, 0) = {kNan, kInfinity, -kInfinity, kNan};
    film.samples(0, 0) = 1;
    film.add_surface(0, 0, {{kNan, kInfinity, 0}, {kNan, 0, 1}, kNan, 1, {kInfinity, kNan}});
    film.beauty(0, 0, 1) = {1, 1, 1, 1};
    film.samples(0, 0, 1) = 1;
    for (const float value : film.develop().pixels) EXPECT_TRUE(std::isfinite(value)) << value;
}

TEST(Film, ErrorIsTheStandardErrorOfTheMean) {
    Film film(1, 1, all_layers());
    // Means 1 and 3 of one sample and of three: variance of their mean (1 - 3)² 1·3 / 4².
    film.beauty(0, 0, 0) = {1, 1, 1, 1};
    film.samples(0, 0, 0) = 1;
    film.beauty(0, 0, 1) = {9, 9, 9, 3};
    film.samples(0, 0, 1) = 3;
    const Image image = film.develop();
    EXPECT_FLOAT_EQ(image.at(0, 0, channel(image, "error.Y")), std::sqrt(0.75f));
}

TEST(Film, KeepsOnlyTheLayersThatAreWanted) {
    FilmLayers layers;
    layers.normal = layers.motion = true;
    Film film(1, 1, layers);
    film.samples(0, 0) = 1;
    film.add_surface(0, 0, {{1, 2, 3}, {0, 3, 4}, 6, 2, {5, -1}});
    const Film::Surface sums = film.surface(0, 0);
    EXPECT_EQ(sums.normal[1], 3);
    EXPECT_EQ(sums.motion[1], -1);
    EXPECT_EQ(sums.depth_weight, 2) << "what motion is divided by";
    EXPECT_EQ(sums.albedo[0], 0);
    EXPECT_EQ(sums.depth, 0);
    EXPECT_THAT(film.develop().channels, testing::ElementsAre("R", "G", "B", "A", "normal.X", "normal.Y", "normal.Z", "motion.X", "motion.Y"));
    EXPECT_EQ(Film::bytes_per_pixel(layers, 1, false), 36u + 24 + 16 + 8);
    EXPECT_EQ(Film::bytes_per_pixel({}, 2, true), 2u * (36 + 8));
}

TEST(Film, OfOneHalfIsThePictureWithoutItsNoise) {
    Film film(1, 1, {}, 1);
    film.beauty(0, 0) = {4, 8, 12, 2};
    film.samples(0, 0) = 4;
    EXPECT_THAT(film.develop().pixels, testing::ElementsAre(1, 2, 3, 0.5f));
    EXPECT_EQ(film.samples_of_both(0, 0), 4u);
    EXPECT_EQ(film.divisor(0, 0, 1), 0);
}

/// Values that tell every pixel of every layer.
Film numbered(int width, int height, const FilmLayers& layers) {
    Film film(width, height, layers);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double n = 1 + x + 0.001 * y;
            for (int half = 0; half < 2; ++half) {
                film.beauty(x, y, half) = {n, 2 * n + half, 3 * n, 1};
                film.samples(x, y, half) = 1;
            }
            film.add_surface(x, y, {{n, n, 2 * n}, {0, 1, n}, n, 1, {n, -n}});
        }
    return film;
}

TEST(Film, IsTheSamePictureWhetherItGoesOrStays) {
    constexpr int kWidth = 4096, kHeight = 1100;  // three bands
    FilmLayers layers;
    layers.depth = layers.error = true;
    Film film = numbered(kWidth, kHeight, layers);
    const Image stays = film.develop();
    for (const int y : {0, 511, 512, 1023, 1024, 1099}) EXPECT_FLOAT_EQ(stays.at(7, y, 0), 8 + 0.001f * static_cast<float>(y));
    const Image goes = Film::develop(std::move(film));
    EXPECT_EQ(goes.channels, stays.channels);
    EXPECT_TRUE(goes.pixels == stays.pixels);
}

TEST(Film, ClearForgetsEverything) {
    Film film(1, 1, all_layers());
    film.beauty(0, 0) = {1, 1, 1, 1};
    film.samples(0, 0) = 1;
    film.add_surface(0, 0, {{1, 1, 1}, {0, 0, 1}, 1, 1, {1, 1}});
    film.beauty(0, 0, 1) = {1, 1, 1, 1};
    film.samples(0, 0, 1) = 2;
    film.clear();
    EXPECT_EQ(film.develop().pixels, Film(1, 1, all_layers()).develop().pixels);
}

}  // namespace
}  // namespace kadr
