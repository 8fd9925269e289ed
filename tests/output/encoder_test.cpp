#include "output/encoder.h"

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "output/child_process.h"
#include "output_fixtures.h"

namespace kadr {
namespace {

using test::gradient;
using test::message_of;
using test::ScopedVariable;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Rational kFps{24, 1};

VideoSpec video(const fs::path& file) {
    VideoSpec spec;
    spec.file = file;
    return spec;
}

/// An executable of this name that is a shell script.
void write_script(const fs::path& file, const std::string& body) {
    test::write_text(file, "#!/bin/sh\n" + body);
    fs::permissions(file, fs::perms::owner_all);
}

/// Answers the probe as an ffmpeg with H.264 does; everything else runs `encode`.
void write_fake_ffmpeg(const fs::path& file, const std::string& encode) {
    write_script(file, "case \"$*\" in\n"
                       "*-encoders*) echo \" ------\"; echo \" V....D libx264  H.264\";;\n"
                       "*-h\\ encoder*) echo \"    Supported pixel formats: yuv420p yuv444p\";;\n"
                       "*) " + encode + ";;\nesac\n");
}

/// The answers of ffmpeg's probe are kept over all tests of this file.
const TemporaryFolder& shared_cache() {
    static const TemporaryFolder folder;
    return folder;
}

class EncoderTest : public testing::Test {
protected:
    TemporaryFolder folder_;
    ScopedVariable cache_{"KADR_CACHE", shared_cache().path().string()};

