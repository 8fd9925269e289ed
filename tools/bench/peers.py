#!/usr/bin/env python3
"""Kadr against Cycles and Mitsuba on the same glTF scenes: speed in one interleaved run, and error against references.

  tools/bench/peers.py speed --kadr BUILD/src/cli/kadr --python VENV/bin/python
  tools/bench/peers.py error --kadr BUILD/src/cli/kadr --python VENV/bin/python
  tools/bench/peers.py adaptive --kadr BUILD/src/cli/kadr --python VENV/bin/python

speed  640×360, 4 bounces, box filter, constant background. Rounds run kadr, Cycles and Mitsuba in turn, because a machine's
       speed drifts. Million pixel-samples per CPU-second of tracing; for kadr that is the difference of two whole
       processes (many samples, few samples), so that start, loading and writing drop out.
adaptive  320×180: CPU-seconds of tracing to the error of Cycles' adaptive sampling (thresholds 0.1 and 0.01, at most 4096 samples), for
       kadr with fixed samples and with --max-error; between measured points by straight lines on log-log paper. Median of the seeds.
error  320×180 at 16 and 64 samples, the median of 8 seeds on both sides: RMSE, trimmed relMSE, and the bias of the mean.

The scenes, references and the peers' drivers lie in the folder that KADR_PEERS names (default: ../shared/peers beside the
repository); --python is an interpreter with bpy, mitsuba, numpy and OpenImageIO. What is missing is named and skipped.
Mitsuba compiles with the LLVM that DRJIT_LIBLLVM_PATH names; Debian's 14 and 15 cannot compile it for AVX-512, 19 can.
Writes a JSON report (--output) and prints a table.
"""
import argparse
import json
import math
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPEED_SCENES = ("spheres_nospot", "cornell")
FRAME = 1   # glTF time FRAME / fps

SHOT = """kadr: 1
name: {name}
timing: {{ fps: {fps}, frames: {frame} }}
image: {{ size: [{width}, {height}] }}
scenes: [ {{ id: scene, gltf: "{gltf}" }} ]
camera: {{ gltf: scene/{camera} }}
shutter: 0
environment: {{ color: [{background}], strength: 1 }}
render: {{ integrator: path, samples: {samples}, bounces: {{ total: {bounces} }}, filter: {{ type: box, width: 1 px }}, seed: {seed} }}
output: {{ frames: "{image}" }}
"""


class Failed(Exception):
    """A renderer ended with an error; the message has its last lines."""


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(0)


def write_shot(folder, peers, scene, size, samples, bounces, seed, image):
    side = json.loads((peers / "scenes" / f"{scene}.json").read_text())
    path = folder / f"{scene}.yaml"
    path.write_text(SHOT.format(name=scene, fps=side.get("fps", 24), frame=FRAME, width=size[0], height=size[1],
                                gltf=peers / "scenes" / f"{scene}.glb", camera=side["camera"],
                                background=", ".join(str(x) for x in side["background"]),
                                samples=samples, bounces=bounces, seed=seed, image=image))
    return path


def timed(command):
    """Runs a command; its standard output, wall and CPU seconds, and peak memory."""
    wall = time.perf_counter()
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        child = subprocess.Popen([str(x) for x in command], stdout=out, stderr=err)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0), err.seek(0)
        text, errors = out.read(), err.read()
    if child.returncode:
        raise Failed(f"{' '.join(str(x) for x in command)}\n  ended with {child.returncode}:\n{errors[-2000:]}{text[-2000:]}")
    return text, {"wall_s": time.perf_counter() - wall, "cpu_s": usage.ru_utime + usage.ru_stime, "peak_mib": usage.ru_maxrss / 1024}


def run_kadr(options, folder, scene, size, samples, seed=0, image=None, more=()):
    shot = write_shot(folder, options.peers, scene, size, samples, options.bounces, seed, image or folder / "kadr.exr")
    _, figures = timed([options.kadr, "render", shot, "--overwrite", "--json", *more, *(["--threads", options.threads] if options.threads else [])])
    return figures


