"""measure.html from measure.json: report.py MEASURE.json PAGE.html. One page with everything in it; needs matplotlib."""
import base64
import html
import io
import json
import pathlib
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

# Okabe and Ito's palette: told apart with any colour vision.
COLORS = {"shot": "#000000", "samples": "#0072B2", "bounces": "#D55E00", "integrator": "#CC79A7",
          "motion_tolerance": "#009E73", "motion_frames": "#7FC8A9", "device": "#A05195", "clamp": "#E69F00", "denoise": "#56B4E9", "texture": "#8B4513", "build": "#6A3D9A", "robust": "#B2A000",
          "recommended": "#666666"}
SHARES = {"noise": "#0072B2", "bounces": "#D55E00", "motion": "#009E73", "clamp": "#E69F00", "denoise": "#56B4E9", "texture": "#8B4513", "other": "#999999"}
MARKS = {"shot": "*", "recommended": "P"}
STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #1b1b1b; background: #fff; max-width: 68rem; margin: 2rem auto; padding: 0 1.2rem; }
h1 { font-size: 1.7rem; margin-bottom: .2rem; } h2 { font-size: 1.2rem; margin-top: 2.4rem; }
.facts, figcaption, .note { color: #555; font-size: .9rem; }
.advice { background: #f3f6f9; border-left: 4px solid #0072B2; padding: .8rem 1.1rem; margin: 1.2rem 0; }
pre { background: #222; color: #f4f4f4; padding: .7rem 1rem; border-radius: 4px; overflow-x: auto; }
table { border-collapse: collapse; font-size: .88rem; width: 100%; }
th { text-align: right; border-bottom: 2px solid #999; padding: .25rem .6rem; } th:first-child, td:first-child { text-align: left; }
td { text-align: right; border-bottom: 1px solid #e3e3e3; padding: .2rem .6rem; font-variant-numeric: tabular-nums; }
tr.front td { background: #eef6ee; } tr.shot td { font-weight: 600; }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(30rem, 1fr)); gap: 1.1rem; }
.pictures figure { margin: 0; } .pictures img { width: 50%; image-rendering: pixelated; }
svg { max-width: 100%; height: auto; }
"""


def label(variant):
    return f"{variant['axis']} {variant['value']}".strip()


def svg_of(figure):
    text = io.StringIO()
    figure.savefig(text, format="svg", bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)
    return text.getvalue()[text.getvalue().index("<svg"):]


def plain(value, _=None):
    return f"{value:.3g}"


def points(ax, data, error):
    """Every variant at its time and error; those of one axis and the shot's own are joined in order of time."""
    own = data["variants"][0]
    axes = {}
    for variant in data["variants"][1:] + [data["recommendation"]["measured"]]:
        axes.setdefault(variant["axis"], []).append(variant)
    for axis, variants in axes.items():
        joined = variants if axis == "recommended" else sorted(variants + [own], key=lambda v: v["seconds"])
        ax.plot([v["seconds"] for v in joined], [error(v) for v in joined], "-" if axis == "samples" else ":",
                color=COLORS[axis], linewidth=1.6 if axis == "samples" else 1, zorder=2)
        ax.plot([v["seconds"] for v in variants], [error(v) for v in variants], MARKS.get(axis, "o"), color=COLORS[axis],
                markersize=10 if axis in MARKS else 6, label=axis.replace("_", " "), zorder=3)
        if axis in ("samples", "bounces", "clamp"):
            for v in variants:
                ax.annotate(v["value"], (v["seconds"], error(v)), textcoords="offset points", xytext=(5, 4), fontsize=8, color=COLORS[axis])
    ax.plot([own["seconds"]], [error(own)], MARKS["shot"], color=COLORS["shot"], markersize=13, label="the shot's own", zorder=4)


def finish(ax, title, ylabel):
    ax.set(xscale="log", yscale="log", xlabel="seconds a frame", ylabel=ylabel, title=title)
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(plain))
        axis.set_minor_formatter(NullFormatter())
    ax.grid(True, which="major", color="#e6e6e6")
    ax.set_axisbelow(True)


def curves(data):
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5))
    root = lambda v: max(v["relmse"], 1e-12) ** 0.5
    points(left, data, root)
    own = data["variants"][0]
    times = sorted(v["seconds"] for v in data["variants"])
    left.plot([times[0], times[-1]], [root(own) * (own["seconds"] / t) ** 0.5 for t in (times[0], times[-1])], "--",
              color="#aaaaaa", linewidth=1, label="slope −1/2", zorder=1)
    finish(left, "Error of radiance", "root of relative mean square error")
    points(right, data, lambda v: max(v["flip"], 1e-6))
    front = sorted((v for v in data["variants"] if v["on_front"]), key=lambda v: v["seconds"])
    right.plot([v["seconds"] for v in front], [v["flip"] for v in front], "-", color="#2e8b57", linewidth=7, alpha=0.2,
               label="Pareto front", zorder=1)
    finish(right, "Error as it looks", "FLIP (mean)")
    right.legend(fontsize=8, frameon=False)
    left.legend(*[items[-1:] for items in left.get_legend_handles_labels()], fontsize=8, frameon=False)
    return svg_of(figure)


def shares(data):
    figure, ax = plt.subplots(figsize=(12, 1.3))
    values = {name: max(value, 0) for name, value in data["shares"].items()}
    whole, left = sum(values.values()) or 1, 0
    for name, value in values.items():
        ax.barh(0, value / whole, left=left, color=SHARES[name], label=f"{name} {100 * value / whole:.0f} %")
        left += value / whole
    ax.set(xlim=(0, 1), yticks=[], xticks=[])
    for side in ax.spines.values():
        side.set_visible(False)
    ax.legend(ncol=len(values), loc="upper center", bbox_to_anchor=(0.5, -0.05), frameon=False, fontsize=10)
    return svg_of(figure)


def embedded(path):
    return "data:image/png;base64," + base64.b64encode(pathlib.Path(path).read_bytes()).decode()


def row(variant, own):
    flicker = "" if variant["flicker"] is None else f"{variant['flicker']:.4f}"
    cells = [html.escape(label(variant)), f"{variant['seconds']:.3f}", f"{variant['seconds'] / own['seconds']:.2f}" if own["seconds"] else "",
             f"{variant['flip']:.4f}", f"{variant['ssim']:.4f}", f"{variant['relmse']:.3g}", f"{variant['noise']:.3g}",
             f"{variant['bias']:.2g}", flicker]
    kind = "shot" if variant["axis"] == "shot" else "front" if variant["on_front"] else ""
    return f"<tr class='{kind}'>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


def table(data):
    own = data["variants"][0]
    heads = ["settings", "s a frame", "× own", "FLIP", "SSIM", "relMSE", "noise", "bias", "flicker"]
    rows = [row(v, own) for v in data["variants"] + [data["recommendation"]["measured"]]]
    return "<table><tr>" + "".join(f"<th>{head}</th>" for head in heads) + "</tr>" + "\n".join(rows) + "</table>"


def figure_of(sources, title, caption):
    images = "".join(f"<img src='{embedded(source)}' alt='{html.escape(title)}'>" for source in sources)
    return f"<figure>{images}<figcaption><b>{html.escape(title)}</b> {html.escape(caption)}</figcaption></figure>"


def pictures(data):
    text = [figure_of([data["reference"]["picture"]], "reference", f"{data['reference']['samples']} samples")]
    for variant in data["variants"] + [data["recommendation"]["measured"]]:
        text.append(figure_of([variant["picture"], variant["map"]], label(variant), f"{variant['seconds']:.2f} s, FLIP {variant['flip']:.4f}"))
    return "<div class='pictures'>" + "\n".join(text) + "</div>"


def page(data):
    advice, size = data["recommendation"], "×".join(map(str, data["size"]))
    left_out = "".join(f"<li>{html.escape(each['what'])}: {html.escape(each['reason'])}</li>" for each in data["left_out"])
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{html.escape(data['shot'])}: what accuracy costs</title><style>{STYLE}</style></head><body>
<h1>{html.escape(data['shot'])}: what accuracy costs</h1>
<p class="facts">Kadr {data['kadr']}, {html.escape(data['device'])}; frames {', '.join(map(str, data['frames']))} at {size} (the shot is
{'×'.join(map(str, data['shot_size']))}; time goes with the number of pixels). Every setting is the shot's own but for the one that is
named, at {data['samples']} samples a pixel.</p>
<div class="advice"><p>{html.escape(advice['text'])}</p><pre>{html.escape(advice['yaml'])}</pre>
<p class="note">Rendered with that, a frame takes {advice['measured']['seconds']:.3g} s and is off by FLIP {advice['measured']['flip']:.4f}.</p></div>
<h2>Error and time</h2>
{curves(data)}
<h2>Where the error comes from</h2>
{shares(data)}
<p class="note">Of the relative mean square error of the shot's own settings: noise is what other samples would change; the others are
what more samples would not, split by what goes away with the best value of that setting.</p>
<h2>Figures</h2>
{table(data)}
<p class="note">On green: nothing measured is both faster and closer by FLIP. Means over the frames and two independent images each.
relMSE is free of the reference's own noise ({data['reference']['noise']:.2g}); bias is measured by products of independent images and may
come out a little below zero. Flicker: how much more the display changes from frame to frame than the truth does.</p>
{'<h2>Not measured</h2><ul>' + left_out + '</ul>' if left_out else ''}
<h2>Pictures</h2>
{pictures(data)}
</body></html>
"""


def main():
    data = json.loads(pathlib.Path(sys.argv[1]).read_text())
    plt.rcParams.update({"font.family": "sans-serif", "axes.spines.top": False, "axes.spines.right": False, "svg.hashsalt": "kadr"})
    pathlib.Path(sys.argv[2]).write_text(page(data))


main()
