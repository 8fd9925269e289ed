#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "output/image_io.h"

namespace kadr {

/// The file of one frame: "{frame:04}" and "{frame}" filled in.
std::filesystem::path frame_path(const std::string& pattern, int frame);

/// Writes one image so that `path` is either absent, its old self or complete: under a temporary name in the same folder
/// (".kadr-PID-…"), synced, then renamed. Missing folders are created. Linear `image` goes out as it is to .exr (beauty as
/// half floats), through the view to .png and .jpg; .png has alpha where the image is not opaque, .jpg is over black.
/// @throws RenderError  full disk, unwritable folder; nothing half-written stays
/// @throws InputError   an extension that is none of .exr, .png, .jpg, .jpeg
void write_frame(const std::filesystem::path& path, const Image& image, const ViewSpec& view, int png_bits, const Metadata& metadata);

/// Settings hash (metadata "settings") stored in a complete frame, or an empty string (no file, not ours, truncated).
std::string stored_settings_hash(const std::filesystem::path& path);

/// What an image that Kadr wrote says about itself. @throws InputError  no such file, no image, or not written by Kadr
Metadata describe_image(const std::filesystem::path& path);

/// Removes temporary files of dead runs (".kadr-PID-…" whose process is gone) from a folder.
void remove_leftovers(const std::filesystem::path& folder);

}  // namespace kadr
