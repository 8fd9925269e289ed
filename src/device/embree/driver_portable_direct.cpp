#define KADR_DRIVER_NAMESPACE portable
#include "device/embree/tile_driver.h"

namespace kadr::portable {

TileDriver* make_direct(unsigned set) { return make_one_of<float, IntegratorKind::direct, kernel_sets::kDirect>(set); }

}  // namespace kadr::portable
