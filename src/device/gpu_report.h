#pragma once

#include <string>
#include <vector>

namespace kadr {

/// What rendering on a GPU needs on this machine, one line each in the order in which it was looked for; the last line
/// says what is missing, unless nothing is.
std::vector<std::string> describe_gpu_needs();

/// What of the GPU device no GPU has shown yet: it is tested against fakes only.
std::vector<std::string> unproven_on_gpu();

}  // namespace kadr
