#!/usr/bin/env python3
"""What it is worth that a shot pays for the kernel code that it uses alone.

  tools/bench/kernel_sets.py --kadr BUILD/src/cli/kadr speed [--only room,pan] [--output FILE.json]
  tools/bench/kernel_sets.py --kadr BUILD/src/cli/kadr unused [--output FILE.json]

speed   The middle frame of every sample, and the peers' scenes, 320x180, on one thread: with the kernel that the frame needs, and with
        the one that can render anything (KADR_KERNEL_SET=all). Seconds of processor time (user and system) less those of the same shot
        at one pixel and one sample, which are start and loading; peak memory; seconds of loading and of building the scene, as kadr
        reports them.
unused  The same shot without a feature, with it but unused (a textured scene that is hidden, a light without strength, a track that
        stands still), and with it in use: an unused one has to cost nothing.

Both sides run in turn, first one, then the other first; the table has the medians of the rounds and of their ratios. The samples of a
pixel are chosen so that a run takes about a second. Needs a machine that does nothing else.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import calibration
from peers import ROOT, SPEED_SCENES, machine, timed, write_shot

SIZE = "320x180"
KINDS = ("needed", "all")
DRAWING = ("render", "--overwrite", "--json", "--threads", "1", "--video", "none", "--set", "output.aovs=[]")


class Side:
    """One way of rendering: a shot's frame and which kernels."""

    def __init__(self, options, shot, frame, kernels, settings=()):
        self.options, self.frame, self.kernels = options, frame, kernels
        self.image = options.folder / "frame.exr"
        self.words = [options.kadr, DRAWING[0], shot, *DRAWING[1:], "--frames", frame, "--output", self.image, *settings]

    def run(self, size, samples):
        """Seconds of processor time, seconds of loading and building, MiB."""
        os.environ["KADR_KERNEL_SET"] = self.kernels
        text, figures = timed([*self.words, "--size", size, "--samples", samples])
        seconds = json.loads(text.splitlines()[-1])["seconds"]
        return {"cpu_s": figures["cpu_s"], "load_s": seconds["load"] + seconds["scene"], "peak_mib": figures["peak_mib"]}

    def measure(self, samples):
        dot, frame = self.run("1x1", 1), self.run(SIZE, samples)
        return {"cpu_s": max(frame["cpu_s"] - dot["cpu_s"], 1e-3), "load_s": dot["load_s"], "peak_mib": frame["peak_mib"]}


def samples_for(side, seconds):
    """How many samples a pixel take about so long."""
    few = 4
    return max(few, round(few * seconds / side.measure(few)["cpu_s"]))


def compare(sides, options):
    """Rounds of all sides in turn. @return [side] of their medians, with `ratio` of the processor time to the last side's"""
    samples = samples_for(sides[-1], options.seconds)
    rounds = []
    for number in range(options.rounds):
        order = list(range(len(sides)))
        row = {i: sides[i].measure(samples) for i in (order if number % 2 == 0 else reversed(order))}
        rounds.append([row[i] for i in order])
    result = []
    for i in range(len(sides)):
        medians = {key: statistics.median(row[i][key] for row in rounds) for key in rounds[0][i]}
        ratios = [row[i]["cpu_s"] / row[-1]["cpu_s"] for row in rounds]
        result.append({**medians, "samples": samples, "ratio": statistics.median(ratios), "ratios": ratios})
    return result


def all_shots(options):
    yield from calibration.shots(options.kadr, options.folder)
    peers = pathlib.Path(os.environ.get("KADR_PEERS", ROOT.parent / "shared" / "peers")).resolve()
    for scene in SPEED_SCENES:
        if (peers / "scenes" / f"{scene}.glb").exists():
            folder = options.folder / "plain"
            folder.mkdir(exist_ok=True)
            yield f"plain_{scene}", write_shot(folder, peers, scene, (640, 360), 64, 4, 0, folder / "frame.exr"), 1


