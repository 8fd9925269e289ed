#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "device/device.h"

namespace kadr {

struct SmokeOptions {
    std::vector<std::filesystem::path> shots;
    DeviceRequest device;
    bool update = false;             ///< write golden images instead of comparing with them
};

/// The outcome of one frame of one shot, or of a shot that could not be loaded.
struct SmokeCase {
    std::string shot;                ///< name; the file's when it could not be read
    int frame = 0;
    std::vector<std::string> failures;  ///< none: passed
    std::string skipped;             ///< why nothing of it is rendered: it is a reel
    bool bad_input = false;          ///< the shot itself is at fault (exit code 2)
    bool compared = false;           ///< there was a golden image
    bool updated = false;
    double flip = 0, tolerance = 0;  ///< mean FLIP against the golden image, and what is allowed
    double seconds = 0;
};

/// Renders the first, the middle and the last frame of each shot, small and with few samples, and looks whether they are
/// finite, neither black nor constant, and like `<shot folder>/golden/<name>.<frame>.png` where there is one.
/// @throws Interrupted, RenderError  (a golden image that cannot be written)
std::vector<SmokeCase> smoke(const SmokeOptions& options, const std::function<void(const SmokeCase&)>& done);

/// The cases as JUnit XML.
std::string junit_xml(const std::vector<SmokeCase>& cases);

}  // namespace kadr
