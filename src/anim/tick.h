#pragma once

namespace kadr {

/// Times within a pass of a loop that are nearer than this, a picosecond, are one: far above the rounding of seconds that
/// people count, far below what a float sees of any motion.
inline constexpr double kTick = 0x1p-40;

}  // namespace kadr
