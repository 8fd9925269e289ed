#define KADR_DRIVER_NAMESPACE portable
#include "device/embree/tile_driver.h"

namespace kadr::portable {

TileDriver* make_maps_path(unsigned set) { return make_one_of<float, IntegratorKind::path, kernel_sets::kMapsPath>(set); }

}  // namespace kadr::portable
