// The image module: everything that needs OpenImageIO, in a shared library of its own (see image_module.h).
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/error.h"
#include "base/version.h"
#include "output/image_module.h"

namespace kadr {
namespace {

namespace fs = std::filesystem;

constexpr float kLargestHalf = 65504.0f;
constexpr std::string_view kKeyPrefix = "kadr:";
// The attribute that both PNG (a text chunk) and JPEG (a comment) carry; holds all metadata as one JSON object.
constexpr const char* kDescription = "ImageDescription";
constexpr const char* kJsonRoot = "kadr";

bool is_beauty(const std::string& channel) { return channel.find('.') == std::string::npos; }

int alpha_channel(const std::vector<std::string>& channels) {
    const auto alpha = std::find(channels.begin(), channels.end(), "A");
    return alpha == channels.end() ? -1 : static_cast<int>(alpha - channels.begin());
}

OIIO::ImageSpec spec_of(const Image& image, OIIO::TypeDesc type) {
    OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(image.channels.size()), type);
    spec.channelnames = image.channels;
    spec.alpha_channel = alpha_channel(image.channels);
    spec.attribute("Software", std::string("Kadr ") + kVersion);
    return spec;
}

OIIO::ImageSpec exr_spec(const Image& image, const Metadata& metadata) {
    OIIO::ImageSpec spec = spec_of(image, OIIO::TypeDesc::FLOAT);
    for (const std::string& channel : image.channels)
        spec.channelformats.push_back(is_beauty(channel) ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", "Linear");
    for (const auto& [key, value] : metadata) spec.attribute(std::string(kKeyPrefix) + key, value);
    return spec;
}

std::string as_json(const Metadata& metadata) {
    // Bytes that are not UTF-8 (a file name, say) are replaced: the frame matters more than its description.
    return nlohmann::json{{kJsonRoot, metadata}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

OIIO::ImageSpec display_spec(const Image& image, OIIO::TypeDesc type, const Metadata& metadata) {
    OIIO::ImageSpec spec = spec_of(image, type);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("oiio:UnassociatedAlpha", 1);
    spec.attribute("png:compressionLevel", 1);
    spec.attribute("Compression", "jpeg:95");
    spec.attribute(kDescription, as_json(metadata));
    return spec;
}

float clamped_to_half(float value) { return std::clamp(value, -kLargestHalf, kLargestHalf); }

/// Beauty within a half float's range; layers as they are.
std::vector<float> exr_pixels(const Image& image) {
    std::vector<float> pixels = image.pixels;
    const std::size_t stride = image.channels.size();
    for (std::size_t c = 0; c < stride; ++c) {
        if (!is_beauty(image.channels[c])) continue;
        for (std::size_t i = c; i < pixels.size(); i += stride) pixels[i] = clamped_to_half(pixels[i]);
    }
    return pixels;
}

/// Whole numbers with colour divided by alpha, as PNG wants it. NaN becomes 0.
template <class Integer>
std::vector<Integer> quantised(const Image& image) {
    constexpr float kFull = std::numeric_limits<Integer>::max();
    const std::size_t stride = image.channels.size();
    const int alpha = alpha_channel(image.channels);
    std::vector<Integer> result(image.pixels.size());
    for (std::size_t pixel = 0; pixel < result.size(); pixel += stride) {
        const float coverage = alpha < 0 ? 1.0f : image.pixels[pixel + static_cast<std::size_t>(alpha)];
        for (std::size_t c = 0; c < stride; ++c) {
            float value = image.pixels[pixel + c];
            if (static_cast<int>(c) != alpha && coverage > 0 && coverage < 1) value /= coverage;
            const float inside = value > 0 ? std::min(value, 1.0f) : 0.0f;
            result[pixel + c] = static_cast<Integer>(inside * kFull + 0.5f);
        }
    }
    return result;
}

Bytes encoded(const std::string& format, const OIIO::ImageSpec& spec, OIIO::TypeDesc type, const void* pixels) {
    Bytes bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("memory." + format, &memory);
    if (!output) throw RenderError(fmt::format("the image library cannot write .{}: {}", format, OIIO::geterror()));
    output->threads(1);   // the other processors are rendering
    if (!output->open("memory." + format, spec) || !output->write_image(type, pixels) || !output->close())
        throw RenderError(fmt::format("cannot encode a .{} image: {}", format, output->geterror()));
    return bytes;
}

/// How every complete file of a format begins and ends: PNG with its IEND chunk, JPEG with its end marker. Looked at before
/// the libraries are, because libpng prints what it thinks of a truncated file.
struct Ending {
    std::string_view begin, end;
};
constexpr std::string_view kPngEnd("\0\0\0\0IEND\xae\x42\x60\x82", 12);
constexpr Ending kEndings[] = {{"\x89PNG", kPngEnd}, {"\xff\xd8\xff", "\xff\xd9"}};

std::string bytes_of(std::ifstream& file, std::streamoff offset, std::ios::seekdir from, std::size_t count) {
    std::string bytes(count, '\0');
    file.clear();
    file.seekg(offset, from);
    if (!file.read(bytes.data(), static_cast<std::streamsize>(count))) return {};
    return bytes;
}

enum class End { missing, there, unknown };

End end_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    for (const Ending& ending : kEndings) {
        if (bytes_of(file, 0, std::ios::beg, ending.begin.size()) != ending.begin) continue;
        const auto size = ending.end.size();
        return bytes_of(file, -static_cast<std::streamoff>(size), std::ios::end, size) == ending.end ? End::there : End::missing;
    }
    return End::unknown;
}

using Input = std::unique_ptr<OIIO::ImageInput>;

/// @throws InputError
Input open_image(const fs::path& path) {
    if (end_of(path) == End::missing) throw InputError(fmt::format("the image '{}' is incomplete", path.string()));
    OIIO::ImageSpec wanted;
    wanted.attribute("oiio:UnassociatedAlpha", 1);
    Input input = OIIO::ImageInput::open(path.string(), &wanted);
    if (!input) throw InputError(fmt::format("cannot read the image '{}': {}", path.string(), OIIO::geterror()));
    input->threads(1);
    return input;
}

bool has_unassociated_alpha(const OIIO::ImageSpec& spec) {
    return spec.alpha_channel >= 0 && spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
}

void premultiply(Image& image, std::size_t alpha) {
    const std::size_t stride = image.channels.size();
    for (std::size_t pixel = 0; pixel < image.pixels.size(); pixel += stride)
        for (std::size_t c = 0; c < stride; ++c)
            if (c != alpha) image.pixels[pixel + c] *= image.pixels[pixel + alpha];
}

void add_from_json(Metadata& metadata, const std::string& text) {
    const nlohmann::json root = nlohmann::json::parse(text, nullptr, false);
    if (!root.is_object() || !root.contains(kJsonRoot) || !root[kJsonRoot].is_object()) return;
    for (const auto& [key, value] : root[kJsonRoot].items())
        if (value.is_string()) metadata[key] = value.get<std::string>();
}

/// Rows are written from the top, so what is missing at a file's end is the last row.
bool has_last_row(OIIO::ImageInput& input) {
    const OIIO::ImageSpec& spec = input.spec();
    if (spec.tile_width != 0) return true;   // not ours
    std::vector<float> row(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels));
    return input.read_scanline(spec.y + spec.height - 1, 0, OIIO::TypeDesc::FLOAT, row.data());
}

/// The pixels where they are, not copied.
OIIO::ImageBuf wrapped(const Image& image) {
    const OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(image.channels.size()), OIIO::TypeDesc::FLOAT);
    return OIIO::ImageBuf(spec, const_cast<float*>(image.pixels.data()));
}

class OiioImageIo : public ImageIo {
public:
    OiioImageIo() {
        OIIO::attribute("threads", 1);
        OIIO::attribute("exr_threads", -1);   // none of its own: it would compete with the renderer
    }

