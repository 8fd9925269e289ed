#include "kernels/lanes_cases.h"

namespace kadr::kernels {

void run_case_avx2(const CaseWorld& world, int index, const float* inputs, float* outputs) {
    run_case<Wide<8>>(world, index, inputs, outputs);
}

}  // namespace kadr::kernels
