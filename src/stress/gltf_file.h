#pragma once

#include <filesystem>

#include "stress/stage.h"

namespace kadr::stress {

/// Writes FOLDER/NAME.gltf and NAME.bin. @throws RenderError
/// @return the .gltf file
std::filesystem::path write_gltf(const Stage& stage, const std::filesystem::path& folder);

}  // namespace kadr::stress
