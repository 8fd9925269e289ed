#include "output/frame_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <regex>

#include "base/error.h"
#include "output/atomic_file.h"
#include "output/view.h"

namespace kadr {
namespace {

namespace fs = std::filesystem;

std::string format_of(const fs::path& path) {
    std::string format = path.extension().string();
    std::transform(format.begin(), format.end(), format.begin(), [](unsigned char c) { return std::tolower(c); });
    if (!format.empty()) format.erase(0, 1);
    static const std::vector<std::string> known{"exr", "png", "jpg", "jpeg"};
    if (std::find(known.begin(), known.end(), format) != known.end()) return format;
    throw InputError(fmt::format("cannot write '{}': the format '{}' is not known", path.string(), format),
                     "expected .exr, .png, .jpg or .jpeg");
}

bool is_transparent(const Image& image) {
    const auto alpha = std::find(image.channels.begin(), image.channels.end(), "A");
    if (alpha == image.channels.end()) return false;
    const std::size_t stride = image.channels.size();
    for (std::size_t i = static_cast<std::size_t>(alpha - image.channels.begin()); i < image.pixels.size(); i += stride)
        if (image.pixels[i] < 1) return true;
    return false;
}

Bytes encode(const std::string& format, const Image& image, const ViewSpec& view, int png_bits, const Metadata& metadata) {
    if (format == "exr") return image_io().encode(format, image, 16, metadata);
    const bool keep_alpha = format == "png" && is_transparent(image);
    return image_io().encode(format, apply_view(image, view, keep_alpha), png_bits, metadata);
}

}  // namespace

fs::path frame_path(const std::string& pattern, int frame) {
    static const std::regex field(R"(\{frame(?::0?([0-9]{1,2}))?\})");
    std::string path;
    auto rest = pattern.cbegin();
    for (std::sregex_iterator match(pattern.begin(), pattern.end(), field), end; match != end; ++match) {
        path.append(rest, (*match)[0].first);
        const int digits = (*match)[1].matched ? std::stoi((*match)[1]) : 1;
        path += frame < 0 ? fmt::format("-{:0{}}", -static_cast<long long>(frame), digits) : fmt::format("{:0{}}", frame, digits);
        rest = (*match)[0].second;
    }
    path.append(rest, pattern.cend());
    return path;
}

void write_frame(const fs::path& path, const Image& image, const ViewSpec& view, int png_bits, const Metadata& metadata) {
    const std::string format = format_of(path);
    create_folder_of(path);
    write_atomically(path, encode(format, image, view, png_bits, metadata));
}

std::string stored_settings_hash(const fs::path& path) {
    std::error_code none;
    if (!fs::is_regular_file(path, none) || !image_io().is_complete(path)) return {};
    try {
        const Metadata metadata = image_io().read_metadata(path);
        const auto settings = metadata.find("settings");
        return settings == metadata.end() ? std::string() : settings->second;
    } catch (const InputError&) {
        return {};   // not an image: not a frame of ours, to be rendered anew
    }
}

Metadata describe_image(const fs::path& path) {
    std::error_code none;
    if (!fs::exists(path, none))
        throw InputError(fmt::format("there is no file '{}'", path.string()), "expected an image that Kadr wrote");
    Metadata metadata = image_io().read_metadata(path);
    if (metadata.empty())
        throw InputError(fmt::format("'{}' says nothing about itself that Kadr knows", path.string()),
                         "expected an image that Kadr wrote (.exr, .png or .jpg)");
    return metadata;
}

void remove_leftovers(const fs::path& folder) { remove_dead_temporaries(folder); }

}  // namespace kadr
