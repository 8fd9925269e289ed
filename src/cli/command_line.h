#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/compare_job.h"
#include "measure/device_comparison.h"
#include "measure/measure_job.h"
#include "render/render_job.h"
#include "render/smoke.h"
#include "stress/sweep.h"

namespace kadr {

enum class Command { render, preview, check, explain, describe, smoke, compare, compare_devices, measure, info, devices, stress };

/// What the user asked for. Only the members of `command` are filled in.
struct Invocation {
    Command command = Command::render;
    RenderOptions render;                        ///< render, explain, preview (its shot and overrides), check (overrides)
    PreviewOptions preview;
    SmokeOptions smoke;
    CompareOptions compare;
    DeviceComparisonOptions compare_devices;
    MeasureOptions measure;
    stress::StressOptions stress;
    std::vector<std::filesystem::path> shots;    ///< check
    std::filesystem::path file;                  ///< info
    std::filesystem::path junit;
    std::string key;                             ///< describe
    bool json_schema = false;
    bool json = false, stats = false;
    bool verbose = false;                        ///< check, devices
    bool trial = false;                          ///< explain: render a little to say what a frame costs
    std::string text;                            ///< help or version asked for: print this and end
};

/// Reads the arguments, in any order.
/// @throws InputError  with "did you mean" for unknown commands and options
Invocation parse_command_line(const std::vector<std::string>& arguments);

}  // namespace kadr
