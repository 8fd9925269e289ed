#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <optional>
#include <string_view>

#include "base/error.h"
#include "output/child_process.h"
#include "output/encoder.h"
#include "output/ffmpeg_probe.h"

namespace kadr {
namespace {

constexpr int kNoCrf = -1;

/// An encoder of ffmpeg that makes a codec; the first one that is installed and takes the size is used.
struct EncoderChoice {
    const char* name;
    int smallest = 1;   ///< pixels, both ways
};

/// One row a codec.
struct CodecRow {
    VideoCodec codec;
    const char* name;
    std::vector<EncoderChoice> encoders;
    std::vector<std::string> containers;   ///< extensions
    const char* pixel_format;              ///< default
    int default_crf, largest_crf;          ///< kNoCrf: the codec has none
};

const std::vector<CodecRow>& codecs() {
    static const std::vector<CodecRow> rows{
        {VideoCodec::h264, "h264", {{"libx264"}}, {"mp4", "mkv", "mov"}, "yuv420p", 18, 51},
        {VideoCodec::h265, "h265", {{"libx265", 16}}, {"mp4", "mkv", "mov"}, "yuv420p", 20, 51},
        // SVT-AV1 refuses pictures smaller than 64 pixels.
        {VideoCodec::av1, "av1", {{"libsvtav1", 64}, {"libaom-av1"}}, {"mp4", "mkv", "webm"}, "yuv420p", 30, 63},
        {VideoCodec::vp9, "vp9", {{"libvpx-vp9"}}, {"webm", "mkv", "mp4"}, "yuv420p", 30, 63},
        {VideoCodec::prores, "prores", {{"prores_ks"}}, {"mov", "mkv"}, "yuv422p10le", kNoCrf, kNoCrf},
        // RGB as it is: comes back bit for bit.
        {VideoCodec::ffv1, "ffv1", {{"ffv1"}}, {"mkv"}, "bgr0", kNoCrf, kNoCrf},
        {VideoCodec::gif, "gif", {{"gif"}}, {"gif"}, "pal8", kNoCrf, kNoCrf},
    };
    return rows;
}

struct ExtensionRow {
    const char* extension;
    VideoCodec codec;
};
constexpr ExtensionRow kExtensions[] = {{"mp4", VideoCodec::h264},
                                        {"mkv", VideoCodec::h264},
                                        {"mov", VideoCodec::prores},
                                        {"webm", VideoCodec::vp9},
                                        {"gif", VideoCodec::gif}};

/// How many pixels share one colour sample, by a part of the pixel format's name.
struct Subsampling {
    const char* part;
    const char* name;
    int x, y;
};
constexpr Subsampling kSubsamplings[] = {{"420", "4:2:0", 2, 2}, {"nv12", "4:2:0", 2, 2}, {"p010", "4:2:0", 2, 2},
                                         {"422", "4:2:2", 2, 1}, {"nv16", "4:2:2", 2, 1}, {"nv20", "4:2:2", 2, 1},
                                         {"440", "4:4:0", 1, 2}, {"411", "4:1:1", 4, 1},  {"410", "4:1:0", 4, 4}};

class Planner {
public:
    Planner(const VideoSpec& spec, int width, int height, Rational fps, const VideoKeys& keys)
        : spec_(spec), width_(width), height_(height), fps_(fps), keys_(keys) {}

    VideoPlan plan() const {
        const CodecRow& codec = choose_codec();
        check_container(codec);
        check_crf(codec);
        check_rate(codec);
        const std::string pixel_format = spec_.pixel_format.value_or(codec.pixel_format);
        check_size(pixel_format);
        FfmpegProbe probe(find_ffmpeg());
        const std::string encoder = choose_encoder(codec, probe);
        check_pixel_format(encoder, pixel_format, probe);
        VideoPlan plan{spec_.file, codec.codec, encoder, pixel_format, spec_.crf, width_, height_, fps_, probe.program(), {}};
        if (!plan.crf && codec.default_crf != kNoCrf) plan.crf = codec.default_crf;
        return plan;
    }

private:
    [[noreturn]] void fail(std::string found, std::string expected) const {
        Diagnostic diagnostic;
        diagnostic.where = spec_.where;
        diagnostic.found = std::move(found);
        diagnostic.expected = std::move(expected);
        throw InputError(std::move(diagnostic));
    }

    std::string extension() const {
        std::string text = spec_.file.extension().string();
        std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
        if (!text.empty()) text.erase(0, 1);
        return text;
    }

    const CodecRow& choose_codec() const {
        const auto row_of = [](VideoCodec codec) -> const CodecRow& {
            return *std::find_if(codecs().begin(), codecs().end(), [&](const CodecRow& row) { return row.codec == codec; });
        };
        if (spec_.codec) return row_of(*spec_.codec);
        for (const ExtensionRow& row : kExtensions)
            if (extension() == row.extension) return row_of(row.codec);
        fail(fmt::format("output.video '{}' has an extension that names no container Kadr writes", spec_.file.filename().string()),
             "expected .mp4, .mkv, .mov, .webm or .gif");
    }

