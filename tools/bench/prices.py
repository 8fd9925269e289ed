#!/usr/bin/env python3
"""What each choice between speed and accuracy costs and loses on the sample shots.

  tools/bench/prices.py --kadr BUILD/src/cli/kadr --results FILE.json [--only room,pan]
  tools/bench/prices.py --kadr BUILD/src/cli/kadr --equal-flip 640x360 [--only room,pan]     the last part alone, at another size

The middle frame of every sample, 64 samples a pixel, is rendered with one setting changed. Cost: seconds of processor time
(user and system, all threads) at 192x108, less those of the same shot at one pixel and one sample, over those of the shot's
own settings: the median of three rounds over all choices, each with the shot's own settings first and last. Loss: relMSE of
the EXR and FLIP at 96x54 against tests/measure/references (the shot's own settings, 16384 samples), over those of the shot's
own settings. What changes the picture that is aimed at (`fresnel: exact`) is measured, as are the shot's own settings beside
it, against 4096 samples with it. Of each, the median over the samples whose picture the choice changes, and how many those
are. A choice that is slower and worse on all samples is named: it has to go.

At its end: the processor time to equal FLIP, of denoised frames of 4 and 16 samples and of frames steered by max_error,
over that of equal samples for every pixel, between whose FLIP it is interpolated (log-log); 256x144, against 1024 samples of
another seed.

FILE keeps what was measured, a shot at a time: a run that was interrupted goes on, and --only adds to it. When it holds all
samples, src/shot/prices_measured.h is written: `kadr describe prices` prints that. Needs the denoiser (`kadr devices`), and
half an hour of a machine that does nothing else.
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

TABLE = ROOT / "src" / "shot" / "prices_measured.h"
SAMPLES, ROUNDS, MODEL_SAMPLES = 64, 3, 4096
EQUAL_SIZE, EQUAL_SAMPLES = "256x144", 1024
SLOWER, WORSE = 1.05, 1.005   # beyond what runs differ by, and what rounding does
TRUTH_SEED = ("seed", "{ value: 77 }")
CHOICES = (
    ("integrator", ("direct",)),
    ("bounces", ("0", "1", "3", "32")),
    ("fresnel", ("exact",)),
    ("motion_tolerance", ("0.02 px", "0.5 px", "2 px")),
    ("motion_frames", ("2", "5", "17", "{ count: 2, mix: matrix }", "{ count: 17, mix: matrix }")),
    ("clamp", ("{ indirect: 3 }",)),
    ("denoise", ("oidn",)),
    ("build", ("low", "high")),
    ("robust", ("true",)),
    ("texture_limit", ("16 px", "64 px")),
)
MODELS = ("fresnel",)   # choices of what is the truth
PLAIN, DENOISED, STEERED = (4, 16, 64, 256), (4, 16), ("0.1", "0.05", "0.025")
HEADER = """#pragma once

// Written by tools/bench/prices.py: what choices between speed and accuracy cost and lose. Not edited by hand.

#include <array>

