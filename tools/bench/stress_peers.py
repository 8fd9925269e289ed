#!/usr/bin/env python3
"""Where Cycles stops being right and where Kadr does: the generated shots of `kadr stress` by both.

  python3.11 -m venv VENV && VENV/bin/pip install bpy==5.0.1 "numpy<2" OpenImageIO pyyaml
  apt-get install libxi6 libxxf86vm1 libxfixes3 libxrender1 libgl1 libsm6 libice6 libxkbcommon0 libegl1
  BUILD/src/cli/kadr stress --quick --output STRESS
  VENV/bin/python tools/bench/stress_peers.py STRESS --kadr BUILD/src/cli/kadr --output table.md --sheet sheet.png

STRESS is the folder of a sweep (several may be given): its report.json names the cells and says what Kadr's pictures are off from a reference in double. Both
renderers get 256 samples a pixel, a box filter, 8 bounces, the shutter of the shot and 60 s of processor time. Differences are of averages of
4×4 pixels on an sRGB display, at the shot's exposure, in steps of 1/255, so that noise hardly counts: their mean, and the number of blocks beyond 16 steps.

A picture is judged
  self   where it is not to change along the axis: against the same renderer's picture at the axis' ordinary value,
  limit  where it settles towards an end of the axis: against the same renderer's picture at a value close to that end (SETTLED),
  other  elsewhere: Kadr by the sweep's reference in double, Cycles against Kadr.
Subtracted is what says nothing of the value: for self and limit the difference of two seeds at the ordinary value, for other the difference of
the renderers there, as their materials and spots are not the same. Wrong: a mean beyond 1 step, or a block beyond 16 steps more than there;
unknown where the picture that it is held against is wrong itself, drawn where nothing is known of it.
Pictures already in --work are kept, so that a second run only judges.
"""
import argparse
import collections
import dataclasses
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import threading

import yaml

import stress_pictures as pictures

HERE = pathlib.Path(__file__).resolve().parent
RENDERERS = ("kadr", "cycles")
CPU_LIMIT_S, WALL_LIMIT_S = 60, 600
MOST_PIXELS = 256 * 256
MEAN_LIMIT = 1.0            # steps, as `kadr stress` has it
BLACK = 1 / pictures.STEPS  # mean of a display value
OTHER_SEED = 7

# Axis: (value, whether the picture stays from there on upwards or downwards). By less than a step: a lens of 1000 times the subject's size
# differs from a parallel one by 1e-3 of the picture; a gap or a shell of 1e-3 of the ball by 0.03 pixels; and so on.
SETTLED = {"telephoto": (1e3, "up"), "authored_telephoto": (1e3, "up"), "thickness": (1e-3, "down"), "gap": (1e-4, "near"), "elevation": (1e-4, "down"), "roughness": (1e-4, "down"), "sun_diameter": (1e-3, "down"),
           "spot_edge": (1e-3, "down"), "area_side": (1e-3, "down"), "travel": (1e-3, "down"), "turn": (1e-6, "down"), "clip_turn": (1e-6, "down"), "shrink": (1e-3, "down"),
           "clip_shrink": (1e-3, "down"), "range": (1e3, "up")}
# What the two define differently, so that pictures of another value than the ordinary one say nothing about errors.
NOT_COMPARABLE = {"spot_edge"}


@dataclasses.dataclass
class Run:
    """What became of a renderer's process."""
    said: str = ""          # why there is no picture, or what is odd about it
    picture: object = None  # as shown; absent: none
    cpu_s: float = 0
    peak_mib: float = 0


def limit_cpu():
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_LIMIT_S, CPU_LIMIT_S + 1))


def run(command):
    """@return exit code (negative: signal), standard output, standard error, resource usage"""
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        child = subprocess.Popen([str(x) for x in command], stdout=out, stderr=err, preexec_fn=limit_cpu)
        alarm = threading.Timer(WALL_LIMIT_S, child.kill)
        alarm.start()
        _, status, usage = os.wait4(child.pid, 0)
        alarm.cancel()
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0), err.seek(0)
        return child.returncode, out.read(), err.read(), usage


