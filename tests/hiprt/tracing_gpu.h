#pragma once

#include "fake_gpu.h"

namespace kadr::test {

/// A GPU whose kernels run, on the host: rays are traced by brute force through what HIPRT was given.
struct TracingGpu : FakeGpu {
    TracingGpu();
};

}  // namespace kadr::test
