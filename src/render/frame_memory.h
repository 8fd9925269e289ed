#pragma once

#include <cstddef>
#include <cstdint>

#include "shot/shot.h"

namespace kadr {

/// Films up to this size are kept from frame to frame; a larger one goes while its picture is developed.
inline constexpr std::uint64_t kMostFilmKept = std::uint64_t{512} << 20;

/// How many halves the film of a shot needs: one sample says nothing of its noise.
/// @param parts  of the shutter, each of which gets a sample
int film_halves(const RenderSpec& render, std::size_t parts);

/// Bytes of a frame's pixels.
struct FrameBytes {
    double sums = 0;        ///< the film, while rays are traced
    double image = 0;       ///< a finished frame
    double estimating = 0;  ///< rows of both halves as they are shown, for the noise
    double writing = 0;     ///< the picture in its file's format, encoded
    double encoding = 0;    ///< the picture read back for the video
    bool film_is_kept = true;
    /// At the moment after the last ray when they take the most.
    double finishing() const;
};
/// @param parts     of the shutter
/// @param weighted  samples count for different amounts of light
FrameBytes frame_bytes(const Shot& shot, std::size_t parts, bool weighted);

/// Memory of the machine, or what the process may have of it (control groups); 0 where it is not known.
std::uint64_t machine_memory_bytes();

/// An operating system that gives memory before it has it ends the program later, without a message.
/// @throws InputError  where a frame would take more than the machine has
void check_frame_memory(const Shot& shot);

}  // namespace kadr
