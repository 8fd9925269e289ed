#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "device/hiprt/hiprt_abi.h"
#include "device/hiprt/host_system.h"

namespace kadr {

/// What a search found, or one sentence that says why nothing was found and what to do.
template <class T>
using Found = std::variant<T, std::string>;

/// API version in the name of a library file ("libhiprt0300164.so" is 3001); none where the name tells none.
std::optional<std::uint32_t> api_version_of(const std::filesystem::path& library);

/// Where libhiprt is: KADR_HIPRT_LIBRARY (a file), HIPRT_ROOT (its folders lib, lib64, bin, itself), then the usual
/// places. What a variable names is taken or refused; nothing else is looked for instead. A file whose name tells
/// another API version is refused by it; what its name does not tell, hiprtCreateContext does.
Found<std::filesystem::path> find_hiprt_library(const HostSystem& machine);

/// libhiprt, open until the program ends.
class HiprtLibrary {
public:
    /// @throws InputError  when it cannot be opened or lacks an entry point, which is named
    static HiprtLibrary open(const std::filesystem::path& file);

    const hiprt::Api& api() const { return api_; }
    const std::filesystem::path& file() const { return file_; }

private:
    HiprtLibrary() = default;
    std::filesystem::path file_;
    hiprt::Api api_;
};

}  // namespace kadr
