#pragma once

#include <filesystem>
#include <string>

#include "shot/section.h"

namespace kadr {

// What shots and reels have in common as files.

/// The text of a shot or reel file, but at most one byte more than one may have. @throws InputError
std::string read_document_file(const std::filesystem::path& path);

/// The document's map. @param minimal  what to write at least, for an empty file. @throws InputError
YamlNode parse_root(const YamlSource& source, const char* minimal);

/// yaml-cpp and YAML itself let a key stand twice; one of the two would silently win.
void check_duplicates(Problems& problems, const YamlNode& node);

/// `name`, or the file's name without its ending.
std::string read_name(const Section& root, const std::filesystem::path& file);

}  // namespace kadr
