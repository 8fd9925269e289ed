#pragma once

#include "output/image_io.h"

/// What the image module exports, found by name.
namespace kadr {

inline constexpr const char* kImageModuleFile = "kadr_image.so";
inline constexpr const char* kImageModuleFactory = "kadr_make_image_io";
inline constexpr const char* kImageModuleVersion = "kadr_image_module_version";

/// Program and module share C++ types, so they must be of one version.
using ImageModuleVersion = const char*();
/// @return owned by the caller, never null
using ImageModuleFactory = ImageIo*();

}  // namespace kadr
