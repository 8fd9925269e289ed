"""Frames and videos from outside: resume, kill, interrupt, determinism, smoke, installation."""

import json
import os
import signal
import subprocess
import time
import unittest
from pathlib import Path

import program
from program import ProgramTest, png, texts_but_seconds

SLOW = dict(last=15, samples=24, width=160, height=120)


class Render(ProgramTest):
    def test_plain_lines_and_summary(self):
        out = self.run_kadr("render", self.shot).out
        self.assertRegex(out, r"(?m)^frame 0: .*out/ball\.0000\.png in [\d.]+ s$")
        self.assertRegex(out, r"3 frames \(0 reused\) in [\d.]+ s: load [\d.]+ s, scene [\d.]+ s, trace [\d.]+ s")
        self.assertRegex(out, r"million samples/s, peak memory \d+ MiB")
        self.assertRegex(out, r"(?m)^device: cpu .*; .+$")
        self.assertEqual(self.frames(), ["ball.0000.png", "ball.0001.png", "ball.0002.png"])

    def test_stats(self):
        self.assertRegex(self.run_kadr("render", self.shot, "--frames", "0", "--stats").out, r"  rays [1-9]\d*, samples 6144, ")

    def test_json_lines(self):
        lines = [json.loads(line) for line in self.run_kadr("render", self.shot, "--json").out.splitlines()]
        self.assertEqual([line["frame"] for line in lines if line["event"] == "frame"], [0, 1, 2])
        self.assertEqual(lines[-1]["event"], "summary")
        self.assertEqual(lines[-1]["pixel_samples"], 3 * 48 * 32 * 4)

    def summary(self, *arguments):
        return json.loads(self.run_kadr("render", *arguments, "--json").out.splitlines()[-1])

    def test_resume(self):
        self.assertEqual(self.summary(self.shot)["reused"], 0)
        self.assertEqual(self.summary(self.shot)["reused"], 3)
        self.assertEqual(self.summary(self.shot, "--samples", "5")["reused"], 0)
        self.assertEqual(self.summary(self.shot, "--samples", "5", "--overwrite")["reused"], 0)
        self.assertEqual(self.summary(self.shot, "--samples", "5", "--threads", "1", "--frames", "1-2")["reused"], 2)
        self.shot.write_text("# a comment\n" + self.shot.read_text())
        self.assertEqual(self.summary(self.shot, "--samples", "5")["reused"], 3)
        (self.folder / "ball.gltf").write_text((self.folder / "ball.gltf").read_text() + "\n")
        self.assertEqual(self.summary(self.shot, "--samples", "5")["reused"], 0)

    def test_a_steered_frame_is_not_taken_for_a_full_one(self):
        self.assertNotIn("samples", self.summary(self.shot, "--time-budget-shot", "1s")["stopped_by"])
        self.assertEqual(self.summary(self.shot)["reused"], 0)
        self.assertEqual(self.summary(self.shot, "--max-error", "0.5")["reused"], 0)

    def test_determinism(self):
        patterns = {threads: f"t{threads}/{{name}}.{{frame:04}}.png" for threads in (1, 2, 7)}
        for threads, pattern in patterns.items():
            self.run_kadr("render", self.shot, "--threads", threads, "--output", pattern)
        self.run_kadr("render", self.shot, "--frames", "1", "--output", "alone/{name}.{frame:04}.png")
        for other in (self.folder / "t2", self.folder / "t7"):
            for name in self.frames("t1/*.png"):
                self.assertEqual(png(self.folder / "t1" / name)[0], png(other / name)[0], f"{other}/{name}")
                self.assertEqual(texts_but_seconds(self.folder / "t1" / name), texts_but_seconds(other / name))
        alone, ranged = self.folder / "alone/ball.0001.png", self.folder / "t1/ball.0001.png"
        self.assertEqual(png(alone)[0], png(ranged)[0])
        self.assertEqual(texts_but_seconds(alone), texts_but_seconds(ranged))
        self.assertNotEqual(png(ranged)[0], png(self.folder / "t1/ball.0002.png")[0], "the ball turns")
        self.assertTrue(any("settings" in value for value in texts_but_seconds(alone).values()), "metadata is there to compare")

    def test_works_from_any_folder(self):
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir()
        self.run_kadr("render", "../ball.yaml", "--frames", "0", cwd=elsewhere)
        self.assertEqual(self.frames(), ["ball.0000.png"], "patterns of the file are relative to the file")
        self.run_kadr("render", "../ball.yaml", "--frames", "0", "--output", "mine.{frame}.png", cwd=elsewhere)
        self.assertEqual(self.frames("elsewhere/*.png"), ["mine.0.png"])

    def test_a_denoiser_that_is_missing_is_said_at_its_key_before_anything_is_written(self):
        self.shot.write_text(self.shot.read_text().replace("samples: 4,", "samples: 4, denoise: oidn,"))
        line = 1 + self.shot.read_text().splitlines().index("render: { integrator: path, samples: 4, denoise: oidn, bounces: { total: 2 } }")
        for command in ("render", "preview", "check"):
            process = self.run_kadr(command, self.shot, code=2)
            self.assertRegex(process.err, rf"^ball.yaml:{line}:\d+: error: cannot open the denoiser: /nowhere/libOpenImageDenoise.so.2: .*\n"
                                          r"(?s:.*)  install Open Image Denoise 2 \(pip install pyoidn brings it\), or set KADR_OIDN_LIBRARY to its "
                                          r"libOpenImageDenoise.so.2; or use render.denoise: none")
        self.assertEqual(list(self.folder.glob("out*")), [])
        self.assertFalse({row["name"]: row for row in map(json.loads, self.run_kadr("devices", "--json").out.splitlines())}["oidn"]["usable"])

    def test_a_denoiser_gets_albedo_and_normals_and_leaves_only_what_was_asked_for(self):
        # Stands in for the library: color + 2 albedo + 3 normal, so without its guides the picture would stay as it is.
        self.denoiser = str(Path(program.BUILD) / "tests" / "denoise" / "libfake_oidn.so")
        self.run_kadr("render", self.shot, "--frames", "0")
        plain = png(self.folder / "out" / "ball.0000.png")[0]
        self.run_kadr("render", self.shot, "--frames", "0", "--set", "render.denoise=oidn")
        self.assertNotEqual(plain, png(self.folder / "out" / "ball.0000.png")[0])
        self.assertEqual(json.loads(self.run_kadr("info", "--json", "out/ball.0000.png").out)["denoise"], "oidn 2.3.4")

    @unittest.skipUnless(os.environ.get("KADR_TEST_OIDN_LIBRARY"), "KADR_TEST_OIDN_LIBRARY names no libOpenImageDenoise.so.2")
    def test_denoised_frames_are_others_and_say_so(self):
        self.denoiser = os.environ["KADR_TEST_OIDN_LIBRARY"]
        self.run_kadr("render", self.shot, "--frames", "0")
        frame = self.folder / "out" / "ball.0000.png"
        said = lambda: json.loads(self.run_kadr("info", "--json", frame).out)["denoise"]
        plain = png(frame)[0]
        self.assertEqual(said(), "none")
        self.assertEqual(self.summary(self.shot, "--frames", "0", "--set", "render.denoise=oidn")["reused"], 0)
        self.assertRegex(said(), r"^oidn 2\.\d+\.\d+$")
        self.assertNotEqual(plain, png(frame)[0])

    def test_unwritable_folder(self):
        (self.folder / "file").write_text("not a folder")
        error = self.run_kadr("render", self.shot, "--output", "file/a.{frame}.png", code=1).err
        self.assertEqual(error, f"error: cannot write to the folder {self.folder.resolve()}/file: "
                         f"{self.folder.resolve()}/file is not a folder\n")

    def test_full_disk(self):
        # A small file-size limit stands for a full disk: the write fails half-way.
        error = self.run_kadr("render", self.shot, code=1, preexec_fn=limit_file_size).err
        self.assertIn("error: ", error)
        self.assertEqual(self.frames(), [])
        self.assertEqual(self.temporary_files(), [])

    def test_preview(self):
        out = self.run_kadr("preview", self.shot, "--frame", "2").out
        self.assertRegex(out, r"^.*ball\.0002\.preview\.png.* in [\d.]+ s\n$")
        self.run_kadr("preview", "--output", "still.png", "--size", "32x16", self.shot, "--time", "0.05s")
        self.assertEqual(self.frames("*.png"), ["ball.0002.preview.png", "still.png"])

    def test_smoke(self):
        out = self.run_kadr("smoke", self.shot, "--junit", "smoke.xml").out
        self.assertEqual(out.count("ok     ball frame"), 3)
        self.assertIn('tests="3" failures="0"', (self.folder / "smoke.xml").read_text())
        self.run_kadr("smoke", self.shot, "--update")
        self.assertEqual(self.frames("golden/*.png"), ["ball.0000.png", "ball.0001.png", "ball.0002.png"])
        self.assertEqual(self.run_kadr("smoke", self.shot).out.count(", FLIP 0.0000 of"), 3)
        self.shot.write_text(self.shot.read_text().replace("60 cd", "600 cd"))
        self.assertIn("mean FLIP", self.run_kadr("smoke", self.shot, code=1).out)
        self.shot.write_text(self.shot.read_text().replace("600 cd", "0 cd").replace("strength: 1", "strength: 0"))
        self.assertIn("the image is black", self.run_kadr("smoke", self.shot, code=1).out)
        self.run_kadr("smoke", self.shot, "nowhere.yaml", code=2)

    def test_installed(self):
        prefix = self.folder / "installed"
        subprocess.run([program.CMAKE, "--install", program.BUILD, "--prefix", str(prefix)], check=True,
                       stdout=subprocess.DEVNULL)
        built = program.KADR
        program.KADR = str(prefix / "bin" / "kadr")
        try:
            self.run_kadr("render", self.shot, "--frames", "0")
        finally:
            program.KADR = built
        self.assertTrue(list((prefix / "lib" / "kadr").iterdir()))

    def test_starts_without_the_image_library(self):
        linked = subprocess.run(["ldd", program.KADR], capture_output=True, text=True).stdout
        self.assertIn("libembree", linked)
        self.assertNotIn("libOpenImageIO", linked)