def kadr_speed(options, folder, scene, size):
    few = max(1, options.samples // 16)
    low, high = (run_kadr(options, folder, scene, size, n) for n in (few, options.samples))
    traced = size[0] * size[1] * (options.samples - few)
    return {"msamples_cpu_s": traced / (high["cpu_s"] - low["cpu_s"]) / 1e6,
            "whole_msamples_cpu_s": size[0] * size[1] * options.samples / high["cpu_s"] / 1e6, "peak_mib": high["peak_mib"]}


def peer_speed(options, scene, size, script, *more):
    text, figures = timed([options.python, options.peers / script, options.peers / "scenes" / f"{scene}.glb", "--spp", options.samples,
                           "--res", f"{size[0]}x{size[1]}", "--frames", FRAME, "--max-bounces", options.bounces, "--threads", options.threads, *more])
    line = json.loads([t for t in text.splitlines() if t.startswith("{")][-1])
    return {"msamples_cpu_s": line["msamples_cpu_s"], "whole_msamples_cpu_s": size[0] * size[1] * options.samples / figures["cpu_s"] / 1e6,
            "peak_mib": figures["peak_mib"]}


def median_of(rows, key):
    return statistics.median(r[key] for r in rows)


def speed(options, folder):
    size, report = (640, 360), {}
    for scene in options.scenes or SPEED_SCENES:
        runners = {"kadr": lambda: kadr_speed(options, folder, scene, size),
                   "cycles": lambda: peer_speed(options, scene, size, "cycles_render.py"),
                   "mitsuba": lambda: peer_speed(options, scene, size, "mitsuba_render.py", "--variant", "llvm_ad_rgb")}
        runners = {k: v for k, v in runners.items() if k in options.renderers}
        rows = {name: [] for name in runners}
        for round_number in range(options.rounds):
            for name, runner in list(runners.items()):
                try:
                    rows[name].append(runner())
                except Failed as failed:
                    if name == "kadr":
                        raise SystemExit(str(failed))
                    print(f"skipped {name} on {scene}: {failed}", file=sys.stderr)
                    del runners[name], rows[name]
                    continue
                print(f"  {scene} round {round_number + 1} {name}: {rows[name][-1]['msamples_cpu_s']:.3f}", file=sys.stderr)
        report[scene] = {name: {"rounds": r, **{k: median_of(r, k) for k in r[0]}} for name, r in rows.items()}
    print(f"\nmillion pixel-samples per CPU-second, {size[0]}×{size[1]}, {options.bounces} bounces, {options.samples} samples, median of {options.rounds}")
    print(f"{'scene':16} {'renderer':9} {'tracing':>8} {'spread':>15} {'whole':>8} {'MiB':>7} {'kadr is':>9}")
    for scene, by_name in report.items():
        for name, r in by_name.items():
            each = [x["msamples_cpu_s"] for x in r["rounds"]]
            ratio = f"{by_name['kadr']['msamples_cpu_s'] / r['msamples_cpu_s']:.2f} ×" if "kadr" in by_name else ""
            print(f"{scene:16} {name:9} {r['msamples_cpu_s']:8.3f} {min(each):7.3f}-{max(each):<7.3f} {r['whole_msamples_cpu_s']:8.3f} {r['peak_mib']:7.0f} {ratio:>9}")
    return report


def errors_of(options, scene, images):
    text, _ = timed([options.python, options.peers / "error.py", options.peers / "refs" / f"{scene}.exr", *images])
    return [json.loads(t) for t in text.splitlines() if t.startswith("{")]


def error(options, folder):
    size, report = (320, 180), {}
    for scene in options.scenes or SPEED_SCENES:
        for samples in options.error_samples:
            files = {name: [folder / f"{name}.{scene}.{samples}.{seed}.exr" for seed in range(options.seeds)]
                     for name in ("kadr", "cycles") if name in options.renderers}
            for seed in range(options.seeds):
                if "kadr" in files:
                    run_kadr(options, folder, scene, size, samples, seed + 1, files["kadr"][seed])
                if "cycles" in files:
                    timed([options.python, options.peers / "cycles_render.py", options.peers / "scenes" / f"{scene}.glb", "--out", files["cycles"][seed],
                           "--spp", samples, "--res", f"{size[0]}x{size[1]}", "--frames", FRAME, "--max-bounces", options.bounces, "--seed", seed + 1])
            for name, images in files.items():
                rows = errors_of(options, scene, images)
                report.setdefault(scene, {}).setdefault(str(samples), {})[name] = {k: median_of(rows, k) for k in ("rmse", "relmse", "relmse_t", "bias")}
    print(f"\nerror against the references, {size[0]}×{size[1]}, median of {options.seeds} seeds")
    print(f"{'scene':16} {'samples':>7} {'renderer':9} {'RMSE':>8} {'relMSE_t':>9} {'bias %':>8} {'RMSE ×':>8} {'relMSE_t ×':>10}")
    for scene, by_samples in report.items():
        for samples, by_name in by_samples.items():
            for name, r in by_name.items():
                peer = by_name.get("cycles", r)
                ratios = f"{r['rmse'] / peer['rmse']:8.3f} {r['relmse_t'] / peer['relmse_t']:10.3f}"
                print(f"{scene:16} {samples:>7} {name:9} {r['rmse']:8.4f} {r['relmse_t']:9.5f} {100 * r['bias']:8.2f} {ratios}")
    return report


def kadr_curve(options, folder, scene, size, seed, runs):
    """(CPU-seconds of tracing, RMSE, trimmed relMSE) of each run: (samples, more options)."""
    loading = min(run_kadr(options, folder, scene, (1, 1), 1)["cpu_s"] for _ in range(3))
    points = []
    for i, (samples, more) in enumerate(runs):
        image = folder / f"kadr.{i}.exr"
        figures = run_kadr(options, folder, scene, size, samples, seed, image, more)
        (row,) = errors_of(options, scene, [image])
        points.append((max(figures["cpu_s"] - loading, 1e-3), row["rmse"], row["relmse_t"]))
    return points


def seconds_to(points, column, wanted):
    """Seconds at which a curve reaches an error; beyond its ends by its last slope."""
    curve = sorted((math.log(point[column]), math.log(point[0])) for point in points)
    at = min(max(1, sum(e < math.log(wanted) for e, _ in curve)), len(curve) - 1)
    (e0, s0), (e1, s1) = curve[at - 1], curve[at]
    return math.exp(s0 + (s1 - s0) * (math.log(wanted) - e0) / (e1 - e0))


def adaptive(options, folder):
    size, report = (320, 180), {}
    kadr_runs = {"fixed": [(n, ()) for n in (16, 64, 256)], "--max-error": [(4096, ("--max-error", str(e))) for e in (0.08, 0.04, 0.02)]}
    for scene in options.scenes or SPEED_SCENES:
        for threshold in (0.1, 0.01):
            rows = []
            for seed in range(1, options.seeds + 1):
                image = folder / "cycles.exr"
                text, _ = timed([options.python, options.peers / "cycles_render.py", options.peers / "scenes" / f"{scene}.glb", "--out", image, "--spp", 4096,
                                 "--res", f"{size[0]}x{size[1]}", "--frames", FRAME, "--max-bounces", options.bounces, "--seed", seed, "--adaptive", threshold])
                line = json.loads([t for t in text.splitlines() if t.startswith("{")][-1])
                (error,) = errors_of(options, scene, [image])
                row = {"cycles": {"cpu_s": line["trace_cpu_s"], "rmse": error["rmse"], "relmse_t": error["relmse_t"]}}
                for name, runs in kadr_runs.items():
                    points = kadr_curve(options, folder, scene, size, seed, runs)
                    row[name] = {"points": points, "rmse_s": seconds_to(points, 1, error["rmse"]), "relmse_t_s": seconds_to(points, 2, error["relmse_t"])}
                rows.append(row)
                print(f"  {scene} threshold {threshold} seed {seed}: cycles {row['cycles']}", file=sys.stderr)
            report.setdefault(scene, {})[str(threshold)] = rows
    print(f"\nCPU-seconds of tracing to the error of Cycles' adaptive sampling, {size[0]}×{size[1]}, median of {options.seeds} seeds")
    print(f"{'scene':16} {'threshold':>9} {'Cycles':>8} {'RMSE':>8} {'relMSE_t':>9}  {'kadr':12} {'to RMSE':>8} {'Cycles is':>10} {'to relMSE_t':>12} {'Cycles is':>10}")
    for scene, by_threshold in report.items():
        for threshold, rows in by_threshold.items():
            cycles = {key: statistics.median(row["cycles"][key] for row in rows) for key in ("cpu_s", "rmse", "relmse_t")}
            for name in kadr_runs:
                seconds = [statistics.median(row[name][key] for row in rows) for key in ("rmse_s", "relmse_t_s")]
                ratios = [statistics.median(row["cycles"]["cpu_s"] / row[name][key] for row in rows) for key in ("rmse_s", "relmse_t_s")]
                print(f"{scene:16} {threshold:>9} {cycles['cpu_s']:8.2f} {cycles['rmse']:8.4f} {cycles['relmse_t']:9.5f}  {name:12} {seconds[0]:8.2f} {ratios[0]:8.2f} × {seconds[1]:12.2f} {ratios[1]:8.2f} ×")
    return report


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), platform.machine()) if os.path.exists("/proc/cpuinfo") else platform.machine()
    commit = subprocess.run(["git", "-C", str(ROOT), "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    return {"cpu": model, "cores": os.cpu_count(), "commit": commit}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mode", choices=("speed", "error", "adaptive"))
    parser.add_argument("--kadr", type=pathlib.Path, default=ROOT / "build" / "release" / "src" / "cli" / "kadr")
    parser.add_argument("--python", default="", help="interpreter with bpy, mitsuba, numpy and OpenImageIO")
    parser.add_argument("--peers", type=pathlib.Path, default=pathlib.Path(os.environ.get("KADR_PEERS", ROOT.parent / "shared" / "peers")))
    parser.add_argument("--renderers", default="kadr,cycles,mitsuba", help="comma-separated; kadr alone needs no --python for `speed`")
    parser.add_argument("--scenes", type=lambda t: t.split(","), help=f"default: {','.join(SPEED_SCENES)}")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--samples", type=int, default=64, help="of `speed`")
    parser.add_argument("--error-samples", type=lambda t: [int(x) for x in t.split(",")], default=[16, 64])
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--bounces", type=int, default=4)
    parser.add_argument("--threads", type=int, default=0, help="0: all")
    parser.add_argument("--output", type=pathlib.Path, help="JSON report")
    options = parser.parse_args()
    options.renderers = options.renderers.split(",")
    options.peers, options.kadr = options.peers.resolve(), options.kadr.resolve()
    if not (options.peers / "scenes").is_dir():
        skip(f"no folder {options.peers / 'scenes'}; set KADR_PEERS")
    if not options.kadr.exists():
        parser.error(f"no program at {options.kadr}; give --kadr")
    if not options.python and (options.mode != "speed" or options.renderers != ["kadr"]):
        skip("give --python, an interpreter with bpy, mitsuba, numpy and OpenImageIO (see README.md of the peers), or --renderers kadr")
    with tempfile.TemporaryDirectory(prefix="kadr-peers-") as folder:
        report = {"speed": speed, "error": error, "adaptive": adaptive}[options.mode](options, pathlib.Path(folder))
    if options.output:
        options.output.write_text(json.dumps({"mode": options.mode, "machine": machine(), "settings": {k: str(v) for k, v in vars(options).items()},
                                              "report": report}, indent=1) + "\n")


if __name__ == "__main__":
    main()
