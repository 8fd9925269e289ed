#!/usr/bin/env python3
"""How true Kadr's estimate of its own noise is, over the sample shots and the peers' scenes.

  tools/bench/calibration.py --kadr BUILD/src/cli/kadr references    makes what is missing of tests/measure/references
  tools/bench/calibration.py --kadr BUILD/src/cli/kadr check         the table; exit code 1 where it is not calibrated

A frame of each, 96×54, is rendered with few samples and several seeds. What it says of its error (relMSE, `kadr info`) is
compared with its difference from a reference of 16384 samples of the same settings (`kadr compare`), whose own noise is below
a hundredth of that. Calibrated: in 90 % of the frames the estimate is within 25 % of the truth, and at
least 90 % of the intervals that are stated as 95 % hold it.

The peers' scenes lie in the folder that KADR_PEERS names (default: ../shared/peers beside the repository); without it they
are left out, and the tool says so.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
REFERENCES = ROOT / "tests" / "measure" / "references"
WIDTH, HEIGHT, REFERENCE_SAMPLES, REFERENCE_SEED = 96, 54, 16384, 77
WITHIN, SHARE = 0.25, 0.9
COVERED = 0.9  # of the intervals of 95 %: of 36 frames three may miss by chance (binomial, p = 0.27) and five hardly (0.03)
PEER_SHOT = """kadr: 1
name: {name}
timing: {{ fps: 24, frames: {frame} }}
scenes: [ {{ id: scene, gltf: "{gltf}" }} ]
camera: {{ gltf: scene/{camera} }}
environment: {{ color: [{background}], strength: 1 }}
render: {{ bounces: {{ total: 4 }} }}
"""


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{command[0]} {command[1]} failed:\n" + "\n".join((done.stdout + done.stderr).splitlines()[-10:]))
    return done.stdout


def middle_frame(kadr, shot):
    """The frame in the middle of a shot, from what `kadr check --verbose` says of it."""
    span = re.search(r"frames from (\d+) to (\d+)", run(kadr, "check", "--verbose", shot))
    return (int(span[1]) + int(span[2])) // 2 if span else 0


def peers(folder):
    base = pathlib.Path(os.environ.get("KADR_PEERS", ROOT.parent / "shared" / "peers")).resolve() / "scenes"
    for name in ("spheres", "cornell", "spin"):
        scene = base / f"{name}.glb"
        if not scene.exists():
            print(f"left out: {name}, for {scene} is not there; set KADR_PEERS")
            continue
        side = json.loads(scene.with_suffix(".json").read_text())
        shot = folder / f"{name}.yaml"
        shot.write_text(PEER_SHOT.format(name=name, frame=12, gltf=scene, camera=side["camera"], background=", ".join(map(str, side["background"]))))
        yield f"peer_{name}", shot, 12


def shots(kadr, folder):
    for shot in sorted((ROOT / "shots").glob("*.yaml")):
        if "kadr-reel:" not in shot.read_text():
            yield shot.stem, shot, middle_frame(kadr, shot)
    yield from peers(folder)


def render(kadr, shot, frame, image, samples, seed):
    run(kadr, "render", shot, "--frames", frame, "--size", f"{WIDTH}x{HEIGHT}", "--samples", samples, "--set", f"render.seed={{ value: {seed} }}",
        "--set", "output.aovs=[]", "--output", image, "--video", "none")


def make_references(options, folder):
    REFERENCES.mkdir(parents=True, exist_ok=True)
    for name, shot, frame in shots(options.kadr, folder):
        image = REFERENCES / f"{name}.exr"
        if not image.exists():
            render(options.kadr, shot, frame, image, REFERENCE_SAMPLES, REFERENCE_SEED)
            print(f"{name}, frame {frame}: {image}", flush=True)


def measure(options, folder):
    rows = []
    for name, shot, frame in shots(options.kadr, folder):
        reference = REFERENCES / f"{name}.exr"
        if not reference.exists():
            sys.exit(f"{reference} is missing; make it with: tools/bench/calibration.py --kadr {options.kadr} references")
        for seed in range(1, options.seeds + 1):
            image = folder / f"{name}.{seed}.exr"
            render(options.kadr, shot, frame, image, options.samples, seed)
            said = json.loads(run(options.kadr, "info", "--json", image))
            compared = json.loads(run(options.kadr, "compare", reference, image, "--json").splitlines()[0])
            low, high = (float(word) for word in said["error_relmse_95"].split(" to "))
            rows.append({"shot": name, "seed": seed, "estimate": float(said["error_relmse"]), "low": low, "high": high, "truth": compared["relmse"]})
    return rows


def verdict(rows):
    """Frames without noise count as right where the estimate says so, too."""
    for row in rows:
        row["ratio"] = row["estimate"] / row["truth"] if row["truth"] > 1e-9 else 1.0 if row["estimate"] < 1e-8 else float("inf")
        row["within"] = abs(row["ratio"] - 1) <= WITHIN
        row["covered"] = row["low"] <= row["truth"] <= row["high"] or row["truth"] <= 1e-9
    return sum(row["within"] for row in rows) / len(rows), sum(row["covered"] for row in rows) / len(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kadr", required=True, type=pathlib.Path)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--output", type=pathlib.Path, help="JSON of every row")
    parser.add_argument("what", choices=("references", "check"))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if options.what == "references":
            return make_references(options, folder)
        rows = measure(options, folder)
    within, covered = verdict(rows)
    for row in rows:
        print(f"{row['shot']:<14} {row['seed']} {row['estimate']:>10.3g} {row['truth']:>10.3g} {row['ratio']:>7.3f} {'' if row['within'] else 'OFF'}")
    print(f"{len(rows)} frames at {options.samples} samples: {100 * within:.0f} % of the estimates within {100 * WITHIN:.0f} % of the truth, "
          f"{100 * covered:.0f} % of the truths in the stated 95 % interval")
    if options.output:
        options.output.write_text(json.dumps({"samples": options.samples, "within": within, "covered": covered, "rows": rows}, indent=2) + "\n")
    sys.exit(0 if within >= SHARE and covered >= COVERED else 1)


if __name__ == "__main__":
    main()
