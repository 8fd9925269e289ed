// Sound under a video: what is refused, and what ffprobe and a decoder find in the file.
#include <cmath>
#include <cstring>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "output/child_process.h"
#include "output/encoder.h"
#include "output_fixtures.h"

namespace kadr {
namespace {

using test::gradient;
using test::message_of;
using test::ScopedVariable;
using test::TemporaryFolder;
using testing::HasSubstr;

#define SKIP_WITHOUT_FFMPEG() \
    if (!find_program("ffmpeg") || !find_program("ffprobe")) GTEST_SKIP() << "ffmpeg and ffprobe are not on the PATH"

constexpr int kRate = 48000;
constexpr Rational kFps{24, 1};

template <class Value>
void put(std::ofstream& file, Value value) { file.write(reinterpret_cast<const char*>(&value), sizeof value); }

/// A WAV file, mono, 16 bits, with the same value everywhere.
void write_wav(const fs::path& path, int samples, std::int16_t value) {
    std::ofstream file(path, std::ios::binary);
    const std::uint32_t bytes = static_cast<std::uint32_t>(samples) * 2;
    file << "RIFF";
    put(file, 36 + bytes);
    file << "WAVEfmt ";
    put<std::uint32_t>(file, 16);
    put<std::uint16_t>(file, 1);
    put<std::uint16_t>(file, 1);
    put<std::uint32_t>(file, kRate);
    put<std::uint32_t>(file, kRate * 2);
    put<std::uint16_t>(file, 2);
    put<std::uint16_t>(file, 16);
    file << "data";
    put(file, bytes);
    for (int i = 0; i < samples; ++i) put(file, value);
}

class SoundTest : public testing::Test {
protected:
    void SetUp() override {
        SKIP_WITHOUT_FFMPEG();
        write_wav(folder_ / "one.wav", kRate, 16384);
        sound_.file = folder_ / "one.wav";
        sound_.where = {"reel.yaml", 3, 8};
    }
    VideoPlan video(const char* name, std::optional<VideoCodec> codec = {}) const {
        VideoSpec spec;
        spec.file = folder_ / name;
        spec.codec = codec;
        return plan_video(spec, 16, 16, kFps);
    }
    /// A video of 48 frames (2 s) with the sound under it. @return its samples, decoded
    std::vector<float> encoded(const char* name, std::optional<VideoCodec> codec = {}, Rational from = {0, 1}, Rational whole = {2, 1}) {
        VideoPlan plan = video(name, codec);
        plan.sound = plan_sound(sound_, plan);
        plan.sound->whole_s = whole;
        plan.sound->from_s = from;
        plan.sound->length_s = {2, 1};
        Encoder encoder(plan);
        for (int frame = 0; frame < 48; ++frame) encoder.push(gradient(16, 16, frame));
        encoder.finish();
        const ProgramResult decoded = run_program({find_program("ffmpeg")->string(), "-v", "error", "-i", plan.file.string(), "-map",
                                                   "0:a:0", "-f", "f32le", "-ac", "1", "-"});
        std::vector<float> samples(decoded.output.size() / 4);
        std::memcpy(samples.data(), decoded.output.data(), samples.size() * 4);
        return samples;
    }
    static float at(const std::vector<float>& samples, double seconds) {
        return samples.at(static_cast<std::size_t>(std::lround(seconds * kRate)));
    }
    std::string refused(const char* name, std::optional<VideoCodec> codec = {}) {
        const VideoPlan plan = video(name, codec);
        return message_of<InputError>([&] { plan_sound(sound_, plan); });
    }

