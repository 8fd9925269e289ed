#pragma once

#include <filesystem>
#include <vector>

#include "base/error.h"
#include "shot/shot_parser.h"
#include "shot/yaml_document.h"

namespace kadr {

/// Where a shot has its size.
inline constexpr const char* kShotSize = "image.size";

/// Lays the command line over the document, before anything is validated: the values replace those of the file, and
/// messages about them name the argument ("--set render.samples=many"). Then a step of the quality ladder that the document
/// names fills in what it does not give.
/// @param working_folder  where relative paths of the command line start
/// @param size_key  where the document has its size: "image.size" in a shot, "size" in a reel
/// @return what could not be laid over: malformed arguments, list entries that are not there
std::vector<Diagnostic> apply_overrides(YamlDocument& document, const ShotOverrides& overrides,
                                        const std::filesystem::path& working_folder,
                                        const char* size_key = kShotSize);

}  // namespace kadr
