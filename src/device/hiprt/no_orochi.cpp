// Compiled in the place of orochi_runtime.cpp where CMake found no Orochi: the probe says so before anybody asks
// further.

#include "device/hiprt/orochi_runtime.h"

namespace kadr {
namespace {

[[noreturn]] void refuse() { throw RenderError("this program was built without Orochi"); }

}  // namespace

bool built_with_orochi() { return false; }
int count_gpus(GpuVendor) { refuse(); }
std::unique_ptr<GpuRuntime> make_orochi_runtime(GpuVendor, int) { refuse(); }

}  // namespace kadr
