#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "output/encoder.h"
#include "render/prepared_shot.h"
#include "render/reel_edit.h"
#include "render/render_job.h"
#include "shot/reel.h"

namespace kadr {

/// A shot as the reel shows it: at the reel's rate and size, with all the frames that cuts of it need. Cuts of the same
/// shot with the same settings share one.
struct ReelSource {
    PreparedShot prepared;    ///< `shot.timing.frames` are the frames that the reel shows
    bool own = true;          ///< the frames are those that the shot itself renders, and lie where it says
    std::string identity;     ///< hash of its settings and files' names
};

/// A reel with everything known that can be known before the first frame.
struct ReelPlan {
    Reel reel;
    ReelEdit edit{{}};
    std::vector<ReelSource> sources;
    std::vector<int> source_of;       ///< [cut]
    std::vector<int> frames;          ///< of the reel, to be made; ascending
    std::optional<VideoPlan> video;
    std::vector<Diagnostic> warnings;
};

/// Reads a reel and its shots, binds their names, and makes the edit. Writes nothing.
/// @throws InputError  with all problems of the reel and of its shots
ReelPlan plan_reel(const std::filesystem::path& reel, const ShotOverrides& overrides);

/// Everything that can be known before rendering; writes nothing. @return warnings and, when verbose, the edit
/// @throws InputError  with all problems
CheckReport check_reel(const std::filesystem::path& reel, const ShotOverrides& overrides, bool verbose = false);

/// The table of cuts: where each begins in the reel, which part of its shot it shows, how it is joined.
std::string edit_text(const ReelPlan& plan);

}  // namespace kadr