    Bytes encode(const std::string& format, const Image& image, int bits, const Metadata& metadata) const override {
        if (format == "exr")
            return encoded(format, exr_spec(image, metadata), OIIO::TypeDesc::FLOAT, exr_pixels(image).data());
        if (format == "png" && bits == 16)
            return encoded(format, display_spec(image, OIIO::TypeDesc::UINT16, metadata), OIIO::TypeDesc::UINT16,
                           quantised<std::uint16_t>(image).data());
        return encoded(format, display_spec(image, OIIO::TypeDesc::UINT8, metadata), OIIO::TypeDesc::UINT8,
                       quantised<std::uint8_t>(image).data());
    }

    Image read(const fs::path& path) const override {
        const Input input = open_image(path);
        const OIIO::ImageSpec& spec = input->spec();
        Image image{spec.width, spec.height, spec.channelnames, {}};
        image.pixels.resize(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
        if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data()))
            throw InputError(fmt::format("the image '{}' is incomplete: {}", path.string(), input->geterror()));
        if (has_unassociated_alpha(spec)) premultiply(image, static_cast<std::size_t>(spec.alpha_channel));
        return image;
    }

    ImageExtent extent(const fs::path& path) const override {
        const OIIO::ImageSpec spec = open_image(path)->spec();
        return {spec.width, spec.height, spec.nchannels};
    }

