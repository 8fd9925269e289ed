#include "scene/image_decoder.h"

#include <fmt/format.h>

#include <cstring>
#include <optional>
#include <string_view>

namespace kadr {

namespace {

constexpr int kLongestSide = 32768;
constexpr std::uint64_t kMostPixels = 1ull << 28;
constexpr std::size_t kPngDepth = 24;                  // IHDR: width, height, bits a channel
constexpr std::uint64_t kMostPixelsAByte = 1u << 13;  // deflate packs 1032:1, and PNG packs 8 pixels into a byte

/// Formats that are recognised only to be named.
struct Signature {
    std::string_view start, name;
    std::size_t offset = 0;
};
constexpr Signature kForeign[] = {
    {"\xABKTX 20", "a KTX2 texture"}, {"\xABKTX 11", "a KTX texture"}, {"WEBP", "a WebP image", 8}, {"ftypavif", "an AVIF image", 4},
    {"DDS ", "a DDS texture"},        {"GIF8", "a GIF image"},         {"BM", "a BMP image"},       {"8BPS", "a Photoshop image"},
    {"#?RADIANCE", "an HDR image"},   {"\x76\x2F\x31\x01", "an EXR image"}, {"<", "a text (an SVG or web page?)"},
};

bool starts_with(ByteView bytes, std::string_view start, std::size_t offset = 0) {
    return bytes.size() >= offset + start.size() && std::memcmp(bytes.data() + offset, start.data(), start.size()) == 0;
}

unsigned big_endian(ByteView bytes, std::size_t at, int count) {
    unsigned value = 0;
    for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
    return value;
}

using Size = std::optional<std::pair<unsigned, unsigned>>;

/// Source: PNG specification, 11.2.2 (IHDR).
Size png_size(ByteView bytes) {
    if (bytes.size() < 33 || !starts_with(bytes, "IHDR", 12)) return std::nullopt;
    return std::pair{big_endian(bytes, 16, 4), big_endian(bytes, 20, 4)};
}

/// Walks the segments to the frame header.  Source: ITU-T T.81, B.2.
Size jpeg_size(ByteView bytes) {
    for (std::size_t at = 2; at + 9 <= bytes.size();) {
        if (bytes[at] != 0xFF) return std::nullopt;
        const unsigned marker = bytes[at + 1];
        if (marker == 0xFF) {  // fill byte
            ++at;
            continue;
        }
        const bool frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
        if (frame) return std::pair{big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2)};
        at += 2 + big_endian(bytes, at + 2, 2);
    }
    return std::nullopt;
}

std::string what_it_is(ByteView bytes) {
    for (const Signature& signature : kForeign)
        if (starts_with(bytes, signature.start, signature.offset)) return std::string(signature.name);
    return "neither a PNG nor a JPEG image";
}

}  // namespace

ImageHeader read_image_header(const GltfDocument& document, const std::string& pointer, ByteView bytes) {
    const bool png = starts_with(bytes, "\x89PNG\r\n\x1A\n"), jpeg = starts_with(bytes, "\xFF\xD8\xFF");
    if (!png && !jpeg) document.fail(pointer, "is " + what_it_is(bytes), "expected PNG or JPEG; convert the image");
    const Size size = png ? png_size(bytes) : jpeg_size(bytes);
    if (!size) document.fail(pointer, fmt::format("is a damaged {} image", png ? "PNG" : "JPEG"), "save the image anew");
    const auto [width, height] = *size;
    const std::uint64_t pixels = static_cast<std::uint64_t>(width) * height;
    if (width == 0 || height == 0 || width > kLongestSide || height > kLongestSide || pixels > kMostPixels)
        document.fail(pointer, fmt::format("has {} x {} pixels", width, height), fmt::format("expected 1 to {} a side and at most 2^28 in all", kLongestSide));
    if (pixels > kMostPixelsAByte * bytes.size())
        document.fail(pointer, fmt::format("says {} x {} pixels but has {} bytes", width, height, bytes.size()), "the image is truncated; save it anew");
    return {static_cast<int>(width), static_cast<int>(height), png && bytes[kPngDepth] == 16 ? 16 : 8};
}

DecodedImage decode_image(const GltfDocument& document, const std::string& pointer, ByteView bytes) {
    const ImageHeader header = read_image_header(document, pointer, bytes);
    tinygltf::Image image;
    std::string errors, notes;
    const bool done = tinygltf::LoadImageData(&image, 0, &errors, &notes, 0, 0, bytes.data(), static_cast<int>(bytes.size()), nullptr);
    const std::size_t expected = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height) * 4u * static_cast<std::size_t>(image.bits == 16 ? 2 : 1);
    if (!done || image.width != header.width || image.height != header.height || image.component != 4 || image.image.size() < expected)
        document.fail(pointer, "cannot be decoded", "the image is damaged; save it anew as PNG or baseline JPEG");
    return {image.width, image.height, image.bits == 16 ? 16 : 8, std::move(image.image)};
}

}  // namespace kadr
