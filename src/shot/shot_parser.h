#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shot/shot.h"
#include "shot/yaml_document.h"

namespace kadr {

/// What the command line, or a reel, lays over the file. The command line wins; its paths are relative to the working folder.
struct ShotOverrides {
    std::vector<std::pair<YamlNode, YamlNode>> nodes;      ///< key paths and values of a document (a reel's `set`);
                                                           ///< the command line below wins over them
    std::vector<std::pair<std::string, std::string>> set;  ///< "render.samples" -> "16", values in YAML
    std::string frames;                                    ///< "1-24x2,40"; empty: the file's
    std::string output;                                    ///< frame pattern
    std::string video;                                     ///< file, or "none"
    int samples = 0;                                       ///< 0: the file's; with one of the next two: the most
    std::string max_error;                                 ///< render.samples.max_error; empty: the file's
    std::string time_budget;                               ///< render.samples.time_budget, "20 s"; empty: the file's
    std::string time_budget_shot;                          ///< render.samples.time_budget_shot, "600 s"; empty: the file's
    std::string quality;                                   ///< a step of the ladder: its values replace the file's
    int width = 0, height = 0;                             ///< 0: the file's
};

/// Reads and validates a shot file: every problem at once.
/// @throws InputError  with all problems, each at its file:line:column with an excerpt
Shot parse_shot(const std::filesystem::path& path, const ShotOverrides& overrides = {});

/// The same from text; `path` gives the file's name and folder.
Shot parse_shot_text(std::string_view text, const std::filesystem::path& path, const ShotOverrides& overrides = {});

/// The manual of one key ("render.samples"), of a section, or of the whole format (empty key), from the schema table.
/// @throws InputError  for an unknown key, with "did you mean"
std::string describe_schema(std::string_view key);

/// The format of a shot, or of a reel where `kind` is "reel", as a JSON Schema (draft 2020-12) for editors, from the
/// same table.
std::string schema_as_json(std::string_view kind = {});

}  // namespace kadr
