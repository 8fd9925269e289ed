"""Reels from outside: one video with a cross-fade and sound, resume, kill, interrupt, and what the options do to them."""

import json
import math
import shutil
import signal
import struct
import subprocess
import time
import unittest
import wave

import program
from program import ProgramTest, png

REEL = """kadr-reel: 1
name: show
shots:
  - {{ shot: one.yaml, fade_in: {{ from: [0, 0.5, 1], duration: 1 f }}, crossfade: 4 f }}
  - {{ shot: two.yaml, in: 1 f, hold: 2 f }}
sound: {{ file: tone.wav, gain: -6 dB, loop: true }}
output:
  video: {{ file: {video} }}
  shots: "out/{{shot}}.{{frame:04}}.png"
"""


def write_tone(path):
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, 48000, 0, "NONE", ""))
        file.writeframes(b"".join(struct.pack("<h", int(16000 * math.sin(i * 0.0576))) for i in range(4800)))


@unittest.skipUnless(shutil.which("ffmpeg") and shutil.which("ffprobe"), "ffmpeg and ffprobe are not on the PATH")
class Reel(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write_shot(last=7, name="one.yaml")
        self.write_shot(last=7, name="two.yaml")
        for name, color in (("one", "0.2, 0.3, 0.4"), ("two", "0.9, 0.3, 0.1")):
            path = self.folder / f"{name}.yaml"
            path.write_text(path.read_text().replace("name: ball", f"name: {name}").replace("0.2, 0.3, 0.4", color))
        write_tone(self.folder / "tone.wav")
        self.reel = self.write_reel("out/show.mkv, codec: ffv1")

    def write_reel(self, video):
        path = self.folder / "reel.yaml"
        path.write_text(REEL.format(video=video))
        return path

    def probed(self, name, stream):
        text = subprocess.run(["ffprobe", "-v", "error", "-count_packets", "-select_streams", stream, "-show_streams", "-show_format",
                               "-of", "json", str(self.folder / name)], check=True, capture_output=True, text=True).stdout
        found = json.loads(text)
        self.assertEqual(len(found["streams"]), 1, stream)
        return {**found["streams"][0], "seconds": float(found["format"]["duration"])}

    def picture(self, name, frame):
        """R, G, B bytes of one frame of a video."""
        return subprocess.run(["ffmpeg", "-v", "error", "-i", str(self.folder / name), "-vf", f"select=eq(n\\,{frame})", "-frames:v", "1",
                               "-f", "rawvideo", "-pix_fmt", "rgb24", "-"], check=True, capture_output=True).stdout

    def image(self, name):
        """R, G, B bytes of an image file."""
        return subprocess.run(["ffmpeg", "-v", "error", "-i", str(self.folder / name), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                              check=True, capture_output=True).stdout

    def summary(self, *arguments):
        return json.loads(self.run_kadr("render", self.reel, "--json", *arguments).out.splitlines()[-1])

    def test_video(self):
        out = self.run_kadr("render", self.reel).out
        self.assertRegex(out, r"(?m)^shot 1 of 2: one, 8 frames$")
        self.assertRegex(out, r"(?m)^one frame 3: .*out/one\.0003\.png in [\d.]+ s$")
        self.assertRegex(out, r"(?m)^reel: 2 shots, 13 frames, 0\.54 s$")
        video = self.probed("out/show.mkv", "v:0")
        # 8 + (7 + 2) - 4 frames.
        self.assertEqual(video["nb_read_packets"], "13")
        self.assertEqual(video["r_frame_rate"], "24/1")
        self.assertAlmostEqual(video["seconds"], 13 / 24, delta=0.001)   # Matroska counts milliseconds
        sound = self.probed("out/show.mkv", "a:0")
        self.assertEqual(sound["codec_name"], "flac")
        self.assertEqual(sound["sample_rate"], "48000")

    def test_pixels(self):
        self.run_kadr("render", self.reel)
        self.assertEqual(self.picture("out/show.mkv", 2), self.image("out/one.0002.png"), "no transition: the shot's own pixels")
        # Reel frame 5 is the second of four of the cross-fade: 5/8 of frame 5 of one, 3/8 of frame 2 of two.
        mixed = self.picture("out/show.mkv", 5)
        from_, to = self.image("out/one.0005.png"), self.image("out/two.0002.png")
        self.assertEqual(len(mixed), 48 * 32 * 3)
        self.assertGreater(max(abs(a - b) for a, b in zip(from_, to)), 20, "there is something to mix")
        # Half a step of rounding, and floats on the way.
        self.assertLessEqual(max(abs(m - (5 * a + 3 * b) / 8) for m, a, b in zip(mixed, from_, to)), 0.501)
        # The fade of one frame is half of the colour.
        faded, whole = self.picture("out/show.mkv", 0), self.image("out/one.0000.png")
        color = (0, 127.5, 255)
        self.assertLessEqual(max(abs(f - (w + color[i % 3]) / 2) for i, (f, w) in enumerate(zip(faded, whole))), 0.501)
        for frame in (10, 11, 12):
            self.assertEqual(self.picture("out/show.mkv", frame), self.image("out/two.0007.png"), "held")

    def test_usual_container(self):
        self.write_reel("out/show.mp4")
        self.run_kadr("render", self.reel)
        self.assertEqual(self.probed("out/show.mp4", "v:0")["nb_read_packets"], "13")
        sound = self.probed("out/show.mp4", "a:0")
        self.assertEqual(sound["codec_name"], "aac")
        self.assertAlmostEqual(float(sound["duration"]), 13 / 24, delta=1 / 48)

    def test_resume(self):
        self.run_kadr("render", "one.yaml")
        self.assertEqual(self.summary()["reused"], 8, "the frames of the shot are those of the reel")
        first = (self.folder / "out/show.mkv").read_bytes()
        again = self.summary()
        self.assertEqual((again["reused"], again["frames"], again["shots"], again["reel_frames"]), (15, 15, 2, 13))
        self.assertEqual((self.folder / "out/show.mkv").read_bytes(), first)
        path = self.folder / "two.yaml"
        path.write_text(path.read_text().replace("60 cd", "50 cd"))
        self.assertEqual(self.summary()["reused"], 8)
        self.assertEqual(self.summary("--overwrite")["reused"], 0)

    def test_options(self):
        self.run_kadr("render", self.reel, "--frames", "4-7", "--size", "24x16", "--samples", "2", "--set", "render.bounces=1",
                      "--video", "draft.mkv", "--output", "frames/{name}.{frame:02}.png")
        self.assertEqual(self.frames("frames/*.png"), [f"show.{i:02}.png" for i in range(4, 8)])
        self.assertEqual(self.probed("draft.mkv", "v:0")["width"], 24)
        self.assertEqual(self.probed("draft.mkv", "v:0")["nb_read_packets"], "4")
        self.assertEqual(self.frames(), [f"one.{i:04}.png" for i in range(4, 8)] + [f"two.{i:04}.png" for i in range(1, 5)])
        self.assertIn('"2"', json.dumps(json.loads(self.run_kadr("info", "out/one.0004.png", "--json").out)["samples"]))
        error = self.run_kadr("render", self.reel, "--frames", "13", code=2).err
        self.assertEqual(error, "error: --frames is 13\n  expected frames of the reel, which has 0 to 12\n")

    def test_rate_of_its_own(self):
        self.run_kadr("render", self.reel, "--set", "reel.fps=30000/1001")
        self.assertEqual(self.probed("out/show.mkv", "v:0")["r_frame_rate"], "30000/1001")
        # 8 frames at 24 fps are 1/3 s: 9.99 frames.
        self.assertEqual(self.probed("out/show.mkv", "v:0")["nb_read_packets"], str(10 + 9 + 2 - 4))

    def test_check(self):
        self.assertEqual(self.run_kadr("check", self.reel, "one.yaml").out, f"{self.reel}: ok\none.yaml: ok\n")
        self.assertIn("reel show: 13 frames, 0.542 s at 24 fps, 48x32\n", self.run_kadr("check", "--verbose", self.reel).out)
        self.assertFalse((self.folder / "out").exists())
        (self.folder / "tone.wav").write_text("no sound")
        self.assertIn("error: the sound 'tone.wav' cannot be read", self.run_kadr("check", self.reel, code=2).err)

    def test_smoke_and_preview(self):
        self.assertRegex(self.run_kadr("smoke", self.reel).out, r"^skip   .*reel\.yaml: a reel")
        self.assertIn("is a reel, and preview takes a shot", self.run_kadr("preview", self.reel, "--frame", "3", code=2).err)

    def test_describe(self):
        self.assertIn("crossfade", self.run_kadr("describe", "reel.shots").out)
        self.assertEqual(json.loads(self.run_kadr("describe", "reel", "--json-schema").out)["required"], ["kadr-reel", "shots"])

    def wait_for_frames(self, process, count):
        deadline = time.monotonic() + 60
        while len(self.frames()) < count:
            self.assertIsNone(process.poll(), "ended before it could be stopped")
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.005)

    def slow(self):
        return ("--samples", "200")

    def test_kill_and_resume(self):
        self.run_kadr("render", self.reel, *self.slow())
        expected = {path.name: png(path)[0] for path in (self.folder / "out").glob("*.png")}
        video = (self.folder / "out/show.mkv").read_bytes()
        for path in (self.folder / "out").iterdir():
            path.unlink()
        process = self.start("render", self.reel, *self.slow())
        self.wait_for_frames(process, 10)
        process.kill()
        process.communicate()
        complete = len(self.frames())
        self.assertLess(complete, 15)
        self.assertFalse((self.folder / "out/show.mkv").exists())
        self.assertEqual(self.summary(*self.slow())["reused"], complete)
        self.assertEqual({path.name: png(path)[0] for path in (self.folder / "out").glob("*.png")}, expected)
        self.assertEqual((self.folder / "out/show.mkv").read_bytes(), video)
        self.assertEqual(self.temporary_files(), [])

    def test_interrupt(self):
        process = self.start("render", self.reel, *self.slow())
        self.wait_for_frames(process, 9)
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assertEqual(error, "interrupted: complete frames stay, and the same command goes on from there\n")
        self.assertEqual(self.temporary_files(), [])
        self.assertFalse((self.folder / "out/show.mkv").exists())


if __name__ == "__main__":
    program.main()
