#pragma once

#include <cstddef>

namespace kadr::test {

/// What a process that tries numbers may take; with everything loaded it takes a tenth.
inline constexpr std::size_t kMostMemory = std::size_t{1} << 30;

/// Texts of numbers that no field of a shot or a reel expects.
inline constexpr const char* kYamlNumbers[] = {".nan", ".inf", "-.inf", "1e400", "1e308", "-1e308", "1e39", "1e20", "1e-20", "1e-40", "1e-320", "5e-324", "-0.0", "0", "-1", "1e9", "2147483648", "-2147483649",
                                    "4294967296", "9223372036854775807", "123456789012345678901234567890"};

}  // namespace kadr::test
