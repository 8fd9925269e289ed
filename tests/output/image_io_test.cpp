#include "output/image_io.h"

#include <cmath>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "output_fixtures.h"

namespace kadr {
namespace {

using test::channel;
using test::TemporaryFolder;
using testing::HasSubstr;

const Metadata kMetadata{{"shot", "turntable"}, {"frame", "12"}, {"seconds", "0.25"}, {"settings", "0123abc"}, {"note", "Ü \"q\"\nline 2"}};

class ImageIoFormats : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, ImageIoFormats, testing::Values("exr", "png", "jpg"));

TEST_P(ImageIoFormats, MetadataComesBack) {
    const TemporaryFolder folder;
    const auto file = folder / (std::string("a.") + GetParam());
    image_io().write(file, GetParam(), test::gradient(20, 10), 8, kMetadata);
    EXPECT_EQ(image_io().read_metadata(file), kMetadata);
}

TEST_P(ImageIoFormats, TheSameImageGivesTheSameBytes) {
    const Image image = test::gradient(20, 10);
    EXPECT_EQ(image_io().encode(GetParam(), image, 8, kMetadata), image_io().encode(GetParam(), image, 8, kMetadata));
}

TEST_P(ImageIoFormats, EveryTruncationIsIncomplete) {
    const TemporaryFolder folder;
    const auto file = folder / (std::string("a.") + GetParam());
    const Bytes whole = image_io().encode(GetParam(), test::gradient(64, 64), 8, kMetadata);
    const auto write = [&](std::size_t size) {
        std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(whole.data()), static_cast<std::streamsize>(size));
    };
    write(whole.size());
    EXPECT_TRUE(image_io().is_complete(file));
    for (const std::size_t size : {whole.size() - 1, whole.size() - 20, whole.size() * 9 / 10, whole.size() / 2, whole.size() / 10,
                                   std::size_t{10}, std::size_t{0}}) {
        write(size);
        EXPECT_FALSE(image_io().is_complete(file)) << size << " of " << whole.size();
        EXPECT_THROW(image_io().read(file), InputError) << size << " of " << whole.size();
    }
}

TEST(ImageIo, ExrKeepsBeautyAsHalfAndLayersAsFloat) {
    const TemporaryFolder folder;
    const float third = 1.0f / 3, infinity = std::numeric_limits<float>::infinity();
    const Image image = test::plain_image(5, 3, {"R", "G", "B", "A", "depth.Z", "normal.X", "samples.N"},
                                          {third, 1e-3f, 2, 0.5f, infinity, third, 16777216});
    image_io().write(folder / "a.exr", "exr", image, 16, {});
    const Image back = image_io().read(folder / "a.exr");
    const auto at = [&](const char* name) { return back.at(4, 2, channel(back, name)); };
    EXPECT_EQ(back.channels.size(), image.channels.size());
    EXPECT_EQ(at("R"), 0.333251953125f);   // the half float next to 1/3
    EXPECT_EQ(at("B"), 2);
    EXPECT_EQ(at("A"), 0.5f);
    EXPECT_EQ(at("depth.Z"), infinity);
    EXPECT_EQ(at("normal.X"), third);
    EXPECT_EQ(at("samples.N"), 16777216);
}

TEST(ImageIo, ExrClampsBeautyToTheLargestHalf) {
    const TemporaryFolder folder;
    const Image image = test::plain_image(2, 2, {"R", "G", "B", "depth.Z"}, {1e6f, 65504, -1e9f, 1e6f});
    image_io().write(folder / "a.exr", "exr", image, 16, {});
    const Image back = image_io().read(folder / "a.exr");
    EXPECT_EQ(back.at(0, 0, channel(back, "R")), 65504);
    EXPECT_EQ(back.at(0, 0, channel(back, "G")), 65504);
    EXPECT_EQ(back.at(0, 0, channel(back, "B")), -65504);
    EXPECT_EQ(back.at(0, 0, channel(back, "depth.Z")), 1e6f);
}

