"""What tools/check_gpu_kernels reads out of the headers and the compilers' logs, and when it complains."""

import sys
import unittest
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path

sys.dont_write_bytecode = True
TOOL = Path(__file__).resolve().parents[2] / "tools" / "check_gpu_kernels"


def load():
    loader = SourceFileLoader("check_gpu_kernels", str(TOOL))
    module = module_from_spec(spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


check = load()

NVRTC_LOG = """ptxas info    : 34199 bytes gmem
ptxas info    : Compiling entry function 'kadr_path' for 'sm_90'
ptxas info    : Function properties for kadr_path
ptxas         .     816 bytes stack frame, 20 bytes spill stores, 24 bytes spill loads
ptxas info    : Used 168 registers, used 0 barriers, 820 bytes cumulative stack size
ptxas info    : Function properties for advance
ptxas         .     0 bytes stack frame, 28 bytes spill stores, 32 bytes spill loads
"""

HIPCC_LOG = """a.h:1:1: remark: Function Name: hiprtPrivateStack [-Rpass-analysis=kernel-resource-usage]
a.h:1:1: remark:     VGPRs: 3 [-Rpass-analysis=kernel-resource-usage]
b.h:7:1: remark: Function Name: kadr_path [-Rpass-analysis=kernel-resource-usage]
b.h:7:1: remark:     SGPRs: 108 [-Rpass-analysis=kernel-resource-usage]
b.h:7:1: remark:     VGPRs: 256 [-Rpass-analysis=kernel-resource-usage]
b.h:7:1: remark:     ScratchSize [bytes/lane]: 384 [-Rpass-analysis=kernel-resource-usage]
b.h:7:1: remark:     SGPRs Spill: 89 [-Rpass-analysis=kernel-resource-usage]
b.h:7:1: remark:     VGPRs Spill: 23 [-Rpass-analysis=kernel-resource-usage]
"""


def row(**figures):
    return {"registers": "168", "stack_bytes": "304", "spill_bytes": "0", **{k: str(v) for k, v in figures.items()}}


class Logs(unittest.TestCase):
    def test_nvrtc(self):
        self.assertEqual(check.Nvidia.figures(NVRTC_LOG, "path"), (168, 820, 56))

    def test_hipcc(self):
        self.assertEqual(check.Amd.figures(HIPCC_LOG, "path"), (256, 384, 92))


class Sources(unittest.TestCase):
    def test_requirements_are_those_of_the_kernels(self):
        self.assertEqual(check.requirement_bits(), {"maps": 1, "transforms": 2, "emitters": 4, "deformation": 8, "specials": 16, "mirrors": 32, "ior": 64, "fresnel": 128})

    def test_functions_of_every_geometry_type_are_declared_and_called(self):
        text = check.prologue("path")
        self.assertEqual(text.count("case 0: return kadr_alpha_filter"), 1)
        self.assertEqual(text.count("case 1: return kadr_alpha_filter"), 1)
        self.assertEqual(text.count("case 1: return kadr_moving_triangle"), 1)
        self.assertEqual(text.count("__device__ bool kadr_"), 2)

    def test_the_source_asks_for_its_set(self):
        text = check.source_of("direct", "maps transforms")
        self.assertIn("#define KADR_REQUIREMENTS 3u\n", text)
        self.assertIn('#include "kernels/gpu/direct_entry.h"', text)

    def test_both_compilers_do_the_processors_arithmetic(self):
        _, options = check.host_constants()
        self.assertIn("--fmad=false", options["Cuda"])
        self.assertIn("-ffp-contract=off", options["Hip"])

    def test_nvidias_compiler_is_told_an_architecture_that_the_kernels_can_do_with(self):
        _, options = check.host_constants()
        self.assertIn("--gpu-architecture=compute_75", options["Cuda"])


class Complaints(unittest.TestCase):
    def test_a_little_more_is_no_matter(self):
        self.assertEqual(check.worse(row(registers=176, stack_bytes=368, spill_bytes=32), row()), [])

    def test_more_is(self):
        self.assertEqual(check.worse(row(registers=177, stack_bytes=369, spill_bytes=33), row()),
                         ["registers 168 -> 177", "stack_bytes 304 -> 369", "spill_bytes 0 -> 33"])

    def test_less_is_welcome(self):
        self.assertEqual(check.worse(row(registers=100, stack_bytes=0), row()), [])


if __name__ == "__main__":
    unittest.main()
