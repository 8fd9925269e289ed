#pragma once

#include <string>

namespace kadr {

/// The price list as `kadr describe prices` prints it: what each choice between speed and accuracy was measured to cost and
/// to lose on the sample shots, ways to the same error, and what was tried and is not offered.
std::string describe_prices();

}  // namespace kadr
