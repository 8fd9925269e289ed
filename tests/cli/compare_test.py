"""`kadr compare`: files, folders and shots from outside, its figures against another program's of the same images."""

import json
import sys

import program
from program import ProgramTest

try:
    import numpy
except ImportError:
    numpy = None


class Compare(ProgramTest):
    def render(self, folder, *more):
        self.run_kadr("render", self.shot, "--output", f"{folder}/x.{{frame:02}}.png", *more)

    def compare(self, *arguments, code=0):
        return self.run_kadr("compare", *arguments, code=code)

    def lines(self, *arguments, code=0):
        return [json.loads(line) for line in self.compare(*arguments, "--json", code=code).out.splitlines()]

    def test_equal_frames(self):
        self.render("a")
        said = self.lines("a", "a", "--fail-above", "flip=0,rmse=0,psnr=99")
        self.assertEqual([line.get("frame") for line in said], ["0", "1", "2", None])
        self.assertEqual((said[-1]["rmse"], said[-1]["flip"], said[-1]["psnr"], said[-1]["failed"]), (0, 0, None, False))

    def test_noise_fails_the_gate(self):
        self.render("a", "--samples", "64")
        self.render("b", "--samples", "1")
        out = self.compare("a", "b", "--fail-above", "0.001", code=1).out
        self.assertRegex(out, r"(?m)^frame +RMSE +relMSE +PSNR +SSIM +FLIP")
        self.assertRegex(out, r"(?m)^  FAILED: flip [0-9.]+ is above 0\.001$")
        self.assertRegex(out, r"(?m)^mean .*worst: [012], FLIP")
        self.compare("a", "b", "--fail-above", "0.9")

    def test_a_shot_is_rendered_where_frames_are_missing(self):
        self.render("golden")
        said = self.lines("golden", self.shot, "--fail-above", "0.0001")
        self.assertEqual(said[-1]["event"], "summary")
        self.assertEqual(self.frames(), ["ball.0000.png", "ball.0001.png", "ball.0002.png"])
        before = [(self.folder / "out" / name).stat().st_mtime_ns for name in self.frames()]
        self.lines("golden", self.shot)
        self.assertEqual(before, [(self.folder / "out" / name).stat().st_mtime_ns for name in self.frames()])

    def test_two_shots_that_write_the_same_files(self):
        other = self.write_shot(name="other.yaml")
        self.assertIn("both write", self.compare(self.shot, other, code=2).err)
        self.assertEqual(self.frames(), [])

    def test_maps_and_video(self):
        self.render("a", "--samples", "16")
        self.render("b", "--samples", "1")
        said = self.lines("a", "b", "--maps", "maps", "--video", "heat.mkv", "--frames", "1-2", "--fps", "30000/1001")
        self.assertEqual(self.frames("maps/*.png"), ["flip.0001.png", "flip.0002.png"])
        self.assertTrue((self.folder / "heat.mkv").stat().st_size > 0)
        self.assertTrue(said[-1]["video"].endswith("heat.mkv"))
        self.assertEqual(self.temporary_files(), [])

    def test_refusals(self):
        self.render("a")
        for arguments, message in (((("a", "nowhere")), "there is no file or folder 'nowhere'"),
                                   (("a", "a", "--fail-above", "x"), "--fail-above is 'x'"),
                                   (("a", "a", "--view", "film"), "--view is 'film'"),
                                   (("a", "a", "--fps", "0"), "--fps is '0'"),
                                   (("a", "a", "--frames", "5"), "has frame 5"),
                                   (("a/x.01.png", "a"), "is one image"),
                                   (("a", "ball.gltf"), "'ball.gltf' is not an image")):
            process = self.compare(*arguments, code=2)
            self.assertIn(message, process.err)
            self.assertEqual(process.out, "")

    @staticmethod
    def values(path):
        """[y][x][RGB] of an 8-bit RGB or RGBA PNG file without filters that need more than the row above."""
        scanlines, _ = program.png(path)
        width, height = 48, 32
        channels = (len(scanlines) // height - 1) // width
        rows = numpy.frombuffer(scanlines, numpy.uint8).reshape(height, -1)
        result = numpy.zeros((height, width * channels), numpy.int64)
        for y in range(height):
            kind, row = rows[y, 0], rows[y, 1:].astype(numpy.int64)
            above = result[y - 1] if y else numpy.zeros_like(row)
            for i in range(len(row)):
                left = result[y, i - channels] if i >= channels else 0
                corner = above[i - channels] if i >= channels else 0
                nearest = min((left, above[i], corner), key=lambda v, l=left, a=above[i], c=corner: abs(l + a - c - v))
                result[y, i] = (row[i] + (0, left, above[i], (left + above[i]) // 2, nearest)[kind]) % 256
        return result.reshape(height, width, channels)[..., :3] / 255

    def test_figures_are_those_of_their_definitions(self):
        if numpy is None:
            self.skipTest("no numpy: install python3-numpy to recompute the figures")
        self.render("a", "--samples", "16", "--frames", "0")
        self.render("b", "--samples", "1", "--frames", "0")
        said = self.lines("a/x.00.png", "b/x.00.png")[0]
        a, b = self.values(self.folder / "a/x.00.png"), self.values(self.folder / "b/x.00.png")
        rmse = numpy.sqrt(numpy.mean((a - b) ** 2))
        self.assertGreater(rmse, 0.001)
        self.assertAlmostEqual(said["rmse"], rmse, delta=1e-6)   # single precision
        self.assertAlmostEqual(said["psnr"], -20 * numpy.log10(rmse), delta=1e-3)
        la, lb = (numpy.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4) for v in (a, b))
        self.assertAlmostEqual(said["relmse"] / numpy.mean((la - lb) ** 2 / (la ** 2 + 0.01)), 1, delta=1e-4)
        self.assertAlmostEqual(said["ssim"], self.ssim(a, b), delta=1e-6)

    @staticmethod
    def ssim(a, b):
        """Window by window, weights in full."""
        a, b = (v @ numpy.array([0.2126, 0.7152, 0.0722]) for v in (a, b))
        i = numpy.arange(-5, 6)
        w = numpy.exp(-(i[:, None] ** 2 + i[None, :] ** 2) / (2 * 1.5 ** 2))
        w /= w.sum()
        found = []
        for y in range(a.shape[0] - 10):
            for x in range(a.shape[1] - 10):
                p, q = a[y:y + 11, x:x + 11], b[y:y + 11, x:x + 11]
                mp, mq = (w * p).sum(), (w * q).sum()
                vp, vq, c = (w * (p - mp) ** 2).sum(), (w * (q - mq) ** 2).sum(), (w * (p - mp) * (q - mq)).sum()
                found.append((2 * mp * mq + 1e-4) * (2 * c + 9e-4) / ((mp * mp + mq * mq + 1e-4) * (vp + vq + 9e-4)))
        return numpy.mean(found)


if __name__ == "__main__":
    print("python", sys.version.split()[0])
    program.main()
