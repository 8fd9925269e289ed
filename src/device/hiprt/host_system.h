#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kadr {

/// What the search for GPU libraries asks of the machine; tests answer in its place.
class HostSystem {
public:
    virtual ~HostSystem() = default;
    /// Whether a shared library can be opened: a name that the loader looks for, or a path. It stays open.
    virtual bool can_open(const std::string& library) const = 0;
    /// Whether a library that can be opened exports a function.
    virtual bool exports(const std::string& library, const char* function) const = 0;
    virtual std::optional<std::string> variable(const char* name) const = 0;  ///< of the environment; none when empty
    virtual bool exists(const std::filesystem::path& path) const = 0;
    virtual bool is_file(const std::filesystem::path& path) const = 0;
    virtual std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) const = 0;  ///< sorted
    virtual std::string text_of(const std::filesystem::path& file) const = 0;  ///< empty when it cannot be read
    virtual std::filesystem::path program_folder() const = 0;                  ///< where the running program lies
};

/// The machine that the program runs on.
const HostSystem& this_machine();

}  // namespace kadr
