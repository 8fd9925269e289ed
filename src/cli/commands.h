#pragma once

#include "cli/command_line.h"

namespace kadr {

/// Does what was asked for. @return the exit code where nothing was thrown
/// @throws InputError, RenderError, Interrupted
int run_command(const Invocation& invocation);

}  // namespace kadr
