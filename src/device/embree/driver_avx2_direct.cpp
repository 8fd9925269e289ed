// Compiled with -mavx2; called only where the processor has it (see factory.cpp).
#define KADR_DRIVER_NAMESPACE avx2
#include "device/embree/tile_driver.h"

namespace kadr::avx2 {

TileDriver* make_direct(unsigned set) { return make_one_of<kernels::Wide<8>, IntegratorKind::direct, kernel_sets::kDirect>(set); }

}  // namespace kadr::avx2
