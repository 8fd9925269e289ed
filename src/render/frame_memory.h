#pragma once

#include <cstdint>

#include "shot/shot.h"

namespace kadr {

/// Bytes that the pixels of a frame of the shot take: the film, what is developed from it, and the values that are written.
std::uint64_t frame_bytes(const Shot& shot);

/// Memory of the machine, or what the process may have of it (control groups); 0 where it is not known.
std::uint64_t machine_memory_bytes();

/// An operating system that gives memory before it has it ends the program later, without a message.
/// @throws InputError  where a frame would take more than the machine has
void check_frame_memory(const Shot& shot);

}  // namespace kadr
