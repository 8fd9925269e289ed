#!/usr/bin/env python3
"""What each choice between speed and accuracy costs and loses on the sample shots.

  tools/bench/prices.py --kadr BUILD/src/cli/kadr [--only room,pan] [--output FILE.json]

The middle frame of every sample, 64 samples a pixel, is rendered with one setting changed. Cost: seconds of processor time
(user and system, all threads) at 192x108, less those of the same shot at one pixel and one sample, over those of the shot's
own settings: the median of three pairs of runs, in turn. Loss: relMSE of the EXR and FLIP at 96x54 against
tests/measure/references (the shot's own settings, 16384 samples), over those of the shot's own settings. Of each, the
median over the samples whose picture the choice changes, and how many those are. Needs the denoiser (`kadr devices`), and
half an hour of a machine that does nothing else.

At its end: the processor time to equal FLIP of denoised frames of 4 and 16 samples against plain ones, between which the
plain time is interpolated (log-log). A choice that is slower and worse on all samples is named: it has to go.
"""
import argparse
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from calibration import HEIGHT, REFERENCES, ROOT, WIDTH, middle_frame
from quality import compare, cpu_seconds, samples

SAMPLES, SEEDS, ROUNDS = 64, (1,), 3
CHOICES = (
    ("build", ("low", "high")),
    ("robust", ("true",)),
    ("motion_tolerance", ("0.02 px", "0.5 px", "2 px")),
    ("texture_limit", ("16 px", "64 px")),
    ("denoise", ("oidn",)),
    ("integrator", ("direct",)),
    ("bounces", ("0", "1", "3", "32")),
    ("clamp", ("{ direct: none, indirect: 3 }",)),
    ("filter", ("box",)),
)
PLAIN, DENOISED = (4, 16, 64, 256), (4, 16)

class Shot:
    def __init__(self, kadr, path, folder):
        self.kadr, self.path, self.folder = kadr, path, folder
        self.name, self.frame = path.stem, middle_frame(kadr, path)
        self.loading = {}

    def run(self, image, size, count, seed, settings):
        before = cpu_seconds()
        words = [word for setting in settings for word in ("--set", f"render.{setting[0]}={setting[1]}")]
        done = subprocess.run([str(self.kadr), "render", str(self.path), "--frames", str(self.frame), "--size", size, "--samples", str(count),
                               "--set", f"render.seed={{ value: {seed} }}", "--set", "output.aovs=[]", "--output", str(image), "--video", "none", "--overwrite", *words],
                              capture_output=True, text=True)
        return cpu_seconds() - before if done.returncode == 0 else None

    def measure(self, count, *settings):
        """Seconds, relMSE and FLIP, means of the seeds; nothing where the shot cannot be rendered so."""
        # Only a denoiser loads more than the shot does by itself.
        more = tuple(setting for setting in settings if setting[0] == "denoise")
        if more not in self.loading:
            runs = [self.run(self.folder / "dot.exr", "1x1", 1, 1, more) for _ in range(3)]
            if None in runs:
                return None
            self.loading[more] = min(runs)
        rows = []
        for seed in SEEDS:
            image = self.folder / "image.exr"
            seconds = self.run(image, f"{WIDTH}x{HEIGHT}", count, seed, settings)
            if seconds is None:
                return None
            error = compare(self.kadr, REFERENCES / f"{self.name}.exr", image)
            rows.append((max(seconds - self.loading[more], 1e-3), error["relmse"], error["flip"]))
        return tuple(statistics.fmean(row[i] for row in rows) for i in range(3))


def time_to_flip(curve, flip):
    """Seconds at which the plain curve of (seconds, flip) passes a FLIP; beyond its ends by the last slope."""
    curve = sorted((math.log(max(f, 1e-9)), math.log(s)) for s, f in curve)
    wanted = math.log(max(flip, 1e-9))
    at = min(max(1, sum(f < wanted for f, _ in curve)), len(curve) - 1)
    (f0, s0), (f1, s1) = curve[at - 1], curve[at]
    return math.exp(s0 + (s1 - s0) * (wanted - f0) / (f1 - f0)) if f1 != f0 else math.exp(s0)


def cost_of(shot, setting):
    """Processor time over that of the shot's own settings."""
    def seconds(*settings):
        return max(shot.run(shot.folder / "large.exr", f"{2 * WIDTH}x{2 * HEIGHT}", SAMPLES, 1, settings) - shot.loading[tuple(s for s in settings if s[0] == "denoise")], 1e-3)
    return statistics.median(seconds(setting) / seconds() for _ in range(ROUNDS))


def measure_shot(shot):
    own = shot.measure(SAMPLES)
    prices = {}
    for key, values in CHOICES:
        for value in values:
            measured = shot.measure(SAMPLES, (key, value))
            if measured:
                prices[key, value] = (cost_of(shot, (key, value)), *(measured[i] / own[i] if own[i] > 1e-9 else 1.0 for i in (1, 2)))
    plain = [own if count == SAMPLES else shot.measure(count) for count in PLAIN]
    curve = [(seconds, flip) for seconds, _, flip in plain]
    gains = {}
    for count in DENOISED:
        measured = shot.measure(count, ("denoise", "oidn"))
        gains[count] = measured[0] / time_to_flip(curve, measured[2]) if measured else math.nan
    return prices, gains


def changed(price):
    return abs(price[1] - 1) > 1e-6 or abs(price[2] - 1) > 1e-6


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kadr", required=True, type=pathlib.Path)
    parser.add_argument("--only", help="samples, separated by commas")
    parser.add_argument("--output", type=pathlib.Path, help="JSON of every shot")
    options = parser.parse_args()
    by_shot, gains = {}, {}
    for path in samples():
        if options.only and path.stem not in options.only.split(","):
            continue
        with tempfile.TemporaryDirectory() as folder:
            by_shot[path.stem], gains[path.stem] = measure_shot(Shot(options.kadr.resolve(), path, pathlib.Path(folder)))
        print(path.stem, flush=True)
    print(f"{'setting':<18} {'value':<28} {'cost':>6} {'relMSE':>8} {'FLIP':>7}  of samples")
    for key, values in CHOICES:
        for value in values:
            all_prices = [prices[key, value] for prices in by_shot.values() if (key, value) in prices]
            prices = [price for price in all_prices if changed(price)] or all_prices
            if not prices:
                continue
            shots = sum(changed(price) for price in all_prices)
            cost, relmse, flip = (statistics.median(price[i] for price in prices) for i in range(3))
            print(f"{key:<18} {value:<28} {cost:>6.2f} {relmse:>8.2f} {flip:>7.2f}  {shots}")
            if all(price[0] > 1.05 and price[1] > 1 and price[2] > 1 for price in prices):
                print(f"  dominated: {key}: {value} is slower and worse on all samples")
    for count in DENOISED:
        ratios = [gain[count] for gain in gains.values()]
        print(f"denoised, {count} samples: {statistics.median(ratios):.2f} of the processor time of plain samples of equal FLIP (median; {min(ratios):.2f} to {max(ratios):.2f})")
    if options.output:
        options.output.write_text(json.dumps({"prices": {name: {f"{k} {v}": p for (k, v), p in prices.items()} for name, prices in by_shot.items()}, "denoised": gains}, indent=1) + "\n")


if __name__ == "__main__":
    main()