def command_of(options, renderer, shot, image, seed):
    if renderer == "kadr":
        return [options.kadr, "render", shot, "--overwrite", "--samples", options.samples, "--threads", options.threads, "--output", image, "--set", "render.filter.type=box",
                "--set", "render.bounces=8", "--set", f"render.seed={seed}", "--set", "output.png_bits=16", "--video", "none"]
    return [sys.executable, HERE / "stress_cycles.py", shot, "--samples", options.samples, "--threads", options.threads, "--image", image, "--seed", seed]


def last_json(text):
    lines = [line for line in text.splitlines() if line.startswith("{")]
    return json.loads(lines[-1]) if lines else {}


def first_error(text):
    return next((line.split("error: ")[-1] for line in text.splitlines() if "error: " in line or "Error: " in line), text.strip()[-200:])


def warnings_of(text):
    return [line.split("warning: ")[-1] for line in text.splitlines() if "warning: " in line]


def outcome(renderer, code, out, err, cpu_s):
    """Text for a process that left no picture, or the notes of one that did."""
    if code == 0:
        return "; ".join(last_json(out).get("notes", []) if renderer == "cycles" else warnings_of(err))
    if renderer == "kadr" and code == 2:
        return "refused: " + first_error(err)
    if renderer == "cycles" and code == 3:
        return "cannot be said: " + last_json(out)["inexpressible"]
    if cpu_s >= CPU_LIMIT_S or code == -9:
        return "beyond the time limit"
    return f"died of signal {-code}" if code < 0 else f"failed: {first_error(err)}"


def fresh_run(options, renderer, shot, image, seed):
    image.unlink(missing_ok=True)
    code, out, err, usage = run(command_of(options, renderer, shot, image, seed))
    cpu_s = usage.ru_utime + usage.ru_stime
    said = outcome(renderer, code, out, err, cpu_s)
    return {"ended": code == 0 and image.exists(), "said": said or ("" if image.exists() else "ended without a picture"), "cpu_s": cpu_s, "peak_mib": usage.ru_maxrss / 1024}


def rendered(options, renderer, shot, seed=0):
    """@return Run"""
    # Kadr's EXR files hold half floats: its own display values are asked for. Cycles' files hold floats.
    image = options.work / f"{shot.stem}.{renderer}.{seed}.{'png' if renderer == 'kadr' else 'exr'}"
    record = image.with_suffix(".json")
    if not record.exists():
        record.write_text(json.dumps(fresh_run(options, renderer, shot, image, seed)))
        print(f"  {image.stem} {record.read_text()}", file=sys.stderr)
    known = json.loads(record.read_text())
    result = Run(known["said"], None, known["cpu_s"], known["peak_mib"])
    if known["ended"]:
        result.picture = pictures.read(image)
        if renderer == "cycles":
            show_linear(result, float(yaml.safe_load(shot.read_text())["view"]["exposure"]))
    return result


def show_linear(result, exposure_stops):
    odd = pictures.not_finite(result.picture)
    result.picture = pictures.shown(result.picture, exposure_stops)
    result.said = "; ".join(text for text in (result.said, f"{odd} values are not finite" if odd else "") if text)


def settled_from(axis, value):
    """The value whose picture this one is to have, or None."""
    end, side = SETTLED.get(axis, (None, None))
    if end is None or value == end:
        return None
    return end if {"up": value > end, "down": value < end, "near": abs(value) < abs(end)}[side] else None


@dataclasses.dataclass
class Judged:
    """Of one renderer in one cell."""
    mean: float | None = None   # steps, after subtraction
    bad_blocks: int = 0
    verdict: str = ""           # right, wrong, or why there is none


def judge(is_now, wanted, baseline):
    if is_now is None or wanted is None or is_now.shape != wanted.shape:
        return Judged(verdict="")
    off = pictures.difference(is_now, wanted)
    mean, bad = max(0.0, off.mean - baseline.mean), max(0, off.bad_blocks - baseline.bad_blocks)
    return Judged(mean, bad, "wrong" if mean > MEAN_LIMIT or bad else "right")


