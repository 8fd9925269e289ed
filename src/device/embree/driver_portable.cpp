#define KADR_DRIVER_NAMESPACE portable
#include "device/embree/tile_driver.h"

namespace kadr {

TileDriver* make_portable_driver(kernels::IntegratorKind integrator, unsigned set) {
    return portable::make_driver<float>(integrator, set);
}

}  // namespace kadr
