#pragma once

namespace kadr {

/// Times nearer than this, a picosecond, are one where a pass is folded back onto another: far above the rounding of seconds
/// that people count, far below what a float sees of any motion.
inline constexpr double kTick = 0x1p-40;

/// x modulo a period, in [0, period); less than a tick before the end is the next start.
double wrapped(double x, double period);

}  // namespace kadr