    Metadata read_metadata(const fs::path& path) const override {
        const Input input = open_image(path);
        Metadata metadata;
        add_from_json(metadata, input->spec().get_string_attribute(kDescription));
        for (const OIIO::ParamValue& attribute : input->spec().extra_attribs) {
            const std::string name = attribute.name().string();
            if (name.starts_with(kKeyPrefix)) metadata[name.substr(kKeyPrefix.size())] = attribute.get_string();
        }
        return metadata;
    }

    bool is_complete(const fs::path& path) const override {
        const End end = end_of(path);
        if (end != End::unknown) return end == End::there;
        const Input input = OIIO::ImageInput::open(path.string());
        const bool complete = input && has_last_row(*input);
        // Taken, so that the library does not print them.
        static_cast<void>(input ? input->geterror() : OIIO::geterror());
        return complete;
    }

    ValueDifference compare(const Image& a, const Image& b) const override {
        // Pixels beyond the thresholds are counted (nobody reads that) and set found.error: images that differ are no error here.
        constexpr float kAny = std::numeric_limits<float>::max();
        const OIIO::ImageBuf first = wrapped(a), second = wrapped(b);
        const OIIO::ImageBufAlgo::CompareResults found = OIIO::ImageBufAlgo::compare(first, second, kAny, kAny);
        if (found.error) throw RenderError(fmt::format("cannot compare two images: {}", OIIO::geterror()));
        return {found.meanerror, found.rms_error, found.PSNR, found.maxerror, found.maxx, found.maxy, found.maxc};
    }

    Image heat_map(const Image& values) const override {
        const OIIO::ImageBuf colors = OIIO::ImageBufAlgo::color_map(wrapped(values), 0, "magma");
        Image image{values.width, values.height, {"R", "G", "B"}, {}};
        image.pixels.resize(image.channels.size() * static_cast<std::size_t>(values.width) * static_cast<std::size_t>(values.height));
        if (colors.has_error() || !colors.get_pixels(OIIO::ROI::All(), OIIO::TypeDesc::FLOAT, image.pixels.data()))
            throw RenderError(fmt::format("cannot colour an error map: {}", colors.geterror()));
        return image;
    }
};

}  // namespace
}  // namespace kadr

extern "C" const char* kadr_image_module_version() { return kadr::kVersion; }
extern "C" kadr::ImageIo* kadr_make_image_io() { return new kadr::OiioImageIo; }
