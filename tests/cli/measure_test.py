"""`kadr measure` from outside: what it writes, that its figures are those of its images, that a stopped run goes on."""

import csv
import json
import re
import shutil
import subprocess

import program
from program import ProgramTest

try:
    import numpy
except ImportError:
    numpy = None

def exr(path):
    """[y][x][RGB] of an EXR file, by ffmpeg."""
    probe = subprocess.run(["ffprobe", "-v", "error", "-show_entries", "stream=width,height,pix_fmt", "-of", "json", path], check=True, capture_output=True)
    stream = json.loads(probe.stdout)["streams"][0]
    # In its own format: a conversion would go through 16 bits.
    planes = {"gbrpf32le": 3, "gbrapf32le": 4}[stream["pix_fmt"]]
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-"], check=True, capture_output=True).stdout
    values = numpy.frombuffer(raw, "<f4").reshape(planes, stream["height"], stream["width"]).astype(float)
    return values[[2, 0, 1]].transpose(1, 2, 0)


SWEEP = ("--quick", "--size", "32x18", "--sweep", "samples,bounces", "--output", "report")


class Measure(ProgramTest):
    def measure(self, *arguments, code=0):
        return self.run_kadr("measure", self.shot, *arguments, code=code)

    def report(self):
        return json.loads((self.folder / "report" / "measure.json").read_text())

    def images(self):
        return {path: path.stat().st_mtime_ns for folder in ("report/images", "cache/references") for path in (self.folder / folder).rglob("*.exr")}

    def test_a_report_of_everything(self):
        out = self.measure(*SWEEP).out
        self.assertRegex(out, r"(?m)^shot +[0-9.]+ +0\.[0-9]{4}")
        data = self.report()
        axes = [(variant["axis"], variant["value"]) for variant in data["variants"]]
        self.assertEqual(axes[:3], [("shot", ""), ("samples", "4"), ("samples", "64")])
        self.assertIn(("bounces", "0"), axes)
        self.assertEqual(data["size"], [32, 18])
        rows = list(csv.DictReader((self.folder / "report" / "measure.csv").read_text().splitlines()))
        self.assertEqual(len(rows), (len(axes) + 1) * len(data["frames"]))
        self.assertTrue(any(variant["on_front"] for variant in data["variants"]))
        self.assertIn(data["recommendation"]["yaml"], out)
        page = (self.folder / "report" / "measure.html").read_text()
        for part in ("<svg", "data:image/png;base64,", "samples 64", data["recommendation"]["yaml"]):
            self.assertTrue(part in page, part)
        self.assertFalse(re.search(r"""(src|href|url)\s*[=(]\s*["']?https?:""", page), "something comes from elsewhere")
        self.assertEqual(self.temporary_files(), [])

    def test_a_second_run_renders_nothing_again(self):
        self.measure(*SWEEP)
        before = self.images()
        self.assertEqual(len(before) % 2, 0)
        next(path for path in before if "bounces-0" in str(path)).unlink()  # as if the run had been stopped there
        self.measure(*SWEEP)
        after = self.images()
        self.assertEqual(set(before), set(after))
        self.assertEqual(sum(before[path] != after[path] for path in before), 1)

    def test_the_figures_are_those_of_the_images(self):
        if numpy is None:
            self.skipTest("numpy is missing")
        self.measure(*SWEEP)
        data = self.report()
        references = [exr(path) for path in data["reference"]["images"]]
        for variant in data["variants"]:
            for i, frame in enumerate(variant["frames"]):
                r1, r2 = references[2 * i], references[2 * i + 1]
                a, b = (exr(path) for path in frame["images"])
                mean = (r1 + r2) / 2
                weight = mean ** 2 + 0.01
                expected = {"noise": ((a - b) ** 2 / 2 / weight).mean(), "bias": ((a - r1) * (b - r2) / weight).mean(),
                            "relmse": (((a - mean) ** 2 + (b - mean) ** 2) / 2 / weight).mean() - ((r1 - r2) ** 2 / 4 / weight).mean()}
                for name, value in expected.items():
                    # The weights are single floats there, doubles here.
                    self.assertAlmostEqual(frame[name], value, delta=1e-5 * abs(value) + 1e-9, msg=f"{variant['axis']} {variant['value']} {name}")

    def test_refusals(self):
        for arguments, message in ((("--sweep", "sample"), "--sweep names 'sample'"), (("--sweep", "devices"), "--sweep names 'devices'"),
                                   (("--size", "0x3"), "--size is '0x3'")):
            process = self.measure(*arguments, code=2)
            self.assertIn(message, process.err)
            self.assertFalse((self.folder / "ball.measure").exists())

    def test_the_page_in_a_browser(self):
        browser = shutil.which("chromium") or shutil.which("chromium-browser")
        if not browser:
            self.skipTest("there is no chromium on the PATH")
        self.measure(*SWEEP)
        picture = self.folder / "page.png"
        subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--window-size=1180,1600", f"--user-data-dir={self.folder / 'profile'}",
                        f"--screenshot={picture}", (self.folder / "report" / "measure.html").as_uri()], check=True, capture_output=True, timeout=120)
        kept = program.Path(program.BUILD) / "Testing" / "measure_page.png"
        kept.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(picture, kept)
        if numpy is None:
            self.skipTest("numpy is missing: the screenshot is kept but not looked at")
        pixels = numpy.frombuffer(subprocess.run(["ffmpeg", "-v", "error", "-i", picture, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"], check=True,
                                                 capture_output=True).stdout, numpy.uint8).reshape(1600, 1180, 3).astype(int)
        self.assertGreater((pixels.sum(axis=2) < 200).mean(), 0.005)   # there is text
        blue = (abs(pixels - (0x00, 0x72, 0xB2)).sum(axis=2) < 30).mean()
        self.assertGreater(blue, 0.001)                                # the curve of samples, the advice's edge


if __name__ == "__main__":
    program.main()
