#include "base/cache_folder.h"

#include <cstdlib>

namespace kadr {

namespace {

/// A variable's value; an empty one counts as unset.
std::optional<std::filesystem::path> folder_from(const char* variable) {
    const char* value = std::getenv(variable);
    if (!value || !*value) return std::nullopt;
    return std::filesystem::path(value);
}

}  // namespace

std::optional<std::filesystem::path> cache_folder() {
    if (const auto own = folder_from("KADR_CACHE")) return own;
    if (const auto shared = folder_from("XDG_CACHE_HOME")) return *shared / "kadr";
    if (const auto home = folder_from("HOME")) return *home / ".cache" / "kadr";
    return std::nullopt;
}

}  // namespace kadr
