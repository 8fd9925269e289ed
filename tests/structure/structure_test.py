"""structure.py finds every kind of fault in a tree made for it, and none in a tree that is right."""

import tempfile
import unittest
from pathlib import Path

import structure

RIGHT = {
    "src/base/CMakeLists.txt": "kadr_folder(base\n    LINK fmt::fmt)",
    "src/base/error.h": "#include <string>\n",
    "src/shot/CMakeLists.txt": "kadr_folder(shot\n    LINK base)  # not render",
    "src/shot/shot.cpp": '#include "shot/shot.h"\n#include "base/error.h"\n#include "kernels/math/vec.h"\n',
    "src/render/CMakeLists.txt": "kadr_folder(render LINK shot)",
    "src/render/job.cpp": '#include "base/error.h"\n#include "shot/shot.h"\n',
    "kernels/math/vec.h": '#include "kernels/math/scalar.h"\n',
    "tests/shot/CMakeLists.txt": "kadr_test(shot_test SOURCES shot_test.cpp LINK shot)",
    "tests/shot/shot_test.cpp": '#include "shot/shot.h"\n#include "base/error.h"\n#include "support/files.h"\n',
}


class Structure(unittest.TestCase):
    def faults(self, **changes):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in {**RIGHT, **changes.get("files", {})}.items():
                path = root / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            return structure.faults(root)

    def test_right_tree(self):
        self.assertEqual(self.faults(), [])

    def test_against_the_arrow(self):
        found = self.faults(files={"src/shot/shot.cpp": '#include "render/job.h"\n'})
        self.assertEqual(found, ['src/shot/shot.cpp: includes "render/job.h", but its link list does not reach render'])

    def test_a_test_past_its_link_list(self):
        found = self.faults(files={"tests/shot/shot_test.cpp": '#include "render/job.h"\n'})
        self.assertEqual(found, ['tests/shot/shot_test.cpp: includes "render/job.h", but its link list does not reach render'])

    def test_kernels_outside_themselves(self):
        found = self.faults(files={"kernels/math/vec.h": '#include "base/error.h"\n'})
        self.assertEqual(found, ['kernels/math/vec.h: includes "base/error.h"; kernels/ includes nothing outside itself'])

    def test_a_circle(self):
        found = self.faults(files={"src/base/CMakeLists.txt": "kadr_folder(base LINK render)"})
        self.assertIn("src/base: its arrows lead back to itself", found)

    def test_round_the_folder(self):
        found = self.faults(files={"src/shot/shot.cpp": '#include "../render/job.h"\n'})
        self.assertEqual(found, ['src/shot/shot.cpp: includes "../render/job.h"; write the path from src/ instead'])

    def test_an_empty_tree(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(len(structure.faults(Path(folder))), 1)


if __name__ == "__main__":
    unittest.main()
