#include <gtest/gtest.h>

#include "base/error.h"
#include "output/child_process.h"
#include "output/encoder.h"
#include "output_fixtures.h"

namespace kadr {
namespace {

using test::message_of;
using test::ScopedVariable;
using test::TemporaryFolder;

/// A PATH with one ffmpeg that lists what the test says.
class VideoPlanTest : public testing::Test {
protected:
    TemporaryFolder folder_;
    ScopedVariable cache_{"KADR_CACHE", (folder_ / "cache").string()};
    ScopedVariable path_{"PATH", folder_.path().string()};

    void install(const std::string& encoders, const std::string& formats) {
        std::string script = "#!/bin/sh\ncase \"$*\" in\n*-encoders*) echo ' ------'\n";
        for (std::size_t begin = 0; begin < encoders.size();) {
            const std::size_t end = std::min(encoders.find(' ', begin), encoders.size());
            script += "echo ' V....D " + encoders.substr(begin, end - begin) + "   something'\n";
            begin = end + 1;
        }
        script += ";;\n*) echo '    Supported pixel formats: " + formats + "';;\nesac\n";
        test::write_text(folder_ / "ffmpeg", script);
        fs::permissions(folder_ / "ffmpeg", fs::perms::owner_all);
    }
    void install_all() {
        install("libx264 libx265 libsvtav1 libaom-av1 libvpx-vp9 prores_ks ffv1 gif",
                "yuv420p yuv422p yuv444p yuv422p10le bgr0 pal8 gbrp16le yuv410p");
    }
    static VideoSpec video(const char* file) {
        VideoSpec spec;
        spec.file = file;
        spec.where = {"shots/pan.yaml", 20, 12};
        return spec;
    }
    static VideoPlan plan(const VideoSpec& spec, int width = 64, int height = 64, Rational fps = {24, 1}) {
        return plan_video(spec, width, height, fps);
    }
    static std::string refusal(const VideoSpec& spec, int width = 64, int height = 64, Rational fps = {24, 1}) {
        return message_of<InputError>([&] { plan(spec, width, height, fps); });
    }
};

TEST_F(VideoPlanTest, FillsInCodecEncoderAndPixelFormat) {
    install_all();
    struct Case {
        const char *file, *encoder, *pixel_format;
    };
    for (const Case& each : {Case{"a.mp4", "libx264", "yuv420p"}, Case{"a.MKV", "libx264", "yuv420p"}, Case{"a.mov", "prores_ks", "yuv422p10le"},
                             Case{"a.webm", "libvpx-vp9", "yuv420p"}, Case{"a.gif", "gif", "pal8"}}) {
        const VideoPlan made = plan(video(each.file));
        EXPECT_EQ(made.encoder, each.encoder) << each.file;
        EXPECT_EQ(made.pixel_format, each.pixel_format) << each.file;
    }
    EXPECT_EQ(plan(video("a.mp4")).crf, 18);
    EXPECT_EQ(plan(video("a.mov")).crf, std::nullopt);
}

TEST_F(VideoPlanTest, TakesTheOtherAv1EncoderWhereTheFirstIsMissingOrThePictureTooSmall) {
    VideoSpec spec = video("a.mp4");
    spec.codec = VideoCodec::av1;
    install_all();
    EXPECT_EQ(plan(spec, 64, 64).encoder, "libsvtav1");
    EXPECT_EQ(plan(spec, 32, 32).encoder, "libaom-av1");
    install("libaom-av1", "yuv420p");
    EXPECT_EQ(plan(spec, 640, 360).encoder, "libaom-av1");
}

TEST_F(VideoPlanTest, WithoutFfmpegSaysHowToGoOn) {
    EXPECT_EQ(refusal(video("a.mp4")),
              "shots/pan.yaml:20:12: error: output.video needs ffmpeg, which is not on the PATH\n"
              "  install ffmpeg (on Debian and Ubuntu: apt install ffmpeg), or remove output.video");
}

TEST_F(VideoPlanTest, OddSizesNameTheEvenOnes) {
    install_all();
    EXPECT_EQ(refusal(video("a.mp4"), 641, 359),
              "shots/pan.yaml:20:12: error: image.size is 641 x 359, but 4:2:0 video (yuv420p) needs an even width and height\n"
              "  use image.size: [642, 360], or output.video.pixel_format: yuv444p");
    EXPECT_EQ(refusal(video("a.mov"), 641, 359),
              "shots/pan.yaml:20:12: error: image.size is 641 x 359, but 4:2:2 video (yuv422p10le) needs an even width\n"
              "  use image.size: [642, 359], or output.video.pixel_format: yuv444p");
    VideoSpec full = video("a.mp4");
    full.pixel_format = "yuv444p";
    EXPECT_NO_THROW(plan(full, 641, 359));
    EXPECT_NO_THROW(plan(video("a.gif"), 641, 359));
}

TEST_F(VideoPlanTest, RefusesWhatDoesNotGoTogether) {
    install_all();
    EXPECT_EQ(refusal(video("a.avi")),
              "shots/pan.yaml:20:12: error: output.video 'a.avi' has an extension that names no container Kadr writes\n"
              "  expected .mp4, .mkv, .mov, .webm or .gif");
    VideoSpec spec = video("a.webm");
    spec.codec = VideoCodec::h264;
    EXPECT_EQ(refusal(spec), "shots/pan.yaml:20:12: error: output.video 'a.webm' cannot hold h264\n"
                             "  expected .mp4 or .mkv or .mov for h264; change the extension or output.video.codec");
    spec = video("a.mov");
    spec.crf = 12;
    EXPECT_EQ(refusal(spec), "shots/pan.yaml:20:12: error: output.video.crf is 12, but prores has no such setting\n"
                             "  remove output.video.crf");
    spec = video("a.mp4");
    spec.crf = 52;
    EXPECT_EQ(refusal(spec), "shots/pan.yaml:20:12: error: output.video.crf is 52\n"
                             "  expected 0 (best) to 51 for h264; leave it out for 18");
    EXPECT_EQ(refusal(video("a.gif"), 64, 64, {60, 1}),
              "shots/pan.yaml:20:12: error: timing.fps is 60, but a GIF plays at most 50 frames a second\n"
              "  use another container, such as .mp4, or a lower timing.fps");
}

TEST_F(VideoPlanTest, RefusesWhatThisFfmpegCannotDo) {
    install("libvpx-vp9", "yuv420p yuv444p");
    const std::string ffmpeg = (folder_ / "ffmpeg").string();
    EXPECT_EQ(refusal(video("a.mp4")), "shots/pan.yaml:20:12: error: the installed ffmpeg (" + ffmpeg +
                                           ") has no encoder libx264\n"
                                           "  install an ffmpeg that has it, or use another output.video.codec than h264");
    VideoSpec spec = video("a.webm");
    spec.pixel_format = "yuv999p";
    EXPECT_EQ(refusal(spec), "shots/pan.yaml:20:12: error: output.video.pixel_format is yuv999p, which libvpx-vp9 cannot encode\n"
                             "  expected one of yuv420p, yuv444p");
}

}  // namespace
}  // namespace kadr
