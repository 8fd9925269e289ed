"""`kadr preview`: stills, contact sheets, onions, paths and what does not go together."""

import json
import unittest

import program
from program import ProgramTest, png

KINDS = "expected one of --sheet, --onion and --path"
SEVERAL = "several frames are shown: choose them by --frames, as in --frames 0-95"


class Preview(ProgramTest):
    def refused(self, *arguments):
        process = self.run_kadr("preview", self.shot, *arguments, code=2)
        self.assertEqual(process.out, "")
        self.assertEqual(self.frames("*.png"), [])
        return process.err

    def test_conflicts(self):
        for first, second, expected in (
                (["--frame", "1"], ["--time", "1s"], "expected one of them"),
                (["--sheet", "2x2"], ["--onion"], KINDS), (["--sheet", "2x2"], ["--path"], KINDS),
                (["--onion"], ["--path"], KINDS),
                (["--sheet", "2x2"], ["--frame", "1"], SEVERAL), (["--sheet", "2x2"], ["--time", "1s"], SEVERAL),
                (["--onion"], ["--frame", "1"], SEVERAL), (["--onion"], ["--time", "1s"], SEVERAL)):
            self.assertEqual(self.refused(*first, *second),
                             f"error: {first[0]} and {second[0]} exclude each other\n  {expected}\n")

    def test_sheet_sizes(self):
        for text in ("0x3", "4", "4x", "x3", "4x-1", "four", "20x21", "401x1", "100000x100000"):
            self.assertEqual(self.refused("--sheet", text), f"error: --sheet is '{text}'\n"
                             "  expected COLUMNSxROWS, at most 400 tiles, as in --sheet 4x3\n")

    def test_frames_and_from_need_company(self):
        self.assertEqual(self.refused("--frames", "0-2"), "error: --frames stands without --sheet, --onion or --path\n"
                         "  expected --frame N for one frame; `kadr render` renders many\n")
        self.assertEqual(self.refused("--from", "top"), "error: --from stands without --path\n"
                         "  --from says where --path is seen from: --path --from top\n")
        self.assertEqual(self.refused("--path", "--from", "below"),
                         "error: --from is 'below'\n  expected camera, side, top or iso\n")

    def test_bad_frames(self):
        self.assertIn('frames "9-5"', self.refused("--sheet", "2x2", "--frames", "9-5"))

    def test_values_out_of_range_beyond_the_last_frame(self):
        more = "view: { exposure: { keys: { 0 s: 0, 1 s: -100 }, after: continue } }\n"
        fading = self.write_shot(name="fading.yaml", more=more)
        self.run_kadr("preview", fading, "--time", "1.9s")
        for option, value in (("--time", "3s"), ("--frame", "72")):
            process = self.run_kadr("preview", fading, option, value, code=2)
            self.assertIn("error: view.exposure is -302.083 stops at 3.0208 s (frame 72.5)", process.err)
            self.assertIn("expected -200 to 200 stops; the track goes on with its end's slope", process.err)

    def test_output_endings(self):
        self.assertEqual(self.refused("--sheet", "2x2", "--output", "sheet.exr"), "error: --output is 'sheet.exr'\n"
                         "  expected a name that ends in .png or .jpg: it is a picture for people, not linear light\n")
        self.assertEqual(self.refused("--output", "still.bmp"), "error: --output is 'still.bmp'\n"
                         "  expected a name that ends in .png, .jpg or .exr\n")

    def test_sheet(self):
        self.assertRegex(self.run_kadr("preview", self.shot, "--sheet", "2x2").out, r"^sheet: ball\.sheet\.png in [\d.]+ s\n$")
        pixels, texts = png(self.folder / "ball.sheet.png")
        self.assertEqual(len(pixels), (2 * 32 + 3 * 4) * (1 + 3 * (2 * 48 + 3 * 4)))
        said = json.loads(next(text for text in texts.values() if text.startswith('{"kadr"')))["kadr"]
        self.assertEqual((said["preview"], said["frames"]), ("sheet", "0,1,2"))
        self.assertNotIn("settings", said)
        self.assertEqual(self.temporary_files(), [])

    def test_json_names_the_file(self):
        lines = [json.loads(line) for line in
                 self.run_kadr("preview", self.shot, "--onion", "--json", "--output", "o.jpg").out.splitlines()]
        self.assertEqual(lines[-1]["event"], "preview")
        self.assertEqual((lines[-1]["preview"], lines[-1]["frames"], lines[-1]["files"]), ("onion", [0, 1, 2], ["o.jpg"]))
        self.assertTrue((self.folder / "o.jpg").exists())

    def test_path(self):
        out = self.run_kadr("preview", self.shot, "--path", "--frame", "1").out
        self.assertRegex(out, r"^path: ball\.0001\.path\.png in [\d.]+ s\n$")
        self.run_kadr("preview", self.shot, "--path", "--from", "top", "--time", "0.04s", "--frames", "0-1")
        self.assertEqual(self.frames("*.png"), ["ball.0001.path-top.png", "ball.0001.path.png"])
        still = self.write_shot(name="still.yaml", more="").read_text().replace("1 s: 360 deg", "1 s: 0 deg")
        (self.folder / "still.yaml").write_text(still)
        self.assertIn("\n  nothing moves during these frames\n", self.run_kadr("preview", "still.yaml", "--path").out)

    def test_a_sheet_is_no_frame(self):
        self.run_kadr("preview", self.shot, "--sheet", "1x1", "--size", "48x32", "--output", "out/ball.0000.png")
        summary = json.loads(self.run_kadr("render", self.shot, "--frames", "0", "--json").out.splitlines()[-1])
        self.assertEqual(summary["reused"], 0)

    def test_help_has_an_example_of_each(self):
        text = self.run_kadr("preview", "--help").out
        for option in ("--frame 42", "--sheet 4x3", "--onion --frames", "--path --frame", "--path --from top"):
            self.assertIn(option, text)


if __name__ == "__main__":
    program.main()
