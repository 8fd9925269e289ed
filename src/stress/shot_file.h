#pragma once

#include <filesystem>

#include "stress/stage.h"

namespace kadr::stress {

/// Writes FOLDER/NAME.yaml, which names NAME.gltf, and the environment image where the stage has one. @throws RenderError
/// @return the shot file
std::filesystem::path write_shot_file(const Stage& stage, const std::filesystem::path& folder);

}  // namespace kadr::stress