    void check_container(const CodecRow& codec) const {
        const auto& fitting = codec.containers;
        if (std::find(fitting.begin(), fitting.end(), extension()) != fitting.end()) return;
        fail(fmt::format("output.video '{}' cannot hold {}", spec_.file.filename().string(), codec.name),
             fmt::format("expected .{} for {}; change the extension or output.video.codec", fmt::join(fitting, " or ."), codec.name));
    }

    void check_crf(const CodecRow& codec) const {
        if (!spec_.crf) return;
        if (codec.largest_crf == kNoCrf)
            fail(fmt::format("output.video.crf is {}, but {} has no such setting", *spec_.crf, codec.name), "remove output.video.crf");
        if (*spec_.crf < 0 || *spec_.crf > codec.largest_crf)
            fail(fmt::format("output.video.crf is {}", *spec_.crf),
                 fmt::format("expected 0 (best) to {} for {}; leave it out for {}", codec.largest_crf, codec.name, codec.default_crf));
    }

    void check_rate(const CodecRow& codec) const {
        // A GIF counts hundredths of a second, and players slow down what is faster than two of them.
        constexpr int kFastestGif = 50;
        if (codec.codec == VideoCodec::gif && fps_.value() > kFastestGif)
            fail(fmt::format("{} is {}, but a GIF plays at most {} frames a second", keys_.fps, fps_.value(), kFastestGif),
                 fmt::format("use another container, such as .mp4, or a lower {}", keys_.fps));
    }

    void check_size(const std::string& pixel_format) const {
        const auto* row = std::find_if(std::begin(kSubsamplings), std::end(kSubsamplings), [&](const Subsampling& each) {
            return pixel_format.find(each.part) != std::string::npos;
        });
        if (row == std::end(kSubsamplings) || (width_ % row->x == 0 && height_ % row->y == 0)) return;
        const char* sides = row->x > 1 && row->y > 1 ? "width and height" : row->x > 1 ? "width" : "height";
        const int step = std::max(row->x, row->y);
        const auto up = [](int value, int multiple) { return (value + multiple - 1) / multiple * multiple; };
        fail(fmt::format("{} is {} x {}, but {} video ({}) needs {} {}", keys_.size, width_, height_, row->name, pixel_format,
                         step == 2 ? "an even" : "a multiple of 4 as", sides),
             fmt::format("use {}: [{}, {}], or output.video.pixel_format: yuv444p", keys_.size, up(width_, row->x), up(height_, row->y)));
    }

    std::filesystem::path find_ffmpeg() const {
        if (const auto program = find_program("ffmpeg")) return *program;
        fail("output.video needs ffmpeg, which is not on the PATH",
             "install ffmpeg (on Debian and Ubuntu: apt install ffmpeg), or remove output.video");
    }

    std::string choose_encoder(const CodecRow& codec, const FfmpegProbe& probe) const {
        std::vector<std::string> missing;
        int smallest = 0;
        for (const EncoderChoice& choice : codec.encoders) {
            const bool fits = width_ >= choice.smallest && height_ >= choice.smallest;
            if (!probe.has_encoder(choice.name)) missing.emplace_back(choice.name);
            else if (fits) return choice.name;
            else smallest = choice.smallest;
        }
        if (smallest > 0)
            fail(fmt::format("{} is {} x {}, too small for {}", keys_.size, width_, height_, codec.name),
                 fmt::format("expected at least {} x {}; use a larger size or another output.video.codec", smallest, smallest));
        fail(fmt::format("the installed ffmpeg ({}) has no encoder {}", probe.program().string(), fmt::join(missing, " or ")),
             fmt::format("install an ffmpeg that has it, or use another output.video.codec than {}", codec.name));
    }

    void check_pixel_format(const std::string& encoder, const std::string& pixel_format, FfmpegProbe& probe) const {
        const std::vector<std::string> known = probe.pixel_formats(encoder);
        if (known.empty() || std::find(known.begin(), known.end(), pixel_format) != known.end()) return;
        fail(fmt::format("output.video.pixel_format is {}, which {} cannot encode", pixel_format, encoder),
             fmt::format("expected one of {}", fmt::join(known, ", ")));
    }

    const VideoSpec& spec_;
    const int width_, height_;
    const Rational fps_;
    const VideoKeys keys_;
};

}  // namespace

VideoPlan plan_video(const VideoSpec& spec, int width, int height, Rational fps, const VideoKeys& keys) {
    return Planner(spec, width, height, fps, keys).plan();
}

}  // namespace kadr
