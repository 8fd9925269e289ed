#include "output/encoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string_view>

#include "base/error.h"
#include "output/atomic_file.h"
#include "output/child_process.h"

namespace kadr {
namespace {

namespace fs = std::filesystem;

// --- The command line ------------------------------------------------------------------------------------------------

/// Arguments of one encoder beside its name, quality and pixel format.
struct EncoderRow {
    std::string_view encoder;
    Arguments arguments;
};

const Arguments& encoder_arguments(const std::string& encoder) {
    static const std::vector<EncoderRow> rows{
        {"libx264", {"-preset", "medium"}},
        // hvc1: the tag that players of other systems ask for.
        {"libx265", {"-preset", "medium", "-x265-params", "log-level=error", "-tag:v", "hvc1"}},
        {"libsvtav1", {"-preset", "8"}},
        {"libaom-av1", {"-cpu-used", "6", "-b:v", "0", "-row-mt", "1"}},
        {"libvpx-vp9", {"-b:v", "0", "-deadline", "good", "-cpu-used", "4", "-row-mt", "1"}},
        {"prores_ks", {"-profile:v", "hq", "-vendor", "apl0"}},
        // Slices with checksums, all of them intra frames: the archival settings.
        {"ffv1", {"-level", "3", "-g", "1", "-slices", "4", "-slicecrc", "1"}},
        {"gif", {}},
    };
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const EncoderRow& each) { return each.encoder == encoder; });
    static const Arguments none;
    return row == rows.end() ? none : row->arguments;
}

struct MuxerRow {
    std::string_view extension;
    Arguments arguments;
};

Arguments muxer_arguments(const fs::path& file) {
    static const std::vector<MuxerRow> rows{{".mp4", {"-movflags", "+faststart+write_colr", "-f", "mp4"}},
                                            {".mov", {"-movflags", "+faststart+write_colr", "-f", "mov"}},
                                            {".mkv", {"-f", "matroska"}},
                                            {".webm", {"-f", "webm"}},
                                            {".gif", {"-f", "gif"}}};
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return std::tolower(c); });
    for (const MuxerRow& row : rows)
        if (row.extension == extension) return row.arguments;
    return {};
}

bool is_rgb(const std::string& pixel_format) {
    constexpr std::string_view kStarts[] = {"gbr", "rgb", "bgr", "0rgb", "0bgr", "pal8"};
    return std::any_of(std::begin(kStarts), std::end(kStarts), [&](std::string_view start) { return pixel_format.starts_with(start); });
}

/// Whether a pixel format has more than 8 bits a channel: "yuv420p10le", "gbrp12le", "gray9le", "rgb48le", "p010le".
bool is_deep(const std::string& pixel_format) { return pixel_format.ends_with("le") || pixel_format.ends_with("be"); }

std::string video_filter(const VideoPlan& plan) {
    // One palette a frame: none has to be kept back until the last frame is known.
    if (plan.codec == VideoCodec::gif) return "split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1:dither=sierra2_4a";
    if (is_rgb(plan.pixel_format)) return "format=" + plan.pixel_format;
    const bool full_range = plan.pixel_format.starts_with("yuvj");
    // ProRes takes its tags from the frames (setparams), the others take theirs from the command line.
    return fmt::format("scale=in_range=pc:out_color_matrix=bt709:out_range={0}:flags=bicubic+accurate_rnd+full_chroma_int,format={1},"
                       "setparams=range={0}:color_primaries=bt709:color_trc=bt709:colorspace=bt709",
                       full_range ? "pc" : "tv", plan.pixel_format);
}

/// Unset tags make players guess; BT.709 is what the pixels were converted with.
Arguments color_tags(const VideoPlan& plan) {
    if (plan.codec == VideoCodec::gif) return {};
    if (is_rgb(plan.pixel_format))
        return {"-color_primaries", "bt709", "-color_trc", "iec61966-2-1", "-colorspace", "rgb", "-color_range", "pc"};
    const bool full_range = plan.pixel_format.starts_with("yuvj");
    return {"-color_primaries", "bt709", "-color_trc", "bt709", "-colorspace", "bt709", "-color_range", full_range ? "pc" : "tv"};
}

Arguments sound_input(const VideoPlan& plan) {
    if (!plan.sound) return {};
    Arguments words;
    if (plan.sound->sound.loop) words = {"-stream_loop", "-1"};
    words.insert(words.end(), {"-i", "file:" + plan.sound->sound.file.string(), "-map", "0:v:0", "-map", "1:a:0"});
    return words;
}

Arguments sound_output(const VideoPlan& plan) {
    if (!plan.sound) return {};
    Arguments words{"-af", sound_filter(*plan.sound), "-c:a", plan.sound->encoder, "-flags:a", "+bitexact"};
    if (plan.sound->kilobits > 0) words.insert(words.end(), {"-b:a", fmt::format("{}k", plan.sound->kilobits)});
    return words;
}

Arguments command_line(const VideoPlan& plan, const fs::path& file) {
    const std::string rate = fmt::format("{}/{}", plan.fps.numerator, plan.fps.denominator);
    Arguments words{plan.ffmpeg.string(), "-hide_banner", "-nostdin", "-nostats", "-v", "error", "-y",
                    "-f", "rawvideo", "-pixel_format", is_deep(plan.pixel_format) ? "rgb48le" : "rgb24",
                    "-video_size", fmt::format("{}x{}", plan.width, plan.height), "-framerate", rate, "-i", "pipe:0"};
    const auto append = [&](const Arguments& more) { words.insert(words.end(), more.begin(), more.end()); };
    append(sound_input(plan));
    append({"-vf", video_filter(plan), "-c:v", plan.encoder});
    append(encoder_arguments(plan.encoder));
    if (plan.crf) append({"-crf", std::to_string(*plan.crf)});
    if (plan.codec != VideoCodec::gif) append({"-pix_fmt", plan.pixel_format});
    append(color_tags(plan));
    // No dates and no library versions: the same frames give the same file.
    append({"-r", rate, "-map_metadata", "-1", "-fflags", "+bitexact", "-flags:v", "+bitexact"});
    append(sound_output(plan));
    append(muxer_arguments(plan.file));
    // A protocol in front, or a name with a colon would be taken for one.
    words.push_back("file:" + file.string());
    return words;
}