namespace kadr {{

/// A setting of `render`; medians over the sample shots whose picture it changes.
struct MeasuredPrice {{
    const char* key;
    const char* value;
    double cost, most_cost;  ///< processor time over that of the shot's own settings: median, and the most of all samples
    double relmse;           ///< over that of the shot's own settings, at as many samples
    double flip, most_flip;
    int changed;             ///< of how many samples the picture changes; 0: the medians are those of all
}};

/// Ways to the same FLIP: processor time over that of equal samples for every pixel.
struct MeasuredShortcut {{
    const char* way;
    double median, least, most;  ///< of the samples
}};

inline constexpr int kPriceSamples = {samples}, kPriceShots = {shots};
inline constexpr std::array<MeasuredPrice, {prices}> kMeasuredPrices{{{{
{price_rows}}}}};
inline constexpr std::array<MeasuredShortcut, {shortcuts}> kMeasuredShortcuts{{{{
{shortcut_rows}}}}};

}}  // namespace kadr
"""


class Shot:
    def __init__(self, kadr, path, folder):
        self.kadr, self.path, self.folder = kadr, path, folder
        self.name, self.frame = path.stem, middle_frame(kadr, path)
        self.loading = {}

    def run(self, image, size, samples_setting, settings):
        """Seconds of processor time; nothing where the shot cannot be rendered so."""
        before = cpu_seconds()
        words = [word for key, value in (("samples", samples_setting), *settings) for word in ("--set", f"render.{key}={value}")]
        done = subprocess.run([str(self.kadr), "render", str(self.path), "--frames", str(self.frame), "--size", size,
                               "--set", "render.seed={ value: 1 }", "--set", "output.aovs=[]", "--output", str(image), "--video", "none", "--overwrite", *words],
                              capture_output=True, text=True)
        return cpu_seconds() - before if done.returncode == 0 else None

    def loading_with(self, settings):
        """Only a denoiser loads more than the shot does by itself."""
        more = tuple(setting for setting in settings if setting[0] == "denoise")
        if more not in self.loading:
            runs = [self.run(self.folder / "dot.exr", "1x1", "1", more) for _ in range(3)]
            self.loading[more] = None if None in runs else min(runs)
        return self.loading[more]

    def seconds(self, size, samples_setting, *settings, image="large.exr"):
        used, loading = self.run(self.folder / image, size, samples_setting, settings), self.loading_with(settings)
        return None if used is None or loading is None else max(used - loading, 1e-3)

    def measure(self, samples_setting, *settings, size=f"{WIDTH}x{HEIGHT}", truth=None):
        """Seconds, relMSE and FLIP."""
        used = self.seconds(size, samples_setting, *settings, image="image.exr")
        if used is None:
            return None
        error = compare(self.kadr, truth or REFERENCES / f"{self.name}.exr", self.folder / "image.exr")
        return used, error["relmse"], error["flip"]

    def truth(self, size, count, *settings):
        image = self.folder / "truth.exr"
        return image if self.run(image, size, count, (*settings, TRUTH_SEED)) is not None else None


def ratio(a, b):
    return a / b if b > 1e-9 else 1.0


def losses_of(shot):
    """{(key, value): (relMSE, FLIP)} over those of the shot's own settings; what it cannot be rendered with is left out."""
    own, losses = shot.measure(SAMPLES), {}
    for choice in ((key, value) for key, values in CHOICES for value in values):
        truth = shot.truth(f"{WIDTH}x{HEIGHT}", MODEL_SAMPLES, choice) if choice[0] in MODELS else None
        measured = shot.measure(SAMPLES, choice, truth=truth)
        if measured:
            beside = shot.measure(SAMPLES, truth=truth) if truth else own
            losses[choice] = tuple(ratio(measured[i], beside[i]) for i in (1, 2))
    return losses


def costs_of(shot, choices):
    """{(key, value): processor time} over that of the shot's own settings."""
    ratios = {choice: [] for choice in choices}
    for _ in range(ROUNDS):
        large = f"{2 * WIDTH}x{2 * HEIGHT}"
        first = shot.seconds(large, SAMPLES)
        round_s = {choice: shot.seconds(large, SAMPLES, choice) for choice in choices}
        own = (first + shot.seconds(large, SAMPLES)) / 2
        for choice, seconds in round_s.items():
            ratios[choice].append(seconds / own)
    return {choice: statistics.median(values) for choice, values in ratios.items()}


def prices_of(shot):
    losses = losses_of(shot)
    return {f"{key}: {value}": (cost, *losses[key, value]) for (key, value), cost in costs_of(shot, losses).items()}


def time_to_flip(curve, flip):
    """Seconds at which the plain curve of (seconds, flip) passes a FLIP; beyond its ends by the last slope."""
    curve = sorted((math.log(max(f, 1e-9)), math.log(s)) for s, f in curve)
    wanted = math.log(max(flip, 1e-9))
    at = min(max(1, sum(f < wanted for f, _ in curve)), len(curve) - 1)
    (f0, s0), (f1, s1) = curve[at - 1], curve[at]
    return math.exp(s0 + (s1 - s0) * (wanted - f0) / (f1 - f0)) if f1 != f0 else math.exp(s0)


