#!/usr/bin/env python3
"""Whether steered frames end at like quality, and in time.

  tools/bench/steering.py --kadr BUILD/src/cli/kadr [--shots pan,turntable,room] [--frames 6] [--budget SECONDS]

Neighbours: consecutive frames from the middle of each shot, 320x180, with a fixed number of samples, with --max-error and
with a budget for all of them. Of each frame the root of its estimated relMSE and its error on the display (`kadr info`); the
figure is the largest ratio of two neighbours, which the eye would see as noise that comes and goes. The budget is the time that
the fixed samples took, or the one given.

Deadlines: frames with --time-budget, alone and beside as many busy processes as there are processors. The figure is how much
of the budget the frames took: at most 1.05 and one pass.
"""
import argparse
import json
import multiprocessing
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from calibration import ROOT, middle_frame

SIZE = "320x180"
STEERED = (("64 samples", ("--samples", "64")), ("--max-error 0.02", ("--samples", "1024", "--max-error", "0.02")), ("a budget for all", None))
BUDGETS_S = (0.5, 2)


def frames_of(kadr, shot, frames, folder, *arguments):
    """What `kadr info` says of each frame."""
    pattern = folder / "{frame:04}.exr"
    subprocess.run([str(kadr), "render", str(shot), "--frames", f"{frames[0]}-{frames[-1]}", "--size", SIZE, "--set", "output.aovs=[]", "--output", str(pattern),
                    "--video", "none", "--overwrite", *arguments], check=True, capture_output=True)
    return [json.loads(subprocess.run([str(kadr), "info", "--json", str(folder / f"{frame:04}.exr")], check=True, capture_output=True, text=True).stdout) for frame in frames]


def largest_step(values):
    return max(max(a, b) / max(min(a, b), 1e-12) for a, b in zip(values, values[1:]))


def neighbours(kadr, shot, count, folder, budget_s=None):
    middle = middle_frame(kadr, shot)
    frames = range(middle, middle + count)
    fixed_s = None
    for name, arguments in STEERED:
        if arguments is None:
            arguments = ("--samples", "4096", "--time-budget-shot", f"{budget_s or max(fixed_s, 1):.2f}s")
        said = frames_of(kadr, shot, frames, folder, *arguments)
        fixed_s = fixed_s or sum(float(each["seconds"]) for each in said)
        relative = [float(each["error_relmse"]) ** 0.5 for each in said]
        display = [float(each["error_display"]) for each in said]
        samples = [float(each["samples_mean"]) for each in said]
        print(f"{shot.stem:<12} {name:<18} relative error {relative[0]:.4f}, neighbours differ by {largest_step(relative):.3f}; on the display {display[0]:.4f}, "
              f"{largest_step(display):.3f}; samples {min(samples):.0f} to {max(samples):.0f}", flush=True)


def spin():
    while True:
        pass


def deadlines(kadr, shot, folder):
    middle = middle_frame(kadr, shot)
    for busy in (0, os.cpu_count()):
        others = [multiprocessing.Process(target=spin, daemon=True) for _ in range(busy)]
        for other in others:
            other.start()
        for budget in BUDGETS_S:
            said = frames_of(kadr, shot, range(middle, middle + 3), folder, "--samples", "65536", "--time-budget", f"{budget}s")
            share = [float(each["seconds"]) / budget for each in said]
            print(f"{shot.stem:<12} {budget} s beside {busy} busy processes: {min(share):.3f} to {max(share):.3f} of the budget, samples "
                  f"{min(float(each['samples_mean']) for each in said):.0f} and more, stopped by {', '.join(sorted({each['stopped_by'] for each in said}))}", flush=True)
        for other in others:
            other.terminate()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kadr", required=True, type=pathlib.Path)
    parser.add_argument("--shots", default="pan,turntable,room")
    parser.add_argument("--frames", type=int, default=6)
    parser.add_argument("--budget", type=float, help="seconds for all frames of a shot")
    options = parser.parse_args()
    kadr = options.kadr.resolve()
    for name in options.shots.split(","):
        with tempfile.TemporaryDirectory() as folder:
            neighbours(kadr, ROOT / "shots" / f"{name}.yaml", options.frames, pathlib.Path(folder), options.budget)
    for name in options.shots.split(","):
        with tempfile.TemporaryDirectory() as folder:
            deadlines(kadr, ROOT / "shots" / f"{name}.yaml", pathlib.Path(folder))


if __name__ == "__main__":
    main()