    TemporaryFolder folder_;
    ScopedVariable cache_{"KADR_CACHE", (folder_ / "cache").string()};
    SoundSpec sound_;
};

// FLAC keeps every value: 16384 of 32768 is one half; 16 bits are 3e-5.
constexpr double kStep = 1.0 / 32768;

TEST_F(SoundTest, IsAsLongAsTheVideoAndSilentAfterItsEnd) {
    const std::vector<float> samples = encoded("a.mkv", VideoCodec::ffv1);
    EXPECT_EQ(samples.size(), 2u * kRate) << "exactly";
    EXPECT_NEAR(at(samples, 0), 0.5, kStep);
    EXPECT_NEAR(at(samples, 0.999), 0.5, kStep);
    EXPECT_EQ(at(samples, 1.001), 0);
}

TEST_F(SoundTest, BeginsAgainWhereItEnds) {
    sound_.loop = true;
    EXPECT_NEAR(at(encoded("a.mkv", VideoCodec::ffv1), 1.5), 0.5, kStep);
}

TEST_F(SoundTest, StartsLaterLouderAndFades) {
    sound_.offset_s = 0.5;
    sound_.start_s = 0.25;
    sound_.gain_db = -20;   // a tenth
    sound_.fade_in_s = 0.2;
    sound_.fade_out_s = 1.5;
    const std::vector<float> samples = encoded("a.mkv", VideoCodec::ffv1);
    EXPECT_EQ(at(samples, 0.49), 0);
    EXPECT_NEAR(at(samples, 0.6), 0.05 * 0.5 * (1.4 / 1.5), 2 * kStep) << "half risen, and falling since 0.5 s";
    EXPECT_NEAR(at(samples, 1.0), 0.05 * (1.0 / 1.5), 2 * kStep);
    EXPECT_EQ(at(samples, 1.26), 0) << "three quarters of a second are left of the file";
}

TEST_F(SoundTest, OfAPartOfTheReelIsThatPart) {
    sound_.offset_s = 2.5;
    const std::vector<float> samples = encoded("a.mkv", VideoCodec::ffv1, {2, 1}, {10, 1});
    EXPECT_EQ(at(samples, 0.49), 0);
    EXPECT_NEAR(at(samples, 0.51), 0.5, kStep);
}

struct Container {
    const char* file;
    const char* codec;
};

TEST_F(SoundTest, HasTheCodecOfItsContainer) {
    for (const Container& each : {Container{"a.mp4", "aac"}, {"a.mov", "pcm_s24le"}, {"a.webm", "opus"}, {"a.mkv", "aac"}}) {
        const std::vector<float> samples = encoded(each.file);
        const ProgramResult probed = run_program({find_program("ffprobe")->string(), "-v", "error", "-select_streams", "a:0", "-show_entries",
                                                  "stream=codec_name", "-of", "default=nw=1:nk=1", (folder_ / each.file).string()});
        EXPECT_EQ(probed.output, std::string(each.codec) + "\n") << each.file;
        // A frame of AAC has 1024 samples: the last one may be filled up, and Matroska keeps the encoder's lead of one frame.
        EXPECT_NEAR(static_cast<double>(samples.size()), 2.0 * kRate, 2048) << each.file;
        // A codec with loss rings at the beginning; the middle of a constant is one.
        EXPECT_NEAR(std::abs(at(samples, 0.5)), each.codec == std::string("opus") ? 0 : 0.5, each.codec == std::string("opus") ? 1 : 0.01);
    }
}

TEST_F(SoundTest, TheSameSoundGivesTheSameFile) {
    const auto bytes = [&](const char* name) {
        encoded(name);
        std::ifstream file(folder_ / name, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    EXPECT_EQ(bytes("a.mp4"), bytes("b.mp4"));
}

TEST_F(SoundTest, SaysWhatIsWrong) {
    EXPECT_EQ(refused("a.gif"), "reel.yaml:3:8: error: the reel has sound, which the video 'a.gif' cannot hold\n"
                                "  write the video as .mp4, .mkv, .mov or .webm, or remove sound");
    sound_.start_s = 1.5;
    EXPECT_EQ(refused("a.mp4"), "reel.yaml:3:8: error: sound.start is 1.5 s, but 'one.wav' ends at 1 s\n"
                                "  expected a start before the end of the file");
    test::write_text(folder_ / "text.wav", "not a sound");
    sound_.file = folder_ / "text.wav";
    EXPECT_THAT(refused("a.mp4"), testing::AllOf(testing::StartsWith("reel.yaml:3:8: error: the sound 'text.wav' cannot be read: "),
                                                 HasSubstr("expected a file that ffmpeg reads sound from, such as .wav, .flac or .mp3")));
    Encoder silent(video("silent.mp4"));
    silent.push(gradient(16, 16));
    silent.finish();
    sound_.file = folder_ / "silent.mp4";
    EXPECT_EQ(refused("a.mp4"), "reel.yaml:3:8: error: the sound 'silent.mp4' has no stream of sound\n"
                                "  expected a file that ffmpeg reads sound from, such as .wav, .flac or .mp3");
}

}  // namespace
}  // namespace kadr