def shortcuts_of(shot, size=EQUAL_SIZE):
    truth = shot.truth(size, EQUAL_SAMPLES)
    def measure(*settings):
        return shot.measure(*settings, size=size, truth=truth)
    curve = [(seconds, flip) for seconds, _, flip in map(measure, PLAIN)]
    ways = {f"denoised, {count} samples": (count, ("denoise", "oidn")) for count in DENOISED}
    ways |= {f"max_error: {error}": (f"{{ max_error: {error}, at_least: 8, at_most: 1024 }}",) for error in STEERED}
    gains = {}
    for way, settings in ways.items():
        measured = measure(*settings)
        if measured:
            gains[way] = measured[0] / time_to_flip(curve, measured[2])
    return gains


def measure_shot(shot):
    return {"prices": prices_of(shot), "shortcuts": shortcuts_of(shot)}


def changed(price):
    return abs(price[1] - 1) > 1e-6 or abs(price[2] - 1) > 1e-6


def price_table(results):
    """Rows of MeasuredPrice, and the choices that are dominated."""
    table, dominated = [], []
    for key, value in ((key, value) for key, values in CHOICES for value in values):
        every = [shot["prices"][f"{key}: {value}"] for shot in results.values() if f"{key}: {value}" in shot["prices"]]
        prices = [price for price in every if changed(price)] or every
        if not prices:
            continue
        cost, relmse, flip = (statistics.median(price[i] for price in prices) for i in range(3))
        table.append((key, value, cost, max(price[0] for price in every), relmse, flip, max(price[2] for price in every), sum(map(changed, every))))
        if all(price[0] > SLOWER and price[1] > WORSE and price[2] > WORSE for price in prices):
            dominated.append(f"{key}: {value}")
    return table, dominated


def shortcut_table(results):
    ways = [way for shot in results.values() for way in shot["shortcuts"]]
    gains = {way: [shot["shortcuts"][way] for shot in results.values() if way in shot["shortcuts"]] for way in dict.fromkeys(ways)}
    return [(way, statistics.median(values), min(values), max(values)) for way, values in gains.items()]


def report(results):
    prices, dominated = price_table(results)
    print(f"{'setting':<18} {'value':<28} {'cost':>6} {'most':>6} {'relMSE':>8} {'FLIP':>7} {'most':>7}  of samples")
    for key, value, cost, most_cost, relmse, flip, most_flip, shots in prices:
        print(f"{key:<18} {value:<28} {cost:>6.2f} {most_cost:>6.2f} {relmse:>8.2f} {flip:>7.2f} {most_flip:>7.2f}  {shots}")
    for choice in dominated:
        print(f"dominated: {choice} is slower and worse on all samples")
    report_shortcuts(results)


def report_shortcuts(results):
    for way, median, least, most in shortcut_table(results):
        print(f"{way}: {median:.2f} of the processor time of equal samples at equal FLIP (median; {least:.2f} to {most:.2f})")


def write_table(results):
    prices, shortcuts = price_table(results)[0], shortcut_table(results)
    TABLE.write_text(HEADER.format(
        samples=SAMPLES, shots=len(results), prices=len(prices), shortcuts=len(shortcuts),
        price_rows="".join(f'    {{"{key}", "{value}", ' + ", ".join(f"{figure:.3g}" for figure in row) + "},\n" for key, value, *row in prices),
        shortcut_rows="".join(f'    {{"{way}", {median:.3g}, {least:.3g}, {most:.3g}}},\n' for way, median, least, most in shortcuts)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kadr", required=True, type=pathlib.Path)
    parser.add_argument("--only", help="samples, separated by commas")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--results", type=pathlib.Path, help="JSON of every shot")
    what.add_argument("--equal-flip", metavar="WxH")
    options = parser.parse_args()
    results = json.loads(options.results.read_text()) if options.results and options.results.exists() else {}
    for path in samples():
        if path.stem in results or (options.only and path.stem not in options.only.split(",")):
            continue
        with tempfile.TemporaryDirectory() as folder:
            shot = Shot(options.kadr.resolve(), path, pathlib.Path(folder))
            results[path.stem] = {"shortcuts": shortcuts_of(shot, options.equal_flip)} if options.equal_flip else measure_shot(shot)
        if options.results:
            options.results.write_text(json.dumps(results, indent=1) + "\n")
        print(path.stem, results[path.stem]["shortcuts"], flush=True)
    if options.equal_flip:
        return report_shortcuts(results)
    report(results)
    if all(path.stem in results for path in samples()):
        write_table(results)


if __name__ == "__main__":
    main()
