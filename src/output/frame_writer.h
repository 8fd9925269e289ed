#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "output/image_io.h"

namespace kadr {

/// The file of one frame: "{frame:04}" and "{frame}" filled in.
std::filesystem::path frame_path(const std::string& pattern, int frame);

/// Writes one image so that `path` is either absent, its old self or complete: under a temporary name in the same folder
/// (".kadr-PID-…"), synced, then renamed. Linear `image` goes out as it is to .exr, through the view to .png and .jpg.
/// @return the display-referred or linear values exactly as they are in the file, for the encoder
/// @throws RenderError  full disk, unwritable folder; nothing half-written stays
void write_frame(const std::filesystem::path& path, const Image& image, const ViewSpec& view, int png_bits, const Metadata& metadata);

/// Settings hash stored in a complete frame, or an empty string (no file, not ours, truncated).
std::string stored_settings_hash(const std::filesystem::path& path);

/// Removes temporary files of dead runs (".kadr-PID-…" whose process is gone) from a folder.
void remove_leftovers(const std::filesystem::path& folder);

}  // namespace kadr
