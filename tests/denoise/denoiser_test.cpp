#include "denoise/denoiser.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include "base/error.h"
#include "render/denoising.h"

namespace kadr {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Two by one pixels of all layers; every value tells its pixel and channel: 100 x + channel.
Image numbered() {
    Image image{2, 1, {"R", "G", "B", "A", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z", "depth.Z"}, {}};
    for (int x = 0; x < 2; ++x)
        for (std::size_t c = 0; c < image.channels.size(); ++c) image.pixels.push_back(static_cast<float>(100 * x) + static_cast<float>(c));
    return image;
}

std::string refusal_of(const std::string& file) {
    try {
        open_oidn(file);
    } catch (const InputError& error) {
        return error.diagnostics().front().found;
    }
    return "none";
}

TEST(Denoiser, HandsOverThePictureAndWhatGuidesIt) {
    const auto denoiser = open_oidn(KADR_FAKE_OIDN);
    EXPECT_EQ(denoiser->version(), "2.3.4");
    Image image = numbered();
    const Image before = image;
    denoiser->apply(image);
    for (int x = 0; x < 2; ++x) {
        for (int c = 0; c < 3; ++c) EXPECT_EQ(image.at(x, 0, c), before.at(x, 0, c) + 2 * before.at(x, 0, 4 + c) + 3 * before.at(x, 0, 7 + c));
        for (int c = 3; c < 11; ++c) EXPECT_EQ(image.at(x, 0, c), before.at(x, 0, c));
    }
}

TEST(Denoiser, TakesAPictureAlone) {
    const auto denoiser = open_oidn(KADR_FAKE_OIDN);
    Image image{1, 1, {"R", "G", "B", "A"}, {1, 2, 3, 0.5f}};
    denoiser->apply(image);
    EXPECT_EQ(image.pixels, (std::vector{1.0f, 2.0f, 3.0f, 0.5f}));
}

// The library refuses normals without albedo.
TEST(Denoiser, LeavesNormalsOutWithoutAlbedo) {
    const auto denoiser = open_oidn(KADR_FAKE_OIDN);
    Image image{1, 1, {"R", "G", "B", "A", "normal.X", "normal.Y", "normal.Z"}, {1, 2, 3, 1, 9, 9, 9}};
    denoiser->apply(image);
    EXPECT_EQ(image.pixels[0], 1);
}

TEST(Denoiser, SaysWhyItCannotBeOpened) {
    EXPECT_THAT(refusal_of("/nowhere/libOpenImageDenoise.so.2"), StartsWith("cannot open the denoiser: /nowhere/libOpenImageDenoise.so.2"));
    EXPECT_THAT(refusal_of("libm.so.6"), StartsWith("libm.so.6 is not Open Image Denoise 2"));
    EXPECT_THAT(refusal_of(KADR_FAKE_OIDN_1), HasSubstr("is Open Image Denoise 1.4.3"));
}

TEST(Denoiser, PassesTheLibrarysComplaintOn) {
    const auto denoiser = open_oidn(KADR_FAKE_OIDN_BROKEN);
    Image image = numbered();
    try {
        denoiser->apply(image);
        FAIL() << "nothing was thrown";
    } catch (const RenderError& error) {
        EXPECT_STREQ(error.what(), "Open Image Denoise 2.3.4 cannot denoise a frame: out of memory");
    }
}

TEST(Denoising, LeavesTheWantedLayers) {
    setenv("KADR_OIDN_LIBRARY", KADR_FAKE_OIDN, 1);
    RenderSpec render;
    render.denoise = DenoiserKind::oidn;
    FilmLayers wanted;
    wanted.depth = true;
    const FilmLayers rendered = layers_to_render(wanted, render);
    EXPECT_TRUE(rendered.albedo && rendered.normal && rendered.depth);
    Image image = numbered();
    denoise(image, wanted, render);
    EXPECT_THAT(image.channels, ::testing::ElementsAre("R", "G", "B", "A", "depth.Z"));
    EXPECT_EQ(image.pixels, (std::vector<float>{0 + 2 * 4 + 3 * 7, 1 + 2 * 5 + 3 * 8, 2 + 2 * 6 + 3 * 9, 3, 10,
                                                100 + 2 * 104 + 3 * 107, 101 + 2 * 105 + 3 * 108, 102 + 2 * 106 + 3 * 109, 103, 110}));
}

TEST(Denoising, DoesNothingUnasked) {
    RenderSpec render;
    EXPECT_EQ(denoiser_of(render), nullptr);
    EXPECT_EQ(layers_to_render({}, render), FilmLayers{});
    Image image = numbered();
    denoise(image, {}, render);
    EXPECT_EQ(image.pixels, numbered().pixels);
}

/// A smooth picture with noise of a known size.
Image noisy(int width, int height, float sigma) {
    std::mt19937 random(1);
    std::normal_distribution<float> noise(0.0f, sigma);
    Image image{width, height, {"R", "G", "B", "A"}, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float value = 0.5f + 0.3f * std::sin(0.05f * static_cast<float>(x + y));
            for (int c = 0; c < 3; ++c) image.pixels.push_back(std::max(0.0f, value + noise(random)));
            image.pixels.push_back(1);
        }
    return image;
}

double rmse(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += (a.pixels[i] - b.pixels[i]) * static_cast<double>(a.pixels[i] - b.pixels[i]);
    return std::sqrt(sum / static_cast<double>(a.pixels.size()));
}

TEST(OpenImageDenoise, TakesMostOfTheNoiseAwayAndTheSameEachTime) {
    const char* library = std::getenv("KADR_TEST_OIDN_LIBRARY");
    if (!library) GTEST_SKIP() << "KADR_TEST_OIDN_LIBRARY names no libOpenImageDenoise.so.2 (pip install pyoidn brings one)";
    const auto denoiser = open_oidn(library);
    const Image clean = noisy(192, 128, 0.0f);
    Image image = noisy(192, 128, 0.2f), again = image;
    const double before = rmse(image, clean);
    denoiser->apply(image);
    denoiser->apply(again);
    // A mean over some thirty pixels would do as much; the library takes many more into account.
    EXPECT_LT(rmse(image, clean), before / 5);
    EXPECT_EQ(image.pixels, again.pixels);
}

}  // namespace
}  // namespace kadr
