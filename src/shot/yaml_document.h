#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace kadr {

/// Where YAML text came from: a file, or an argument of the command line.
struct YamlSource {
    std::string name;              ///< file path, or the argument as typed ("--set render.samples=4")
    std::filesystem::path folder;  ///< relative paths in the text start here
    bool argument = false;         ///< no lines and columns in messages: the name shows the whole text
    std::string text;
    std::vector<std::size_t> line_starts;  ///< byte offsets into text

    YamlSource(std::string_view content, std::string source_name, std::filesystem::path source_folder,
               bool is_argument);
    /// Line without its end; empty beyond the last. @param index from 0
    std::string_view line(int index) const;
};

/// A place in a source. Line and column count bytes from 0, as yaml-cpp does.
struct YamlPlace {
    const YamlSource* source = nullptr;
    int line = -1, column = 0;
    int length = 0;  ///< bytes to underline; 0: up to the end of the value that starts here
};

struct YamlEntry;

/// One value of the document. yaml-cpp's own nodes drop duplicate keys and share aliases, so the tree is built from
/// its events instead.
struct YamlNode {
    enum class Kind { null, scalar, list, map };
    Kind kind = Kind::null;
    bool quoted = false;             ///< a scalar in quotes is text, whatever it looks like
    std::string text;                ///< of a scalar
    std::vector<YamlNode> items;     ///< of a list
    std::vector<YamlEntry> entries;  ///< of a map, in the file's order, duplicates included
    YamlPlace place;

    bool is_scalar() const { return kind == Kind::scalar; }
    bool is_list() const { return kind == Kind::list; }
    bool is_map() const { return kind == Kind::map; }
    /// First entry of a map with that key, or null.
    const YamlNode* find(std::string_view key) const;
};

struct YamlEntry {
    YamlNode key, value;  ///< keys are scalars
};

/// Limits against hostile files; far above what a shot needs.
inline constexpr std::size_t kMostYamlBytes = 2u << 20;
inline constexpr std::size_t kMostYamlNodes = 1'000'000;
inline constexpr std::size_t kMostAliasNodes = 100'000;  ///< values copied by aliases
inline constexpr int kDeepestYaml = 64;

/// A parsed document and the texts its places point into.
struct YamlDocument {
    std::vector<std::unique_ptr<YamlSource>> sources;  ///< the file, then arguments
    YamlNode root;
    const YamlSource& add_source(std::string_view text, std::string name, std::filesystem::path folder, bool argument);
};

/// Parses one document of YAML. An empty text gives a null node.
/// @throws InputError  for text that is not UTF-8, not YAML, too large, too deep, or of several documents
YamlNode parse_yaml(const YamlSource& source);

SourceLocation location_of(const YamlPlace& place);
Diagnostic diagnostic_at(const YamlPlace& place, std::string found, std::string expected);

}  // namespace kadr
