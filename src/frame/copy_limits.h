#pragma once

#include "frame/bindings.h"
#include "frame/frame_state.h"

namespace kadr {

/// Every light costs each shaded point some work, so copies of lights are for tens, not for thousands.
inline constexpr std::size_t kMostLightCopies = 1024;
/// Triangles of copies that shine: each is a light of its own, 64 bytes in a table and as many while the table is made.
inline constexpr std::size_t kMostShiningTriangles = 16'000'000;

/// Checks what copies of scenes multiply: instances, lights, and triangles that shine.
/// @throws InputError  with the number found, for the file whose copies are to blame
void check_limits(const Shot& shot, const Scene& scene, const Bindings& bindings);

}  // namespace kadr
