#pragma once

#include <memory>

#include "device/device.h"
#include "frame/frame_state.h"

namespace kadr {

/// The reference: the kernels over double, rays traced in double, everything where the shot's tracks have it at the time
/// of each sample. It takes the random numbers of the other devices, so what its pictures differ by is their rounding
/// and their motion keys, not noise. For small scenes: every moving sample places the whole scene anew. Lays no data
/// layers into the film.
/// @param shot  outlives the device; the one whose snapshots it is given
/// @throws InputError  from set_frame, for meshes that bend
std::unique_ptr<Device> make_exact_device(const BoundShot& shot);

}  // namespace kadr