TEST(ImageIo, Png8And16ComeBackExactly) {
    const TemporaryFolder folder;
    for (const int bits : {8, 16}) {
        const float full = bits == 8 ? 255.0f : 65535.0f;
        Image image = test::gradient(256, 4);
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
            image.pixels[i] = static_cast<float>((i * 2654435761u >> 7) % (static_cast<unsigned>(full) + 1)) / full;
        image_io().write(folder / "a.png", "png", image, bits, {});
        const Image back = image_io().read(folder / "a.png");
        ASSERT_EQ(back.pixels.size(), image.pixels.size());
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
            ASSERT_EQ(std::lround(back.pixels[i] * full), std::lround(image.pixels[i] * full)) << i;
    }
}

TEST(ImageIo, PngRoundsAndClamps) {
    const TemporaryFolder folder;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    image_io().write(folder / "a.png", "png", test::plain_image(1, 1, {"R", "G", "B"}, {100.4f / 255, 100.6f / 255, 0.5f}), 8, {});
    image_io().write(folder / "b.png", "png", test::plain_image(1, 1, {"R", "G", "B"}, {2, -1, nan}), 8, {});
    const Image rounded = image_io().read(folder / "a.png"), clamped = image_io().read(folder / "b.png");
    EXPECT_EQ(std::lround(rounded.pixels[0] * 255), 100);
    EXPECT_EQ(std::lround(rounded.pixels[1] * 255), 101);
    EXPECT_EQ(clamped.pixels, (std::vector<float>{1, 0, 0}));
}

TEST(ImageIo, PngAlphaIsStoredUnpremultipliedAndReadPremultiplied) {
    const TemporaryFolder folder;
    const float half = 51.0f / 255;
    image_io().write(folder / "a.png", "png", test::plain_image(2, 1, {"R", "G", "B", "A"}, {half, half / 2, 0, half}), 16, {});
    const Image back = image_io().read(folder / "a.png");
    EXPECT_EQ(back.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
    // Two roundings to 16 bits.
    EXPECT_NEAR(back.pixels[0], half, 1.0 / 65535);
    EXPECT_NEAR(back.pixels[1], half / 2, 1.0 / 65535);
    EXPECT_NEAR(back.pixels[3], half, 1.0 / 65535);
}

TEST(ImageIo, PngSaysThatItIsSrgb) {
    const Bytes bytes = image_io().encode("png", test::gradient(4, 4), 8, {});
    EXPECT_NE(std::string(bytes.begin(), bytes.end()).find("sRGB"), std::string::npos);
}

TEST(ImageIo, JpegIsCloseToWhatWasWritten) {
    const TemporaryFolder folder;
    const Image image = test::plain_image(32, 32, {"R", "G", "B"}, {0.2f, 0.5f, 0.8f});
    image_io().write(folder / "a.jpg", "jpg", image, 8, {});
    const Image back = image_io().read(folder / "a.jpg");
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(back.at(16, 16, c), image.at(16, 16, c), 2.5 / 255);   // YCbCr of 8 bits
}

TEST(ImageIo, SaysWhatItCannotRead) {
    const TemporaryFolder folder;
    test::write_text(folder / "text.png", "this is no image");
    EXPECT_THAT(test::message_of<InputError>([&] { image_io().read(folder / "absent.png"); }), HasSubstr("absent.png"));
    EXPECT_THAT(test::message_of<InputError>([&] { image_io().read_metadata(folder / "text.png"); }), HasSubstr("text.png"));
    EXPECT_FALSE(image_io().is_complete(folder / "text.png"));
    EXPECT_FALSE(image_io().is_complete(folder / "absent.png"));
}

TEST(ImageIo, AnUnknownFormatIsRefused) {
    EXPECT_THROW(image_io().encode("xyz", test::gradient(4, 4), 8, {}), RenderError);
}

TEST(ImageIo, CanBeOpenedInTheBackgroundMoreThanOnce) {
    open_image_io_in_background();
    open_image_io_in_background();
    EXPECT_EQ(&image_io(), &image_io());
}

}  // namespace
}  // namespace kadr
