#pragma once

#include <optional>

#include "device/device.h"
#include "film/film.h"
#include "render/loaded_shot.h"

namespace kadr {

/// The environment's image as linear R, G, B; nothing where the shot has none. Eight- and sixteen-bit formats are taken
/// as sRGB.
/// @throws InputError  at the shot's key when the file is no image
std::optional<Image> read_environment(const EnvironmentSpec& environment);

/// Gives the scene and the environment's image to the device.
void load_device(Device& device, const LoadedShot& shot);

}  // namespace kadr