// --- Frames ----------------------------------------------------------------------------------------------------------

struct ColorChannels {
    std::size_t r, g, b;
};

/// A missing colour repeats the first channel (grey images).
ColorChannels color_channels(const Image& image) {
    const auto index = [&](const char* name) {
        const auto found = std::find(image.channels.begin(), image.channels.end(), name);
        return found == image.channels.end() ? std::size_t{0} : static_cast<std::size_t>(found - image.channels.begin());
    };
    return {index("R"), index("G"), index("B")};
}

template <class Integer>
Integer quantised(float value) {
    constexpr float kFull = std::numeric_limits<Integer>::max();
    const float inside = value > 0 ? std::min(value, 1.0f) : 0.0f;   // NaN becomes 0
    return static_cast<Integer>(inside * kFull + 0.5f);
}

/// Interleaved R, G, B, little-endian.
template <class Integer>
void fill_raw_frame(const Image& image, std::vector<unsigned char>& bytes) {
    const ColorChannels channels = color_channels(image);
    const std::size_t stride = image.channels.size();
    bytes.clear();
    bytes.reserve(image.pixels.size() / stride * 3 * sizeof(Integer));
    for (std::size_t pixel = 0; pixel < image.pixels.size(); pixel += stride)
        for (const std::size_t channel : {channels.r, channels.g, channels.b}) {
            const Integer value = quantised<Integer>(image.pixels[pixel + channel]);
            for (std::size_t byte = 0; byte < sizeof(Integer); ++byte)
                bytes.push_back(static_cast<unsigned char>(value >> (8 * byte)));
        }
}

// --- Messages and checks ---------------------------------------------------------------------------------------------

std::string own_words(const std::string& error_tail) {
    if (error_tail.empty()) return "\n  ffmpeg said nothing";
    std::string indented = "\n  ffmpeg's last lines:";
    for (std::size_t begin = 0; begin < error_tail.size();) {
        const std::size_t end = std::min(error_tail.find('\n', begin), error_tail.size());
        indented += "\n    " + error_tail.substr(begin, end - begin);
        begin = end + 1;
    }
    return indented;
}

/// Packets of the file's video stream; ffmpeg ends with 0 even when the last frame was cut short, so it is counted.
/// @return -1 when ffmpeg cannot read the file
long long count_frames(const fs::path& ffmpeg, const fs::path& file) {
    const ProgramResult result = run_program({ffmpeg.string(), "-hide_banner", "-nostdin", "-nostats", "-v", "error", "-progress",
                                              "pipe:1", "-i", "file:" + file.string(), "-map", "0:v:0", "-c", "copy", "-f", "null", "-"});
    const std::size_t at = result.output.rfind("frame=");
    if (result.status != 0 || at == std::string::npos) return -1;
    return std::strtoll(result.output.c_str() + at + 6, nullptr, 10);
}

}  // namespace

struct Encoder::Process {
    explicit Process(const VideoPlan& video)
        : plan(video), temporary(temporary_name(video.file)),
          child(std::make_unique<ChildProcess>(command_line(video, temporary))) {}
    ~Process() {
        child.reset();   // first, or it would go on writing
        std::error_code ignored;
        fs::remove(temporary, ignored);   // renamed by then when all went well
    }

    /// Ends ffmpeg and says what it said.
    [[noreturn]] void fail(const std::string& what) {
        const int status = child->wait();
        throw RenderError(fmt::format("cannot write the video '{}': {} (exit status {}); the images are kept{}", plan.file.string(), what,
                                      status, own_words(child->error_tail())));
    }

    VideoPlan plan;
    fs::path temporary;
    long long frames = 0;
    std::vector<unsigned char> bytes;   ///< of one frame, kept between frames
    std::unique_ptr<ChildProcess> child;
};

Encoder::Encoder(const VideoPlan& plan) {
    create_folder_of(plan.file);
    process_ = std::make_unique<Process>(plan);
}

Encoder::~Encoder() = default;

void Encoder::push(const Image& display) {
    Process& process = *process_;
    const VideoPlan& plan = process.plan;
    if (display.width != plan.width || display.height != plan.height)
        throw RenderError(fmt::format("a frame of {} x {} does not fit into the video '{}' of {} x {}; render it again with --overwrite",
                                      display.width, display.height, plan.file.string(), plan.width, plan.height));
    if (is_deep(plan.pixel_format))
        fill_raw_frame<std::uint16_t>(display, process.bytes);
    else
        fill_raw_frame<std::uint8_t>(display, process.bytes);
    if (!process.child->write(process.bytes)) process.fail(fmt::format("ffmpeg stopped after {} frames", process.frames));
    ++process.frames;
}

void Encoder::finish() {
    Process& process = *process_;
    if (process.child->wait() != 0) process.fail("ffmpeg failed");
    const long long found = count_frames(process.plan.ffmpeg, process.temporary);
    if (found < 0) process.fail("ffmpeg cannot read what it wrote");
    if (found != process.frames) process.fail(fmt::format("it has {} frames instead of {}", found, process.frames));
    sync_file(process.temporary);
    rename_synced(process.temporary, process.plan.file);
    process_.reset();
}

}  // namespace kadr