    /// What ffprobe says of the video stream.
    static std::map<std::string, std::string> probed(const fs::path& file) {
        const ProgramResult result = run_program({find_program("ffprobe")->string(), "-v", "error", "-count_packets", "-select_streams",
                                                  "v:0", "-show_streams", "-of", "default=nw=1", file.string()});
        std::map<std::string, std::string> values;
        std::istringstream lines(result.output);
        for (std::string line; std::getline(lines, line);)
            if (const std::size_t equal = line.find('='); equal != std::string::npos)
                values.emplace(line.substr(0, equal), line.substr(equal + 1));
        return values;
    }
};

#define SKIP_WITHOUT_FFMPEG() \
    if (!find_program("ffmpeg") || !find_program("ffprobe")) GTEST_SKIP() << "ffmpeg and ffprobe are not on the PATH"

struct CodecCase {
    const char* file;
    VideoCodec codec;
    int size;
    const char* codec_name;   ///< as ffprobe says
    const char* pixel_format;
    const char* colors;       ///< range, space, transfer, primaries
};

// The test's name, instead of the bytes of the case.
void PrintTo(const CodecCase& each, std::ostream* out) { *out << each.file << " " << each.codec_name; }

class EncoderCodecs : public EncoderTest, public testing::WithParamInterface<CodecCase> {};

constexpr const char* kBt709 = "tv bt709 bt709 bt709";
INSTANTIATE_TEST_SUITE_P(All, EncoderCodecs,
                         testing::Values(CodecCase{"a.mp4", VideoCodec::h264, 16, "h264", "yuv420p", kBt709},
                                         CodecCase{"a.mkv", VideoCodec::h264, 16, "h264", "yuv420p", kBt709},
                                         CodecCase{"b.mp4", VideoCodec::h265, 16, "hevc", "yuv420p", kBt709},
                                         CodecCase{"c.mp4", VideoCodec::av1, 16, "av1", "yuv420p", kBt709},
                                         CodecCase{"d.mkv", VideoCodec::av1, 64, "av1", "yuv420p", kBt709},
                                         CodecCase{"e.webm", VideoCodec::vp9, 16, "vp9", "yuv420p", kBt709},
                                         CodecCase{"f.mov", VideoCodec::prores, 16, "prores", "yuv422p10le", kBt709},
                                         CodecCase{"g.mkv", VideoCodec::ffv1, 16, "ffv1", "bgr0", "pc gbr iec61966-2-1 bt709"},
                                         CodecCase{"h.gif", VideoCodec::gif, 16, "gif", "bgra", nullptr}));

TEST_P(EncoderCodecs, WritesEveryFrameWithItsTags) {
    SKIP_WITHOUT_FFMPEG();
    const CodecCase& expected = GetParam();
    VideoSpec spec = video(folder_ / "new" / expected.file);
    spec.codec = expected.codec;
    Encoder encoder(plan_video(spec, expected.size, expected.size, kFps));
    // The second half stands still: encoders like to drop such frames.
    for (int frame = 0; frame < 6; ++frame) encoder.push(gradient(expected.size, expected.size, std::min(frame, 3)));
    encoder.finish();
    auto found = probed(spec.file);
    EXPECT_EQ(found["nb_read_packets"], "6");
    EXPECT_EQ(found["codec_name"], expected.codec_name);
    EXPECT_EQ(found["pix_fmt"], expected.pixel_format);
    if (expected.codec != VideoCodec::gif) {   // a GIF counts hundredths of a second and knows no tags
        EXPECT_EQ(found["r_frame_rate"], "24/1");
        EXPECT_EQ(found["color_range"] + " " + found["color_space"] + " " + found["color_transfer"] + " " + found["color_primaries"],
                  expected.colors);
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(spec.file.parent_path()), fs::directory_iterator()), 1);
}

TEST_F(EncoderTest, Ffv1ComesBackBitForBit) {
    SKIP_WITHOUT_FFMPEG();
    VideoSpec spec = video(folder_ / "a.mkv");
    spec.codec = VideoCodec::ffv1;
    const Image image = gradient(17, 9);   // odd: no chroma is shared
    Encoder encoder(plan_video(spec, 17, 9, kFps));
    encoder.push(image);
    encoder.finish();
    const ProgramResult decoded = run_program({find_program("ffmpeg")->string(), "-v", "error", "-i", spec.file.string(), "-f",
                                               "rawvideo", "-pix_fmt", "rgb24", "-"});
    ASSERT_EQ(decoded.output.size(), image.pixels.size());
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        ASSERT_EQ(static_cast<unsigned char>(decoded.output[i]), std::lround(image.pixels[i] * 255)) << i;
}

TEST_F(EncoderTest, SixteenBitsReachAFormatThatHoldsThem) {
    SKIP_WITHOUT_FFMPEG();
    VideoSpec spec = video(folder_ / "a.mkv");
    spec.codec = VideoCodec::ffv1;
    spec.pixel_format = "gbrp16le";
    const float value = 12345.0f / 65535;
    Encoder encoder(plan_video(spec, 4, 4, kFps));
    encoder.push(test::plain_image(4, 4, {"R", "G", "B"}, {value, value, value}));
    encoder.finish();
    const ProgramResult decoded = run_program({find_program("ffmpeg")->string(), "-v", "error", "-i", spec.file.string(), "-f",
                                               "rawvideo", "-pix_fmt", "rgb48le", "-"});
    ASSERT_EQ(decoded.output.size(), 96u);
    EXPECT_EQ(static_cast<unsigned char>(decoded.output[0]) + 256 * static_cast<unsigned char>(decoded.output[1]), 12345);
}

TEST_F(EncoderTest, ColoursAreConvertedWithTheBt709Matrix) {
    SKIP_WITHOUT_FFMPEG();
    VideoSpec spec = video(folder_ / "a.mp4");
    spec.crf = 0;
    Encoder encoder(plan_video(spec, 16, 16, kFps));
    encoder.push(test::plain_image(16, 16, {"R", "G", "B"}, {1, 0, 0}));
    encoder.finish();
    const ProgramResult decoded = run_program({find_program("ffmpeg")->string(), "-v", "error", "-i", spec.file.string(), "-f",
                                               "rawvideo", "-pix_fmt", "yuv420p", "-"});
    ASSERT_EQ(decoded.output.size(), 384u);
    // BT.709, red: Y = 16 + 219 * 0.2126 = 62.6, Cb = 128 - 224 * 0.2126 / 1.8556 = 102.3, Cr = 240. BT.601 would give Y = 81.
    EXPECT_NEAR(static_cast<unsigned char>(decoded.output[0]), 62.6, 1);
    EXPECT_NEAR(static_cast<unsigned char>(decoded.output[256]), 102.3, 1);
    EXPECT_NEAR(static_cast<unsigned char>(decoded.output[320]), 240, 1);
}

TEST_F(EncoderTest, TheSameFramesGiveTheSameFile) {
    SKIP_WITHOUT_FFMPEG();
    const auto bytes = [&](const char* name) {
        VideoSpec spec = video(folder_ / name);
        Encoder encoder(plan_video(spec, 32, 32, {24000, 1001}));
        for (int frame = 0; frame < 5; ++frame) encoder.push(gradient(32, 32, frame));
        encoder.finish();
        std::ifstream file(spec.file, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    EXPECT_EQ(bytes("a.mp4"), bytes("b.mp4"));
    EXPECT_EQ(probed(folder_ / "a.mp4")["r_frame_rate"], "24000/1001");
}

TEST_F(EncoderTest, AnAbandonedVideoLeavesNothing) {
    SKIP_WITHOUT_FFMPEG();
    {
        Encoder encoder(plan_video(video(folder_ / "out/a.mp4"), 16, 16, kFps));
        encoder.push(gradient(16, 16));
    }
    EXPECT_TRUE(fs::is_empty(folder_ / "out"));
}

TEST_F(EncoderTest, AFrameOfAnotherSizeIsRefused) {
    SKIP_WITHOUT_FFMPEG();
    Encoder encoder(plan_video(video(folder_ / "a.mp4"), 16, 16, kFps));
    EXPECT_EQ(message_of<RenderError>([&] { encoder.push(gradient(8, 16)); }),
              "a frame of 8 x 16 does not fit into the video '" + (folder_ / "a.mp4").string() +
                  "' of 16 x 16; render it again with --overwrite");
}

// --- Failing programs ------------------------------------------------------------------------------------------------

class FakeFfmpeg : public EncoderTest {
protected:
    ScopedVariable path_{"PATH", (folder_ / "bin").string() + ":/usr/bin:/bin"};
    void SetUp() override { fs::create_directory(folder_ / "bin"); }
    void install(const std::string& encode) { write_fake_ffmpeg(folder_ / "bin/ffmpeg", encode); }
    VideoPlan plan() { return plan_video(video(folder_ / "out/a.mp4"), 512, 512, kFps); }
    std::string failure(int frames) {
        Encoder encoder(plan());
        return message_of<RenderError>([&] {
            for (int frame = 0; frame < frames; ++frame) encoder.push(gradient(512, 512));
            encoder.finish();
        });
    }
    std::string start() const { return "cannot write the video '" + (folder_ / "out/a.mp4").string() + "': "; }
};

TEST_F(FakeFfmpeg, ThatFailsAtOnceIsQuoted) {
    install("echo 'first line' >&2; echo 'Error: the disk is on fire' >&2; exit 3");
    // 20 frames are more than the pipe holds, so the broken pipe is met whenever the program ends.
    EXPECT_THAT(failure(20), testing::AllOf(testing::StartsWith(start() + "ffmpeg stopped after "),
                                            HasSubstr(" frames (exit status 3); the images are kept\n  ffmpeg's last lines:\n"
                                                      "    first line\n    Error: the disk is on fire")));
    EXPECT_TRUE(fs::is_empty(folder_ / "out"));
}

TEST_F(FakeFfmpeg, ThatFailsAtTheEndIsQuoted) {
    install("cat > /dev/null; echo 'no space' >&2; exit 1");
    EXPECT_EQ(failure(2), start() + "ffmpeg failed (exit status 1); the images are kept\n  ffmpeg's last lines:\n    no space");
}

TEST_F(FakeFfmpeg, ThatLosesAFrameIsFoundOut) {
    install("case \"$*\" in *-progress*) echo frame=2;; *) cat > /dev/null; for last; do :; done; echo x > \"${last#file:}\";; esac");
    EXPECT_EQ(failure(3), start() + "it has 2 frames instead of 3 (exit status 0); the images are kept\n  ffmpeg said nothing");
    EXPECT_TRUE(fs::is_empty(folder_ / "out"));
}

TEST_F(FakeFfmpeg, ThatIsKilledIsReported) {
    install("kill -9 $$");
    EXPECT_THAT(failure(20), HasSubstr("(exit status 137)"));
}

TEST_F(FakeFfmpeg, IsAskedOnlyOnce) {
    install("true");
    plan();
    // Answers nothing any more, but size and time are the same: the cache speaks for it.
    const auto program = folder_ / "bin/ffmpeg";
    const auto time = fs::last_write_time(program);
    const auto size = fs::file_size(program);
    write_script(program, "exit 9\n");
    fs::resize_file(program, size);
    fs::last_write_time(program, time);
    EXPECT_NO_THROW(plan());
    fs::last_write_time(program, time + std::chrono::seconds(1));
    EXPECT_THROW(plan(), RenderError);
}

TEST_F(FakeFfmpeg, WorksWithoutAWritableCache) {
    install("true");
    test::write_text(folder_ / "file", "");
    const ScopedVariable cache("KADR_CACHE", (folder_ / "file/cache").string());
    EXPECT_EQ(plan().encoder, "libx264");
}

}  // namespace
}  // namespace kadr
