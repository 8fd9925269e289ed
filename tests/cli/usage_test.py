"""Arguments, help, exit codes and messages."""

import json
import os
import pty
import re
import subprocess
import unittest
from pathlib import Path

import program
from program import ProgramTest

COMMANDS = ["render", "preview", "check", "explain", "describe", "smoke", "info", "devices"]


class Usage(ProgramTest):
    def test_version(self):
        self.assertRegex(self.run_kadr("--version").out, r"^kadr \d+\.\d+\.\d+\n$")

    def test_help_of_every_command_has_an_example(self):
        self.assertIn("Example:\n  kadr render", self.run_kadr("--help").out)
        for command in COMMANDS:
            self.assertIn(f"Example:\n  kadr {command}", self.run_kadr(command, "--help").out)

    def refused(self, *arguments):
        process = self.run_kadr(*arguments, code=2)
        self.assertEqual(process.out, "")
        return process.err

    def test_unknown_command(self):
        self.assertEqual(self.refused("rendr", "a.yaml"), "error: unknown command 'rendr'\n  did you mean 'render'?\n")

    def test_no_command(self):
        self.assertEqual(self.refused(), "error: no command was given\n  expected one of render, preview, check, explain, describe, "
                         "smoke, compare, compare-devices, measure, info, devices, stress; see kadr --help\n")

    def test_unknown_option(self):
        self.assertEqual(self.refused("render", "ball.yaml", "--sampels", "4"),
                         "error: unknown option '--sampels' of kadr render\n  did you mean '--samples'?\n")

    def test_missing_argument(self):
        self.assertEqual(self.refused("render"), "error: SHOT is required\n  see kadr render --help\n")

    def test_size(self):
        self.assertEqual(self.refused("render", "ball.yaml", "--size", "banana"),
                         "error: --size is 'banana'\n  expected WIDTHxHEIGHT in pixels, as in --size 640x360\n")
        self.assertIn("--size is '640x'", self.refused("render", "ball.yaml", "--size", "640x"))
        self.assertIn("--size is '0x10'", self.refused("render", "ball.yaml", "--size", "0x10"))

    def test_numbers(self):
        """Whatever a number is: a refusal that names the option, what was found and what was expected."""
        expected = {"--threads": "a whole number from 1 to 1024, as in --threads 8", "--samples": "a whole number above zero, as in --samples 64",
                    "--exposure": "a number from -100 to 100", "--pixels-per-degree": "a number from 1 to 1000",
                    "--frame": "the number of a frame, as in --frame 42", "--fps": "frames a second, as in --fps 24 or --fps 24000/1001"}
        commands = {"--threads": ["render", "ball.yaml"], "--samples": ["render", "ball.yaml"], "--frame": ["preview", "ball.yaml"]}
        for option, message in expected.items():
            for value in ["nan", "inf", "-inf", "1e400", "1e308", "x", "0x10y", "99999999999999999999"]:
                self.assertEqual(self.refused(*commands.get(option, ["compare", "a.png", "b.png"]), f"{option}={value}"),
                                 f"error: {option} is '{value}'\n  expected {message}\n")
        for value in ["0", "-1", "1025", "2147483647"]:
            self.assertIn(f"--threads is '{value}'", self.refused("smoke", "ball.yaml", f"--threads={value}"))
        for value in ["2147483647", "24/2147483647"]:
            self.assertIn("expected 0.001 to 10000 frames a second", self.refused("compare", "a.png", "b.png", f"--fps={value}"))
        self.assertIn("--set camera.f_stop=.nan: error: camera.f_stop is .nan", self.refused("check", "ball.yaml", "--set", "camera.f_stop=.nan"))

    def test_set(self):
        self.assertEqual(self.refused("render", "ball.yaml", "--set", "samples"),
                         "error: --set is 'samples'\n  expected KEY.PATH=VALUE, as in --set render.samples=16\n")
        self.assertIn("did you mean", self.refused("render", "ball.yaml", "--set", "render.sampels=3"))

    def test_time(self):
        self.assertEqual(self.refused("preview", "ball.yaml", "--time", "soon"),
                         "error: --time is 'soon'\n  expected seconds, as in --time 1.75s\n")

    def test_frame_and_time_exclude_each_other(self):
        self.refused("preview", "ball.yaml", "--time", "1s", "--frame", "2")

    def test_missing_shot(self):
        self.assertIn("nowhere.yaml", self.refused("render", "nowhere.yaml"))

    def test_unusable_device(self):
        gpu = json.loads(self.run_kadr("devices", "--json").out.splitlines()[1])
        if not gpu["usable"]:
            self.assertIn(gpu["reason"], self.refused("render", "ball.yaml", "--device", "hiprt"))
        self.assertIn("gpu", self.refused("render", "ball.yaml", "--device", "gpu"))

    def test_bad_frames(self):
        self.refused("render", "ball.yaml", "--frames", "9-5")

    def test_check_reports_all_shots_and_writes_nothing(self):
        bad = self.write_shot(name="bad.yaml", more="  vidoe: a.mp4\n")
        worse = self.write_shot(name="worse.yaml", more="  png_bit: 3\n")
        before = sorted(self.folder.rglob("*"))
        error = self.refused("check", bad, worse)
        self.assertIn("bad.yaml", error)
        self.assertIn("worse.yaml", error)
        self.assertEqual(self.run_kadr("check", self.shot).out, f"{self.shot}: ok\n")
        self.assertEqual(sorted(self.folder.rglob("*")), before)

    def test_check_verbose_prints_the_timeline(self):
        out = self.run_kadr("check", self.shot, "--verbose").out
        self.assertTrue(out.startswith(f"{self.shot}: ok\ntiming: 3 frames from 0 to 2, 24 a second, frame 0 is at 0 s\n"), out)
        self.assertIn("\n  scenes.ball.transform.rotate.angle   linear           2  0 s (f 0) to 1 s (f 24)\n", out)
        lines = self.run_kadr("check", self.shot, "--verbose", "--json").out.splitlines()
        self.assertEqual(json.loads(lines[0])["text"], out.split("\n", 1)[1])

    def test_describe(self):
        self.assertIn("samples", self.run_kadr("describe", "render.samples").out)
        self.assertGreater(len(self.run_kadr("describe").out.splitlines()), 20)
        self.assertEqual(json.loads(self.run_kadr("describe", "--json-schema").out)["$schema"],
                         "https://json-schema.org/draft/2020-12/schema")
        self.assertIn("did you mean", self.refused("describe", "render.sampels"))

    def test_devices(self):
        lines = [json.loads(line) for line in self.run_kadr("devices", "--json").out.splitlines()]
        devices = {device["name"]: device for device in lines}
        self.assertTrue(devices["cpu"]["usable"])
        self.assertNotEqual(devices["hiprt"]["usable"], bool(devices["hiprt"]["reason"]))
        self.assertIn("cpu", self.run_kadr("devices").out)
        report = json.loads(self.run_kadr("devices", "--verbose", "--json").out.splitlines()[-1])
        self.assertIn(devices["hiprt"]["reason"], report["gpu_needs"][-1])
        self.assertTrue(report["unproven_on_gpu"])
        verbose = self.run_kadr("devices", "--verbose").out
        for line in report["gpu_needs"] + report["unproven_on_gpu"]:
            self.assertIn(line, verbose)
        changelog = (Path(__file__).parents[2] / "CHANGELOG.md").read_text()
        listed = re.search(r"- What no GPU has shown yet .*:\n((?:  - .*\n)+)", changelog).group(1)
        self.assertEqual([line[4:] for line in listed.splitlines()], report["unproven_on_gpu"])

    def test_info(self):
        self.run_kadr("render", self.shot, "--frames", "1")
        lines = dict(line.split(None, 1) for line in self.run_kadr("info", "out/ball.0001.png").out.splitlines())
        self.assertEqual(lines["shot"], "ball")
        self.assertEqual(lines["frame"], "1")
        said = json.loads(self.run_kadr("info", "--json", "out/ball.0001.png").out)
        self.assertEqual(said["samples"], "4")
        self.assertEqual({key: said[key] for key in ("integrator", "bounces", "filter", "motion_tolerance_px", "clamp_direct", "clamp_indirect", "build", "robust",
                                                     "texture_limit_px", "denoise", "seed", "cull_backfaces", "shutter", "view", "fps")},
                         {"integrator": "path", "bounces": "2 (diffuse 2, glossy 2, transmission 2)", "filter": "blackman-harris 1.5 px",
                          "motion_tolerance_px": "0.1", "clamp_direct": "none", "clamp_indirect": "none", "build": "medium", "robust": "auto",
                          "texture_limit_px": "none", "denoise": "none", "seed": "0", "cull_backfaces": "no", "shutter": "0 f to 0.5 f",
                          "view": "srgb, 0 stops", "fps": "24"})
        self.assertNotIn("quality", said)
        self.run_kadr("render", self.shot, "--frames", "1", "--quality", "draft", "--set", "render.texture_limit=512 px")
        said = json.loads(self.run_kadr("info", "--json", "out/ball.0001.png").out)
        self.assertEqual((said["quality"], said["texture_limit_px"]), ("draft", "512"))
        self.refused("info", "ball.gltf")
        self.refused("info", "nowhere.png")

    def test_any_order(self):
        for arguments in (["render", "--samples", "2", "ball.yaml", "--json", "--set", "render.seed=1", "--frames", "0"],
                          ["render", "--set", "render.seed=1", "ball.yaml", "--json", "--frames", "0", "--samples", "2"],
                          ["--json", "--samples=2", "render", "ball.yaml", "--frames", "0", "--set", "render.seed=1"]):
            lines = [json.loads(line) for line in self.run_kadr(*arguments).out.splitlines()]
            self.assertEqual(lines[-1]["frames"], 1)
        self.assertEqual(lines[-1]["reused"], 1, "the same command in another order")

    def test_progress_bar_on_a_terminal_is_erased(self):
        shot = self.write_shot(samples=64, width=160, height=120)
        parent, child = pty.openpty()
        process = subprocess.Popen([program.KADR, "render", str(shot)], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=child, env=self.environment())
        os.close(child)
        shown = b""
        while True:
            try:
                piece = os.read(parent, 4096)
            except OSError:  # the terminal's other end is closed
                break
            if not piece:
                break
            shown += piece
        out = process.communicate()[0].decode()
        os.close(parent)
        self.assertEqual(process.returncode, 0)
        self.assertRegex(shown.decode(), r"frame \d+ \[#*\.*\] +\d+ %  \d+ left  ETA .* MiB")
        self.assertTrue(shown.endswith(b"\r\x1b[K"), shown[-80:])
        self.assertIn("3 frames (0 reused)", out)
        self.assertNotIn("frame 0:", out)


if __name__ == "__main__":
    program.main()
