#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "shot/shot.h"
#include "shot/shot_parser.h"

namespace kadr {

/// A time or a duration of a reel, and how and where it was written.
struct ReelTime {
    double seconds = 0;
    std::string written;  ///< "12 f"
    SourceLocation where;
};

struct ReelFade {
    ReelTime duration;
    glm::dvec3 color{0};  ///< display-referred, 0 to 1
};

/// One shot of the list, cut out of its file.
struct ReelEntry {
    SourceLocation where;  ///< of the shot's file name
    Shot shot;             ///< with the entry's `set` and the command line laid over it
    bool changed = false;  ///< `set` changes it
    std::optional<ReelTime> in, out;  ///< times of the shot
    double speed = 1;
    ReelTime hold, crossfade;
    ReelFade fade_in, fade_out;  ///< zero duration: none
};

struct SoundSpec {
    std::filesystem::path file;  ///< absolute
    SourceLocation where;
    double start_s = 0;                      ///< in the file
    double offset_s = 0;                     ///< in the reel
    double gain_db = 0;
    double fade_in_s = 0, fade_out_s = 0;
    bool loop = false;
    bool operator==(const SoundSpec&) const = default;
};

enum class ReelBlend { display, linear };

/// A validated reel and its shots.
struct Reel {
    std::filesystem::path file;  ///< absolute
    std::string name;
    SourceLocation where;  ///< of the list of shots
    Rational fps;
    ImageSpec image;       ///< size; the pixel aspect is the first shot's
    glm::dvec3 bars{0};    ///< display-referred, 0 to 1
    ReelBlend blend = ReelBlend::display;
    std::vector<ReelEntry> entries;  ///< never empty
    std::optional<SoundSpec> sound;
    std::string shot_frames;         ///< absolute pattern with {shot} and {frame} left
    OutputSpec output;               ///< `frames` is empty, or the pattern of the reel's own frames
    std::vector<Diagnostic> warnings;
};

/// Whether a file is a reel: a map with the key kadr-reel. False for what cannot be read, too.
bool is_reel(const std::filesystem::path& path);

/// Reads and validates a reel and every shot in it. Of the command line, keys that begin with "reel.", the size, the
/// output pattern and the video go to the reel, the rest to each shot; `overrides.frames` is not looked at.
/// @throws InputError  with all problems of the reel and of its shots
Reel parse_reel(const std::filesystem::path& path, const ShotOverrides& overrides = {});

}  // namespace kadr
