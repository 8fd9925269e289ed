#pragma once

#include <filesystem>
#include <optional>

namespace kadr {

/// Where Kadr keeps what it can make again: KADR_CACHE, else kadr in XDG_CACHE_HOME, else ~/.cache/kadr. Nothing where the
/// environment names no place.
std::optional<std::filesystem::path> cache_folder();

}  // namespace kadr
