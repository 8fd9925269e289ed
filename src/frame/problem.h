#pragma once

#include <string>

#include "base/error.h"

namespace kadr {

/// A diagnostic at a place of the shot file, with the line that it speaks of where the file can be read.
Diagnostic problem_at(const SourceLocation& where, std::string found, std::string expected);
Diagnostic warning_at(const SourceLocation& where, std::string found, std::string expected);

}  // namespace kadr
