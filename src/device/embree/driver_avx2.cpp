// Compiled with -mavx2; called only where the processor has it (see factory.cpp).
#define KADR_DRIVER_NAMESPACE avx2
#include "device/embree/tile_driver.h"

namespace kadr {

TileDriver* make_avx2_driver(kernels::IntegratorKind integrator, unsigned set) {
    return avx2::make_driver<kernels::Wide<8>>(integrator, set);
}

}  // namespace kadr