def limit_file_size():
    import resource
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (512, 512))


class Interrupted(ProgramTest):
    VIDEO = "  video: { file: out/ball.mp4 }\n"

    def wait_for_frames(self, process, count):
        deadline = time.monotonic() + 60
        while len(self.frames()) < count:
            self.assertIsNone(process.poll(), "ended before it could be interrupted")
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.005)

    def test_kill_and_resume(self):
        whole = self.write_shot(**SLOW, more=self.VIDEO)
        self.run_kadr("render", whole, "--overwrite")
        expected = (self.folder / "out/ball.mp4").read_bytes()
        for path in (self.folder / "out").iterdir():
            path.unlink()
        process = self.start("render", whole)
        self.wait_for_frames(process, 4)
        process.kill()
        process.communicate()
        complete = self.frames()
        self.assertLess(len(complete), 16)
        self.assertFalse((self.folder / "out/ball.mp4").exists())
        summary = json.loads(self.run_kadr("render", whole, "--json").out.splitlines()[-1])
        self.assertEqual(summary["reused"], len(complete))
        self.assertEqual((self.folder / "out/ball.mp4").read_bytes(), expected)
        self.assertEqual(self.temporary_files(), [], "the next run removes what dead runs left")

    def interrupt(self, signal_number):
        process = self.start("render", self.write_shot(**SLOW, more=self.VIDEO))
        self.wait_for_frames(process, 2)
        process.send_signal(signal_number)
        asked = time.monotonic()
        _, error = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assertEqual(error, "interrupted: complete frames stay, and the same command goes on from there\n")
        self.assertLess(time.monotonic() - asked, 5)
        self.assertEqual(self.temporary_files(), [])
        self.assertFalse((self.folder / "out/ball.mp4").exists())
        for name in self.frames():
            png(self.folder / "out" / name)

    def test_control_c(self):
        self.interrupt(signal.SIGINT)

    def test_terminate(self):
        self.interrupt(signal.SIGTERM)


if __name__ == "__main__":
    program.main()
