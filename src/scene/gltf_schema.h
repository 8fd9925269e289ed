#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "base/error.h"

namespace kadr {

/// Checks the document against the table of glTF's properties: types, required members, ranges, enumerations, and that
/// every index names an existing object. After it has passed, code may follow indices without checking them again.
/// Whole numbers written as 5.0 are turned into integers; members that Kadr does not read are not looked at.
/// @return every problem found, up to a limit; each names its JSON pointer
std::vector<Diagnostic> check_schema(nlohmann::json& document, const std::string& file);

/// A copy with only the members that the table knows: no extras (which may nest without limit), no buffers and images
/// (whose data the loader reads itself), no foreign extensions.
nlohmann::json known_members(const nlohmann::json& document);

}  // namespace kadr
