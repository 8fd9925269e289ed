#pragma once

#include <filesystem>
#include <vector>

#include "anim/timing.h"
#include "base/error.h"
#include "shot/shot.h"

namespace kadr {

/// The files of one frame, one per pattern of the shot.
std::vector<std::filesystem::path> frame_files(const OutputSpec& output, int frame);

/// Folders that frames and the video go into; each once.
std::vector<std::filesystem::path> output_folders(const OutputSpec& output, const std::vector<int>& frames);

/// Patterns that would write several frames to one file.
std::vector<Diagnostic> colliding_patterns(const OutputSpec& output, const std::vector<int>& frames);

/// Why files cannot be written to a folder that exists or would have to be made; empty when they can. Writes nothing.
std::string why_not_writable(const std::filesystem::path& folder);

/// Makes the folders and removes what dead runs left there. @throws RenderError  naming the folder and the reason
void prepare_folders(const std::vector<std::filesystem::path>& folders);

}  // namespace kadr
