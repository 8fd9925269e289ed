#!/usr/bin/env python3
"""What the steps of the quality ladder cost and lose on the sample shots.

  tools/bench/quality.py --kadr BUILD/src/cli/kadr measure    prints the table and writes src/shot/quality_measured.h
  tools/bench/quality.py --kadr BUILD/src/cli/kadr check      the ladder is monotone: each step costs more and errs less

The middle frame of every sample, 64x36, is rendered at every step. Cost: seconds of processor time (user and system, all
threads), less those of the same shot at one pixel and one sample, which are loading and start-up; the least of two or three
runs. The two short steps are timed at six times the width and height, over 36. Error: relMSE of the EXR and FLIP of the
picture on the display, against another seed of `reference`, means of eight seeds of the short steps and two of `final`. Half a
minute of processor time a sample.
"""
import argparse
import json
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from calibration import ROOT, middle_frame

TABLE = ROOT / "src" / "shot" / "quality_measured.h"
STEPS = ("draft", "preview", "final", "reference")
SEEDS = {"draft": 8, "preview": 8, "final": 2, "reference": 1}   # a few fireflies decide the relMSE of few samples
TRUTH_SEED = 77
WIDTH, HEIGHT = 64, 36
LARGER = 6   # a tenth of a second says little
HEADER = """#pragma once

// Written by tools/bench/quality.py: what the steps of the quality ladder cost and lose. Not edited by hand.

#include <array>

namespace kadr {{

inline constexpr const char* kMeasuredSize = "{width}x{height}";

/// One step on one sample shot.
struct MeasuredStep {{
    double cpu_s;   ///< seconds of processor time a frame, less loading
    double relmse;  ///< against another seed of `reference`
    double flip;    ///< of what is seen
}};

/// A sample shot at the steps in the ladder's order.
struct MeasuredShot {{
    const char* name;
    std::array<MeasuredStep, {steps}> steps;
}};

inline constexpr std::array<MeasuredShot, {shots}> kMeasuredShots{{{{
{rows}}}}};

}}  // namespace kadr
"""


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def render(kadr, shot, frame, step, seed, image, size=f"{WIDTH}x{HEIGHT}", more=()):
    """@return seconds of processor time"""
    before = cpu_seconds()
    subprocess.run([str(kadr), "render", str(shot), "--frames", str(frame), "--size", size, "--quality", step, "--set", f"render.seed={{ value: {seed} }}",
                    "--set", "output.aovs=[]", "--output", str(image), "--video", "none", "--overwrite", *more], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return cpu_seconds() - before


def compare(kadr, a, b):
    done = subprocess.run([str(kadr), "compare", str(a), str(b), "--json"], check=True, capture_output=True, text=True)
    return json.loads(done.stdout.splitlines()[0])


def measure_shot(kadr, shot, folder):
    frame = middle_frame(kadr, shot)
    truth = folder / "truth.exr"
    render(kadr, shot, frame, "reference", TRUTH_SEED, truth)
    steps = []
    for step in STEPS:
        image = folder / f"{step}.exr"
        cost = render(kadr, shot, frame, step, 1, image)
        # What else the machine does only adds: the least of several runs, and of more pixels, where a run is short.
        loading = min(render(kadr, shot, frame, step, 1, folder / "dot.exr", "1x1", ("--samples", "1")) for _ in range(3))
        if step in ("draft", "preview"):
            large = f"{LARGER * WIDTH}x{LARGER * HEIGHT}"
            cost = loading + (min(render(kadr, shot, frame, step, 1, folder / "large.exr", large) for _ in range(2)) - loading) / LARGER ** 2
        errors = [compare(kadr, truth, image)]
        for seed in range(2, 1 + SEEDS[step]):
            render(kadr, shot, frame, step, seed, image)
            errors.append(compare(kadr, truth, image))
        steps.append({"cpu_s": max(cost - loading, 0.001), **{figure: statistics.fmean(error[figure] for error in errors) for figure in ("relmse", "flip")}})
    return steps


def text_of(name, steps):
    return f"{name:<12}" + "".join(f"  {step['cpu_s']:>8.3f} {step['relmse']:>9.2e} {step['flip']:>7.4f}" for step in steps)


def samples():
    return [shot for shot in sorted((ROOT / "shots").glob("*.yaml")) if "kadr-reel:" not in shot.read_text()]


def faults(rows):
    """Where a step does not cost more and err less than the one before. Both errors below the noise of the truth are equal."""
    found = []
    for name, steps in rows.items():
        for lower, upper, step in zip(steps, steps[1:], STEPS[1:]):
            if upper["cpu_s"] <= lower["cpu_s"]:
                found.append(f"{name}: {step} costs {upper['cpu_s']:.3f} s, the step before {lower['cpu_s']:.3f} s")
            for figure in ("relmse", "flip"):
                if upper[figure] > lower[figure] or (upper[figure] == lower[figure] and lower[figure] > 0):
                    found.append(f"{name}: {step} errs by {figure} {upper[figure]:.3g}, the step before by {lower[figure]:.3g}")
    return found


def write_table(rows):
    lines = "".join(f"    {{\"{name}\", {{{{" + ", ".join(f"{{{s['cpu_s']:.3g}, {s['relmse']:.3g}, {s['flip']:.3g}}}" for s in steps) + "}}},\n" for name, steps in rows.items())
    TABLE.write_text(HEADER.format(width=WIDTH, height=HEIGHT, steps=len(STEPS), shots=len(rows), rows=lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kadr", required=True, type=pathlib.Path)
    parser.add_argument("--only", help="samples, separated by commas")
    parser.add_argument("what", choices=("measure", "check"))
    options = parser.parse_args()
    kadr = options.kadr.resolve()
    rows = {}
    print(f"{'':<12}" + "".join(f"  {step + ': s, relMSE, FLIP':>26}" for step in STEPS))
    for shot in samples():
        if options.only and shot.stem not in options.only.split(","):
            continue
        with tempfile.TemporaryDirectory() as folder:
            rows[shot.stem] = measure_shot(kadr, shot, pathlib.Path(folder))
        print(text_of(shot.stem, rows[shot.stem]), flush=True)
    medians = [{figure: statistics.median(steps[i][figure] for steps in rows.values()) for figure in ("cpu_s", "relmse", "flip")} for i in range(len(STEPS))]
    print(text_of("median", medians))
    found = faults(rows)
    for fault in found:
        print("not monotone:", fault)
    if options.what == "measure":
        write_table(rows)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
