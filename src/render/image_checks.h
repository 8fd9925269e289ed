#pragma once

#include <string>
#include <vector>

#include "film/film.h"

namespace kadr {

/// What is wrong with a linear image at first sight, in words: not finite, black, constant. Empty: nothing.
std::vector<std::string> obvious_faults(const Image& linear);

}  // namespace kadr
