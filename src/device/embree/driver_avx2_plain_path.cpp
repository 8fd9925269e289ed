// Compiled with -mavx2; called only where the processor has it (see factory.cpp).
#define KADR_DRIVER_NAMESPACE avx2
#include "device/embree/tile_driver.h"

namespace kadr::avx2 {

TileDriver* make_plain_path(unsigned set) { return make_one_of<kernels::Wide<8>, IntegratorKind::path, kernel_sets::kPlainPath>(set); }

}  // namespace kadr::avx2
