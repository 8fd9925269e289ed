#pragma once

#include <cstdint>
#include <filesystem>

namespace kadr {

/// Bytes of compiled kernels that are kept: a kernel takes a few megabytes.
inline constexpr std::uintmax_t kMostCachedKernelBytes = std::uintmax_t{512} << 20;

/// Makes the folder in which HIPRT keeps compiled kernels, and removes those written longest ago while there are more
/// than `most_bytes` of them.
/// @return the folder; empty where it cannot be made, and HIPRT then uses the folder `cache` of the working directory
std::filesystem::path prepare_kernel_cache(const std::filesystem::path& folder,
                                           std::uintmax_t most_bytes = kMostCachedKernelBytes);

}  // namespace kadr
