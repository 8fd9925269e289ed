#pragma once

#include <filesystem>
#include <span>
#include <string_view>

namespace kadr::stress {

/// Writes a file of a generated shot: without waiting for the disk, as it can be made again at any time.
/// @throws RenderError  naming the file
void write_file(const std::filesystem::path& file, std::span<const unsigned char> bytes);
void write_file(const std::filesystem::path& file, std::string_view text);

}  // namespace kadr::stress
