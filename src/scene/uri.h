#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kadr {

/// "%20" to a space; a percent sign without two hex digits stays as it is.
std::string percent_decode(std::string_view text);

/// The bytes of a "data:" URI (base64 or percent-encoded); nothing when the text is not a well-formed one.
std::optional<std::vector<std::uint8_t>> decode_data_uri(std::string_view uri);

/// A decoded relative path, normalised, or nothing when it is absolute, has a scheme (http:), holds a zero byte or
/// leads out of the folder it starts from.
std::optional<std::string> path_within_folder(std::string_view uri);

}  // namespace kadr
