#pragma once

#include <gtest/gtest.h>

#include <cstring>

#include "film/film.h"

namespace kadr::test {

/// Whether two images are the same to the last bit, zeros of either sign and NaNs told apart; else the first value that differs.
inline testing::AssertionResult same_bits(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height || a.channels != b.channels || a.pixels.size() != b.pixels.size())
        return testing::AssertionFailure() << "the sizes or the channels differ";
    const std::size_t channels = a.channels.size(), width = static_cast<std::size_t>(a.width);
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        if (std::memcmp(&a.pixels[i], &b.pixels[i], sizeof(float)) != 0)
            return testing::AssertionFailure() << "pixel " << i / channels % width << ", " << i / channels / width << ", " << a.channels[i % channels]
                                               << ": " << a.pixels[i] << " and " << b.pixels[i];
    return testing::AssertionSuccess();
}

}  // namespace kadr::test
