#include "output/sound_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "output/child_process.h"
#include "output/encoder.h"
#include "output/ffmpeg_probe.h"

namespace kadr {
namespace {

// What video is mixed at; Opus knows no other rate that is near.
constexpr int kSampleRate = 48000;

[[noreturn]] void fail(const SourceLocation& where, std::string found, std::string expected) {
    Diagnostic diagnostic;
    diagnostic.where = where;
    diagnostic.found = std::move(found);
    diagnostic.expected = std::move(expected);
    throw InputError(std::move(diagnostic));
}

struct EncoderRow {
    const char* extension;
    const char* encoder;
    int kilobits;
};
/// Sound that every player of the container plays.
constexpr EncoderRow kEncoders[] = {
    {".mp4", "aac", 192}, {".mkv", "aac", 192}, {".webm", "libopus", 160}, {".mov", "pcm_s24le", 0}};
constexpr EncoderRow kArchive{".mkv", "flac", 0};  // beside FFV1, which loses nothing either

const EncoderRow& encoder_row(const SoundSpec& sound, const VideoPlan& video) {
    if (video.codec == VideoCodec::ffv1) return kArchive;
    const std::string extension = video.file.extension().string();
    const auto* row = std::find_if(std::begin(kEncoders), std::end(kEncoders),
                                   [&](const EncoderRow& each) { return extension == each.extension; });
    if (row != std::end(kEncoders)) return *row;
    fail(sound.where, fmt::format("the reel has sound, which the video '{}' cannot hold", video.file.filename().string()),
         "write the video as .mp4, .mkv, .mov or .webm, or remove sound");
}

void check_encoder(const SoundSpec& sound, const VideoPlan& video, const std::string& encoder) {
    const FfmpegProbe probe(video.ffmpeg);
    if (probe.has_encoder(encoder)) return;
    fail(sound.where, fmt::format("the installed ffmpeg ({}) has no encoder {} for the sound", probe.program().string(), encoder),
         "install an ffmpeg that has it, or write the video into another container");
}

std::string one_line(std::string text) {
    const std::size_t end = text.find_last_not_of(" \n");
    text.resize(end == std::string::npos ? 0 : end + 1);
    return text.substr(text.rfind('\n') + 1);
}

/// What ffprobe prints of the first stream of sound: its codec, then the file's seconds.
void check_file(const SoundSpec& sound) {
    const auto ffprobe = find_program("ffprobe");
    if (!ffprobe)
        fail(sound.where, "sound needs ffprobe, which is not on the PATH",
             "install ffmpeg with ffprobe (on Debian and Ubuntu: apt install ffmpeg), or remove sound");
    const ProgramResult result =
        run_program({ffprobe->string(), "-v", "error", "-select_streams", "a:0", "-show_entries",
                     "stream=codec_name:format=duration", "-of", "default=noprint_wrappers=1", "file:" + sound.file.string()});
    const std::string name = sound.file.filename().string();
    if (result.status != 0)
        fail(sound.where, fmt::format("the sound '{}' cannot be read: {}", name, one_line(result.error_tail)),
             "expected a file that ffmpeg reads sound from, such as .wav, .flac or .mp3");
    if (result.output.find("codec_name=") == std::string::npos)
        fail(sound.where, fmt::format("the sound '{}' has no stream of sound", name),
             "expected a file that ffmpeg reads sound from, such as .wav, .flac or .mp3");
    const std::size_t at = result.output.find("duration=");
    const double duration = at == std::string::npos ? 0 : std::strtod(result.output.c_str() + at + 9, nullptr);
    if (duration > 0 && sound.start_s >= duration)
        fail(sound.where, fmt::format("sound.start is {} s, but '{}' ends at {} s", format_number(sound.start_s), name,
                                      format_number(duration)),
             "expected a start before the end of the file");
}

long long samples_of(double seconds) { return std::llround(seconds * kSampleRate); }

}  // namespace

SoundPlan plan_sound(const SoundSpec& sound, const VideoPlan& video) {
    const EncoderRow& row = encoder_row(sound, video);
    check_encoder(sound, video, row.encoder);
    check_file(sound);
    return {sound, row.encoder, row.kilobits, {}, {}, {}};
}

std::string sound_filter(const SoundPlan& plan) {
    const SoundSpec& sound = plan.sound;
    const double whole = plan.whole_s.value(), from = plan.from_s.value();
    std::string filter = fmt::format("aresample={},atrim=start_sample={},asetpts=PTS-STARTPTS", kSampleRate, samples_of(sound.start_s));
    if (sound.gain_db != 0) filter += fmt::format(",volume={}dB", format_number(sound.gain_db));
    if (sound.fade_in_s > 0) filter += fmt::format(",afade=t=in:ns={}", samples_of(sound.fade_in_s));
    if (sound.offset_s > 0) filter += fmt::format(",adelay=delays={}S:all=1", samples_of(sound.offset_s));
    filter += fmt::format(",apad,atrim=end_sample={}", samples_of(whole));
    if (sound.fade_out_s > 0)
        filter += fmt::format(",afade=t=out:ss={}:ns={}", std::max(0LL, samples_of(whole - sound.fade_out_s)),
                              samples_of(std::min(sound.fade_out_s, whole)));
    return filter + fmt::format(",atrim=start_sample={}:end_sample={},asetpts=PTS-STARTPTS", samples_of(from),
                                samples_of(from + plan.length_s.value()));
}

}  // namespace kadr