def cells_of(folder):
    """Of its report, with the shot's place instead of its name."""
    return [{**cell, "shot": folder.resolve() / cell["shot"]} for cell in json.loads((folder / "report.json").read_text())]


class Sweep:
    """The cells of reports, and their pictures as they are asked for."""

    def __init__(self, options):
        self.options = options
        by_name = {}
        for cell in (cell for folder in options.sweeps for cell in cells_of(folder)):
            by_name.setdefault(cell["cell"], cell)
        self.by_value = {(c["axis"], c["value"]): c for c in by_name.values() if "second" not in c}
        chosen = [c for c in by_name.values() if not options.axes or c["axis"] in options.axes]
        axes = list(dict.fromkeys(c["axis"] for c in chosen))
        self.cells = sorted(chosen, key=lambda c: ("second" in c, axes.index(c["axis"]), c["value"], c.get("second_value", 0)))
        self.runs = {}

    def run(self, cell, renderer, seed=0):
        key = (cell["cell"], renderer, seed)
        if key not in self.runs:
            self.runs[key] = rendered(self.options, renderer, cell["shot"], seed)
        return self.runs[key]

    def picture(self, cell, renderer, seed=0):
        return self.run(cell, renderer, seed).picture if cell else None

    def ordinary(self, cell):
        return self.by_value.get((cell["axis"], cell["ordinary"]))

    def noise(self, cell, renderer):
        """Of two seeds at the ordinary value."""
        ordinary = self.ordinary(cell)
        return self.between(self.picture(ordinary, renderer), self.picture(ordinary, renderer, OTHER_SEED))

    def between(self, a, b):
        return pictures.difference(a, b) if a is not None and b is not None and a.shape == b.shape else pictures.Difference(0, 0, 0, 1)

    def own_reference(self, cell):
        """The cell whose picture the same renderer is to repeat, and what it is called."""
        if "second" in cell:
            return None, "other"
        if cell["same_picture"]:
            return self.ordinary(cell), "self"
        end = self.by_value.get((cell["axis"], settled_from(cell["axis"], cell["value"])))
        return (end, "limit") if end else (None, "other")

    def judge(self, cell):
        """@return how, and Judged a renderer"""
        wanted, how = self.own_reference(cell)
        if wanted:
            return how, {r: judge(self.picture(cell, r), self.picture(wanted, r), self.noise(cell, r)) for r in RENDERERS}
        kadr, cycles = self.picture(cell, "kadr"), self.picture(cell, "cycles")
        ordinary = self.ordinary(cell)
        apart = judge(cycles, kadr, self.between(self.picture(ordinary, "cycles"), self.picture(ordinary, "kadr")))
        error = cell.get("image_error")
        own = Judged(error, 0, "" if kadr is None or error is None else "right" if error <= MEAN_LIMIT else "wrong")
        if cell["axis"] in NOT_COMPARABLE:
            apart.verdict = "drawn"
        elif apart.verdict == "wrong" and own.verdict == "wrong":
            apart.verdict = "unknown"  # the one it is held against is wrong itself
        return how, {"kadr": own, "cycles": apart}

    def of_size(self):
        for cell in self.cells:
            size = tuple(yaml.safe_load(cell["shot"].read_text())["image"]["size"])
            if size[0] * size[1] <= MOST_PIXELS:
                yield cell, size


def final_verdict(judged, made, size):
    if made.picture is None:
        return made.said.split(":")[0]
    if made.picture.shape[1::-1] != size:
        return "wrong size"
    if "not finite" in made.said:
        return "wrong"
    if made.picture.mean() < BLACK:
        return (judged.verdict + ", black").strip(", ")
    return judged.verdict or "drawn"


def figure(judged):
    return "" if judged.mean is None else f"{judged.mean:.2f}" + (f", {judged.bad_blocks} blocks" if judged.bad_blocks else "")


def rows_of(sweep):
    rows = []
    for cell, size in sweep.of_size():
        made = {r: sweep.run(cell, r) for r in RENDERERS}
        how, judged = sweep.judge(cell)
        apart = judge(made["cycles"].picture, made["kadr"].picture, pictures.Difference(0, 0, 0, 1))
        rows.append({"cell": cell, "how": how, "apart": apart, "made": made, "judged": judged, "verdict": {r: final_verdict(judged[r], made[r], size) for r in RENDERERS}})
    return rows


