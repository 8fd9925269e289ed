#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "stress/evaluate.h"

namespace kadr::stress {

struct StressOptions {
    std::vector<std::string> axes;           ///< names; empty: all, and their pairs
    bool quick = false;                      ///< fewer values, under a minute
    std::filesystem::path output = "kadr.stress";  ///< folder of the shots and the report
    DeviceRequest device;
};

/// The cells of a sweep, axis by axis; pairs last. @throws InputError  for an unknown axis
std::vector<Cell> cells_to_run(const StressOptions& options);

/// Renders every cell and compares it with the reference.
/// @throws InputError for an unknown axis, RenderError, Interrupted
std::vector<CellResult> run_sweep(const StressOptions& options, const std::function<void(const CellResult&, std::size_t done, std::size_t count)>& done);

}  // namespace kadr::stress