def speed(options):
    report = {}
    print(f"{'shot':22} {'samples':>7} {'CPU s':>8} {'of all':>8} {'ratio':>7} {'spread':>15} {'load s':>7} {'of all':>7} {'MiB':>6} {'of all':>7}")
    for name, shot, frame in all_shots(options):
        if options.only and name not in options.only.split(","):
            continue
        needed, everything = report[name] = compare([Side(options, shot, frame, kernels) for kernels in KINDS], options)
        print(f"{name:22} {needed['samples']:>7} {needed['cpu_s']:>8.3f} {everything['cpu_s']:>8.3f} {needed['ratio']:>7.3f} "
              f"{min(needed['ratios']):>7.3f}-{max(needed['ratios']):<7.3f} {needed['load_s']:>7.3f} {everything['load_s']:>7.3f} "
              f"{needed['peak_mib']:>6.0f} {everything['peak_mib']:>7.0f}", flush=True)
    ratios = [needed["ratio"] for needed, _ in report.values()]
    print(f"median of {len(ratios)} shots: {statistics.median(ratios):.3f}; least {min(ratios):.3f}, most {max(ratios):.3f}")
    return report


SHOT = """kadr: 1
timing: {{ fps: 24, frames: 0 }}
image: {{ size: [320, 180] }}
scenes:
  - {{ id: solids, gltf: "{assets}/solids.glb", transform: {{ scale: {scale} }} }}
  - {{ id: hill, gltf: "{assets}/hill.glb", transform: {{ translate: [0, -1.5, 0] }}, visible: {hill} }}
  - {{ id: robot, gltf: "{assets}/robot.glb", transform: {{ translate: {robot_at} }}, visible: {robot} }}
camera: {{ position: [0, 2, 9], look_at: [0, 0, 0], focal_length: 35 mm{lens} }}
shutter: {{ angle: 180 deg }}
lights:
  - {{ type: directional, illuminance: 3 lux, direction: [-1, -2, -1] }}
{light}
environment: {{ color: [0.3, 0.4, 0.6] }}
render: {{ integrator: path, samples: 16, bounces: {{ total: 4 }}, filter: {{ type: box, width: 1 px }} }}
output: {{ frames: "{folder}/unused.png" }}
"""
PANEL = "  - {{ type: area, luminance: {} nt, size: [1, 1], position: [0, 4, 2], look_at: [0, 0, 0] }}"
PLAIN = {"scale": 1, "hill": "false", "robot": "false", "robot_at": "[0, 0, 0]", "lens": "", "light": ""}
TURNING = "{ keys: { 0 s: [0, 0, 0], 1 s: [1, 0, 0] } }"
# A feature: what of the shot it changes, unused and in use. The plain shot loads all the same files, and hides them.
FEATURES = {
    "an area light": ({"light": PANEL.format(0)}, {"light": PANEL.format(20)}),
    "a textured mesh that moves": ({"robot_at": TURNING}, {"robot": "true", "robot_at": TURNING}),
    "textures": ({}, {"hill": "true"}),
    "a lens": ({"lens": ", focus: 9 m"}, {"lens": ", f_stop: 2, focus: 9 m"}),
    "motion": ({"scale": "{ keys: { 0 s: 1, 1 s: 1 } }"}, {"scale": "{ keys: { 0 s: 1, 1 s: 1.2 } }"}),
}


def unused(options):
    report = {}
    print(f"{'feature':28} {'unused':>8} {'in use':>8}   of the processor time without it")
    for name, changes in FEATURES.items():
        sides = []
        for i, changed in enumerate((*changes, {})):
            shot = options.folder / f"unused{i}.yaml"
            shot.write_text(SHOT.format(**{**PLAIN, **changed}, assets=ROOT / "shots" / "assets", folder=options.folder))
            sides.append(Side(options, shot, 0, "needed"))
        without_use, in_use, _ = report[name] = compare(sides, options)
        print(f"{name:28} {without_use['ratio']:>8.3f} {in_use['ratio']:>8.3f}   unused: {min(without_use['ratios']):.3f} to "
              f"{max(without_use['ratios']):.3f}", flush=True)
    return report


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mode", choices=("speed", "unused"))
    parser.add_argument("--kadr", required=True, type=pathlib.Path)
    parser.add_argument("--only", help="names of the table, separated by commas")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--seconds", type=float, default=1.0, help="of a run")
    parser.add_argument("--output", type=pathlib.Path, help="JSON of every round")
    options = parser.parse_args()
    options.kadr = options.kadr.resolve()
    with tempfile.TemporaryDirectory(prefix="kadr-kernels-") as folder:
        options.folder = pathlib.Path(folder)
        report = {"speed": speed, "unused": unused}[options.mode](options)
    if options.output:
        options.output.write_text(json.dumps({"mode": options.mode, "machine": machine(), "report": report}, indent=1) + "\n")


if __name__ == "__main__":
    main()