def table(rows):
    yield "| cell | judged | Kadr | off by | Cycles | off by | apart | Kadr CPU s | Cycles CPU s | Kadr MiB | Cycles MiB | said |"
    yield "|---|---|---|--:|---|--:|--:|--:|--:|--:|--:|---|"
    for row in rows:
        made, judged, verdict = row["made"], row["judged"], row["verdict"]
        said = "; ".join(f"{r.capitalize()}: {made[r].said}" for r in RENDERERS if made[r].said).replace("|", "\\|")
        yield (f"| {row['cell']['cell']} | {row['how']} | {verdict['kadr']} | {figure(judged['kadr'])} | {verdict['cycles']} | {figure(judged['cycles'])} | {figure(row['apart'])} | "
               + " | ".join(f"{made[r].cpu_s:.1f}" for r in RENDERERS) + " | " + " | ".join(f"{made[r].peak_mib:.0f}" for r in RENDERERS) + f" | {said} |")


def summary(rows):
    """Of each axis, the values at which either is not right."""
    by_axis = collections.defaultdict(list)
    for row in rows:
        cell = row["cell"]
        by_axis[f"{cell['axis']} × {cell['second']}" if "second" in cell else cell["axis"]].append(row)
    yield "| axis | values | Kadr is not right at | Cycles is not right at |"
    yield "|---|---|---|---|"
    for axis, of_axis in by_axis.items():
        name = lambda cell: f"{cell['value']:g}" + (f" × {cell['second_value']:g}" if "second" in cell else "")
        faults = {r: ", ".join(f"{name(row['cell'])} ({row['verdict'][r]})" for row in of_axis if row["verdict"][r] not in ("right", "drawn")) for r in RENDERERS}
        yield f"| {axis} | {', '.join(name(row['cell']) for row in of_axis)} | {faults['kadr']} | {faults['cycles']} |"


def write_sheet(file, rows):
    """Kadr left, Cycles right, of the cells where they differ or either is wrong."""
    tiles = []
    for row in rows:
        both = [row["made"][r].picture for r in RENDERERS]
        present = [p for p in both if p is not None]
        if len({p.shape for p in present}) == 1 and (row["apart"].verdict != "right" or "wrong" in "".join(row["verdict"].values())):
            tiles.append((row["cell"]["cell"], [p if p is not None else pictures.missing(present[0].shape) for p in both]))
    if tiles:
        pictures.write_sheet(file, tiles)


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sweeps", type=pathlib.Path, nargs="+", help="folders of `kadr stress --output`; of a cell in several the first counts")
    parser.add_argument("--kadr", type=pathlib.Path, required=True)
    parser.add_argument("--output", type=pathlib.Path, required=True, help="Markdown table")
    parser.add_argument("--sheet", type=pathlib.Path, help="picture: Kadr left, Cycles right, where they differ")
    parser.add_argument("--work", type=pathlib.Path, help="folder of the pictures (default: peers, in the first sweep's)")
    parser.add_argument("--axes", type=lambda text: text.split(","), help="only these")
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    options = parser.parse_args()
    for sweep in options.sweeps:
        if not (sweep / "report.json").exists():
            parser.error(f"no report.json in {sweep}; run `kadr stress --output {sweep}` first")
    if not options.kadr.exists():
        parser.error(f"no program at {options.kadr}; give --kadr")
    options.kadr = options.kadr.resolve()
    options.work = (options.work or options.sweeps[0] / "peers").resolve()
    options.work.mkdir(parents=True, exist_ok=True)
    return options


def main():
    options = parse()
    sweep = Sweep(options)
    rows = rows_of(sweep)
    text = "\n".join([*summary(rows), "", *table(rows)]) + "\n"
    options.output.write_text(text)
    print(text, end="")
    if options.sheet:
        write_sheet(options.sheet, rows)


if __name__ == "__main__":
    main()
