// The reel format, version 1: one row a key, as in schema_table.cpp.
#include "shot/schema.h"

namespace kadr {

namespace {

using enum Quantity;

constexpr double kLongest_s = 86400;

// One row a key reads best on one line.
// clang-format off
constexpr FieldSpec kTable[] = {
    {.path = "reel", .forms = kSection, .doc = "a file that lists shots and becomes one video", .example = "kadr-reel: 1"},
    {.path = "reel.kadr-reel", .forms = kInteger, .doc = "version of the reel format; this Kadr reads version 1", .example = "kadr-reel: 1", .required = true},
    {.path = "reel.name", .forms = kText, .fallback = "the file's name without its ending", .doc = "name of the reel; {name} in its output", .example = "name: showreel"},
    {.path = "reel.fps", .forms = kRational, .low = kAboveZero, .high = 10000, .fallback = "the first shot's", .doc = "frames a second, exact; a shot of another rate is rendered at this one, its times stay", .example = "fps: 25"},
    {.path = "reel.size", .forms = kSize2, .quantity = pixels, .low = 1, .high = 65536, .fallback = "the first shot's", .doc = "width and height; a shot of another size is rendered to fit, with bars where its shape differs", .example = "size: [1920, 1080]"},
    {.path = "reel.bars", .forms = kChoice | kVector3, .low = 0, .high = 1, .choices = "black|white", .fallback = "black", .doc = "colour of the bars beside a shot of another shape, display-referred", .example = "bars: [0.1, 0.1, 0.1]"},
    {.path = "reel.blend", .forms = kChoice, .choices = "display|linear", .fallback = "display", .doc = "what cross-fades and fades mix: display values, as editing programs do, or the light they stand for", .example = "blend: linear"},

    {.path = "reel.shots", .forms = kSections, .doc = "the shots in the order in which they are seen", .example = "shots: [ turntable.yaml, { shot: spin.yaml, out: 1 s, crossfade: 12 f } ]", .required = true},
    {.path = "reel.shots.shot", .forms = kPath, .doc = "a shot file", .example = "shot: turntable.yaml", .required = true},
    {.path = "reel.shots.in", .forms = kNumber, .quantity = time, .low = -1e6, .high = 1e6, .fallback = "the shot's first frame", .doc = "time of the shot at which it is cut in; `f` counts the shot's own frames", .example = "in: 12 f"},
    {.path = "reel.shots.out", .forms = kNumber, .quantity = time, .low = -1e6, .high = 1e6, .fallback = "the end of the shot's last frame", .doc = "time of the shot at which it is cut out: the first moment that is not seen", .example = "out: 1.5 s"},
    {.path = "reel.shots.speed", .forms = kNumber, .low = 0.01, .high = 100, .fallback = "1", .doc = "seconds of the shot a second of the reel; in-between frames are rendered, blur included", .example = "speed: 0.5"},
    {.path = "reel.shots.hold", .forms = kNumber, .quantity = time, .low = 0, .high = kLongest_s, .fallback = "0 s", .doc = "how long the last frame stays", .example = "hold: 0.5 s"},
    {.path = "reel.shots.crossfade", .forms = kNumber, .quantity = time, .low = 0, .high = kLongest_s, .fallback = "0 s", .doc = "how long this shot and the next overlap and mix; both keep moving", .example = "crossfade: 0.5 s"},
    {.path = "reel.shots.fade_in", .forms = kNumber | kSection, .quantity = time, .low = 0, .high = kLongest_s, .fallback = "none", .doc = "fade from a colour: how long, from black, or a map", .example = "fade_in: { from: white, duration: 12 f }"},
    {.path = "reel.shots.fade_in.from", .forms = kChoice | kVector3, .low = 0, .high = 1, .choices = "black|white", .fallback = "black", .doc = "the colour, display-referred", .example = "from: [0.2, 0, 0]"},
    {.path = "reel.shots.fade_in.duration", .forms = kNumber, .quantity = time, .low = 0, .high = kLongest_s, .doc = "how long the fade from the colour takes", .example = "duration: 12 f", .required = true},
    {.path = "reel.shots.fade_out", .forms = kNumber | kSection, .quantity = time, .low = 0, .high = kLongest_s, .fallback = "none", .doc = "fade to a colour: how long, to black, or a map", .example = "fade_out: 1 s"},
    {.path = "reel.shots.fade_out.to", .forms = kChoice | kVector3, .low = 0, .high = 1, .choices = "black|white", .fallback = "black", .doc = "the colour, display-referred", .example = "to: white"},
    {.path = "reel.shots.fade_out.duration", .forms = kNumber, .quantity = time, .low = 0, .high = kLongest_s, .doc = "how long the fade to the colour takes", .example = "duration: 1 s", .required = true},
    {.path = "reel.shots.set", .doc = "key paths of the shot and values over the shot file's", .example = "set: { render.samples: 16, view.exposure: 1 }"},

    {.path = "reel.sound", .forms = kPath | kSection, .fallback = "none", .doc = "a sound file under the whole reel", .example = "sound: { file: music.wav, offset: 2 s, gain: -6 dB, fade_out: 1 s }"},
    {.path = "reel.sound.file", .forms = kPath, .doc = "any file that ffmpeg reads sound from", .example = "file: music.flac", .required = true},
    {.path = "reel.sound.start", .forms = kNumber, .quantity = time, .low = 0, .high = kLongest_s, .fallback = "0 s", .doc = "where in the file the sound begins", .example = "start: 12.5 s"},
    {.path = "reel.sound.offset", .forms = kNumber, .quantity = time, .low = 0, .high = kLongest_s, .fallback = "0 s", .doc = "when in the reel the sound begins", .example = "offset: 1 s"},
    {.path = "reel.sound.gain", .forms = kNumber, .quantity = gain, .low = -120, .high = 60, .fallback = "0 dB", .doc = "louder or softer", .example = "gain: -6 dB"},
    {.path = "reel.sound.fade_in", .forms = kNumber, .quantity = time, .low = 0, .high = kLongest_s, .fallback = "0 s", .doc = "how long the sound takes to rise", .example = "fade_in: 0.1 s"},
    {.path = "reel.sound.fade_out", .forms = kNumber, .quantity = time, .low = 0, .high = kLongest_s, .fallback = "0 s", .doc = "how long the sound takes to fall, up to the reel's end", .example = "fade_out: 2 s"},
    {.path = "reel.sound.loop", .forms = kBoolean, .fallback = "false", .doc = "whether the file begins again where it ends; else silence follows", .example = "loop: true"},

    {.path = "reel.output", .forms = kSection, .doc = "files to write", .example = "output: { video: ../output/reel.mp4 }"},
    {.path = "reel.output.frames", .forms = kPath, .fallback = "none", .doc = "pattern of the reel's own frames, as they are in the video: .png or .jpg", .example = "frames: \"../output/{name}/{name}.{frame:05}.png\""},
    {.path = "reel.output.shots", .forms = kPath, .fallback = "output/{name}/{shot}/{shot}.{frame:04}.png under the working folder", .doc = "pattern of the frames of a shot whose rate, size or settings differ in the reel; others are shared with the shot's own", .example = "shots: \"../output/{name}/{shot}/{shot}.{frame:04}.png\""},
    {.path = "reel.output.png_bits", .forms = kInteger, .low = 8, .high = 16, .fallback = "8", .doc = "bits of a PNG channel of the reel's own frames, 8 or 16", .example = "png_bits: 16"},
    {.path = "reel.output.video", .forms = kPath | kSection, .fallback = "output/{name}.mp4 under the working folder", .doc = "the video", .example = "video: { file: ../output/reel.mp4, codec: h264, crf: 18 }"},
    {.path = "reel.output.video.file", .forms = kPath, .doc = "the file: .mp4, .mkv, .mov, .webm or .gif", .example = "file: ../output/{name}.mp4", .required = true},
    {.path = "reel.output.video.codec", .forms = kChoice, .choices = "h264|h265|av1|vp9|prores|ffv1|gif", .fallback = "by the file: mp4 and mkv h264, mov prores, webm vp9, gif gif", .doc = "codec", .example = "codec: h265"},
    {.path = "reel.output.video.crf", .forms = kInteger, .low = 0, .high = 63, .fallback = "the codec's", .doc = "constant quality of h264, h265, av1 and vp9; lower is better", .example = "crf: 18"},
    {.path = "reel.output.video.pixel_format", .forms = kText, .fallback = "the codec's", .doc = "ffmpeg's name of the pixel format", .example = "pixel_format: yuv420p"},
};
// clang-format on

}  // namespace

std::span<const FieldSpec> reel_table() { return kTable; }

}  // namespace kadr
