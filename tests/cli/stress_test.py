"""kadr stress: the quick sweep holds what is stated to be safe, and says where it ends.

usage: stress_test.py KADR BUILD_FOLDER CMAKE
"""

import csv
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

KADR = sys.argv[1]


def stress(*arguments):
    return subprocess.run([KADR, "stress", *arguments], capture_output=True, text=True, timeout=280)


class QuickSweep(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.output = Path(cls.folder.name) / "sweep"
        cls.sweep = stress("--quick", "--output", str(cls.output))
        cls.cells = json.loads((cls.output / "report.json").read_text())

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_everything_that_is_stated_to_be_safe_is_sound(self):
        faults = [line for line in self.sweep.stdout.splitlines() if line.startswith("FAILED")]
        self.assertEqual((self.sweep.returncode, faults), (0, []), self.sweep.stderr)
        safe = [cell for cell in self.cells if cell["stated_safe"]]
        self.assertGreater(len(safe), 100)
        for figure in ("holes", "wrong_surfaces", "false_shadows", "leaks", "dropped_samples", "not_finite"):
            self.assertEqual([cell["cell"] for cell in safe if cell.get(figure, 0) > 0], [], figure)
        self.assertEqual([cell["cell"] for cell in safe if cell.get("image_error", 0) >= 1], [])
        self.assertGreater(sum(cell.get("shadow_rays", 0) for cell in safe), 500_000)

    def test_pictures_that_must_not_change_do_not(self):
        drifting = {cell["cell"]: cell["drift"] for cell in self.cells if cell["stated_safe"] and cell.get("drift", 0) > 0.01}
        self.assertEqual(drifting, {})
        self.assertGreater(sum("drift" in cell for cell in self.cells), 20)

    def test_the_sweep_goes_beyond_what_is_safe(self):
        beyond = [cell for cell in self.cells if not cell["sound"]]
        self.assertTrue(beyond)  # else it would not look far enough
        for cell in beyond:
            self.assertFalse(cell["stated_safe"], cell["cell"])

    def test_a_thin_shell_is_warned_of_by_name(self):
        cell = next(cell for cell in self.cells if cell["cell"] == "thickness_1e-09")
        self.assertIn("nodes 'stage/Stage/Ball' and 'stage/Stage/Inner' are a shell 1e-09 m thick", cell["warnings"][0])

    def test_the_page_holds_all_that_it_shows(self):
        page = (self.output / "report.html").read_text()
        self.assertIn("<h2>Safe ranges</h2>", page)
        self.assertNotIn("http", page)
        for cell in self.cells:
            self.assertIn(f">{cell['cell']}</th>", page)
        rows = list(csv.DictReader((self.output / "report.csv").open()))
        self.assertEqual([row["cell"] for row in rows], [cell["cell"] for cell in self.cells])

    def test_a_cell_is_ordinary_input(self):
        picture = self.output / "again.png"
        run = subprocess.run([KADR, "render", str(self.output / "scale_1e-09.yaml"), "--output", str(picture), "--video", "none"], capture_output=True, text=True, timeout=60)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertTrue(picture.exists())


class Arguments(unittest.TestCase):
    def test_an_unknown_axis_is_refused_by_name(self):
        run = stress("distanse")
        self.assertEqual(run.returncode, 2)
        self.assertIn("distanse", run.stderr)
        self.assertIn("did you mean distance?", run.stderr)

    def test_json_has_an_object_a_line(self):
        with tempfile.TemporaryDirectory() as folder:
            run = stress("metallic", "--quick", "--json", "--output", folder)
            self.assertEqual(run.returncode, 0, run.stderr)
            lines = [json.loads(line) for line in run.stdout.splitlines()]
        self.assertEqual([line["event"] for line in lines], ["cell"] * 3 + ["summary"])
        self.assertEqual([line.get("cell") for line in lines[:3]], ["metallic_0", "metallic_0.5", "metallic_1"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=1)
