#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "device/device.h"

namespace kadr {

/// A scene of a few hundred triangles with what devices do in different ways: meshes that stand, move and turn, bend while
/// the shutter is open, and are cut out.
struct CheckScene {
    Scene scene;
    SceneSnapshot snapshot;
};
CheckScene make_check_scene();

/// What a device makes of the built-in scene: a few hundred camera and shadow rays and a small picture, with the random
/// numbers of the reference, against what that makes of it. Rays near an edge are left out.
/// @return what is wrong, as the end of a sentence that begins with the device ("gave 3 wrong hits of 400"); empty: nothing
std::string find_fault(Device& device, Device& reference);

/// The outcome of a check that takes long, kept in a file between runs.
/// @param file   named after everything that the outcome depends on; empty: nothing is kept
/// @param check  find_fault. Where it throws, the reason is the fault, and nothing is kept
std::string kept_fault(const std::filesystem::path& file, const std::function<std::string()>& check);

}  // namespace kadr
