#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "stress/evaluate.h"

namespace kadr::stress {

/// Values of an axis around its ordinary one for which everything is sound.
struct SafeRange {
    const Axis* axis = nullptr;
    double low = 0, high = 0;
    bool complete = false;   ///< all values of the sweep
    bool none = false;       ///< not even the ordinary value
    std::string text() const;   ///< "0 to 1e+09 m"
};

/// Of every axis in the results, from its own cells alone, in their order.
std::vector<SafeRange> safe_ranges(const std::vector<CellResult>& results);

/// All rays and samples of a sweep.
RayFigures total_rays(const std::vector<CellResult>& results);

/// What is known of a cell, as a JSON object.
std::string json_of(const CellResult& result);

/// Writes FOLDER/report.html (one page, self-contained, with a heat map), report.csv and report.json.
/// @return the page  @throws RenderError
std::filesystem::path write_report(const std::vector<CellResult>& results, const std::filesystem::path& folder);

}  // namespace kadr::stress
