#!/usr/bin/env python3
"""Writes the constant tables of the kernels: GGX albedos, what Fresnel's equations add to them, and the sRGB decoding of bytes.

  tools/make_tables.py            rewrite kernels/bsdf/albedo_tables.h, kernels/bsdf/fresnel_table.h and kernels/texture/srgb_table.h
  tools/make_tables.py --check    exit 1 when the files differ from what would be written, 77 without numpy

Needs numpy (Debian: python3-numpy). Deterministic: fixed quadrature, no random numbers.
"""
import argparse
import pathlib
import re
import sys

try:
    import numpy as np
except ImportError:
    print("skipped: this Python has no numpy (Debian: apt-get install python3-numpy)", file=sys.stderr)
    sys.exit(77)

SIZE = 64
MIN_ALPHA = 1e-3  # kMinAlpha of kernels/bsdf/ggx.h
QUADRATURE = 192  # midpoints in each of two dimensions: errors below 3e-5
FRESNEL_SIZE, FRESNEL_LAYERS = 24, 24

ROOT = pathlib.Path(__file__).resolve().parent.parent


def lobe(cos_o, alpha, n=QUADRATURE):
    """(w, h.o): weights of the GGX lobe for a Fresnel term of 1, by quadrature over sampled visible normals; albedos are means.

    Visible normals by spherical caps (Dupuy & Benyoub 2023); with them f cos / pdf is F * G2 / G1.
    """
    u = (np.arange(n) + 0.5) / n
    phi, v = np.meshgrid(np.pi * u, u)  # half of the azimuths: the other half mirrors it
    # Smoothstep in v: its ends, where wi meets the horizon, get most of the points.
    v, weight = v * v * (3 - 2 * v), 6 * v * (1 - v)
    sin_o = np.sqrt(max(0.0, 1 - cos_o * cos_o))
    ox, oz = alpha * sin_o, cos_o
    length = np.hypot(ox, oz)
    ox, oz = ox / length, oz / length
    z = (1 - v) * (1 + oz) - oz
    s = np.sqrt(np.maximum(0, 1 - z * z))
    hx, hy, hz = alpha * (s * np.cos(phi) + ox), alpha * s * np.sin(phi), np.maximum(0, z + oz)
    norm = np.sqrt(hx * hx + hy * hy + hz * hz)
    hx, hz = hx / norm, hz / norm
    h_o = hx * sin_o + hz * cos_o
    cos_i = 2 * h_o * hz - cos_o
    a2 = alpha * alpha
    root_o = np.sqrt(a2 + (1 - a2) * cos_o * cos_o)
    root_i = np.sqrt(a2 + (1 - a2) * cos_i * cos_i)
    below = cos_i <= 0
    ci = np.where(below, 1.0, cos_i)
    g = np.where(below, 0.0, ci * (cos_o + root_o) / (ci * root_o + cos_o * root_i))
    return g * weight, np.clip(h_o, 0, 1)


def albedo(cos_o, alpha):
    """(E, B): GGX albedos for Fresnel terms 1 and (1 - h.o)^5."""
    g, h_o = lobe(cos_o, alpha)
    return g.mean(), (g * (1 - h_o) ** 5).mean()


def fresnel_excess(x, root_f0):
    """What Fresnel's equations give for a dielectric beyond Schlick's term, as in kernels/bsdf/fresnel.h."""
    k = 1 - root_f0
    total = np.maximum(np.sqrt(4 * root_f0 + (k * x) ** 2) + k * x, 1e-30)
    difference = 4 * root_f0 / total
    b = (x * total - k) / np.maximum(x * difference + k, 1e-30)
    exact = 0.5 * (difference / total) ** 2 * (1 + b * b)
    return exact - (root_f0 ** 2 + (1 - root_f0 ** 2) * (1 - x) ** 5)


def fresnel_table():
    """[f0][alpha][cosine]: f0^(1/8) even in [0, 1], the others as in grid()."""
    s, q = grid(FRESNEL_SIZE)
    roots = (np.arange(FRESNEL_LAYERS) / (FRESNEL_LAYERS - 1)) ** 4
    table = np.zeros((FRESNEL_LAYERS, FRESNEL_SIZE, FRESNEL_SIZE))
    for j in range(FRESNEL_SIZE):
        for i in range(FRESNEL_SIZE):
            g, h_o = lobe(max(s[i] ** 4, 1e-7), q[j] ** 4)
            table[:, j, i] = [(g * fresnel_excess(h_o, root)).mean() for root in roots]
    return table


def grid(size=SIZE):
    """cos = s^4 with s even in [0, 1]; alpha = q^4 with q even in [MIN_ALPHA^(1/4), 1].

    Albedos change where cos is about alpha: in (s, q) that is a band along the diagonal, and fourth roots leave it several
    cells wide down to the smallest alpha. Bilinear errors are then below 0.3 %, below 0.1 % where cos > 0.05.
    """
    s = np.arange(size) / (size - 1)
    q0 = MIN_ALPHA ** 0.25
    return s, q0 + (1 - q0) * s


def albedo_tables():
    s, q = grid()
    e, b = np.zeros((SIZE, SIZE)), np.zeros((SIZE, SIZE))
    for j in range(SIZE):
        for i in range(SIZE):
            e[j, i], b[j, i] = albedo(max(s[i] ** 4, 1e-7), q[j] ** 4)
    return e, b


def c_array(name, values, comment):
    numbers = [f"{round(x, 7) + 0.0:.7f}f" for x in np.asarray(values).ravel()]  # no -0
    rows = [", ".join(numbers[i:i + 8]) for i in range(0, len(numbers), 8)]
    body = ",\n    ".join(rows)
    return f"/// {comment}\nSHARED_TABLE float {name}[{len(numbers)}] = {{\n    {body}}};\n"


def header(title, *arrays):
    return f"// {title}\n// Written by tools/make_tables.py.\n// clang-format off\n#pragma once\n\n#include \"kernels/math/platform.h\"\n\nnamespace kadr::kernels {{\n\n" + "\n".join(arrays) + \
        "\n}  // namespace kadr::kernels\n"


def albedo_header():
    e, b = albedo_tables()
    return header(
        "Directional albedos of the GGX reflection lobe (Smith, height-correlated).",
        f"inline constexpr int kAlbedoTableSize = {SIZE};\n/// Fourth root of the smallest alpha: where the roughness axis starts.\ninline constexpr float kAlbedoTableStart = {MIN_ALPHA ** 0.25:.9f}f;\n",
        c_array("kAlbedoWhite", e, "[roughness][cosine], Fresnel 1. Axes: alpha^(1/4) even in [kAlbedoTableStart, 1], cosine^(1/4) even in [0, 1]."),
        c_array("kAlbedoSchlick", b, "[roughness][cosine], Fresnel (1 - h.o)^5."))


def fresnel_header():
    return header(
        "What Fresnel's equations for dielectrics add to the albedo of the GGX lobe with Schlick's term.",
        f"inline constexpr int kFresnelTableSize = {FRESNEL_SIZE}, kFresnelTableLayers = {FRESNEL_LAYERS};\n/// Fourth root of the smallest alpha: where the roughness axis starts.\ninline constexpr float kFresnelTableStart = {MIN_ALPHA ** 0.25:.9f}f;\n",
        c_array("kFresnelExcess", fresnel_table(), "[f0][roughness][cosine]. Axes: f0^(1/8) even in [0, 1], alpha^(1/4) even in [kFresnelTableStart, 1], cosine^(1/4) even in [0, 1]."))


def srgb_header():
    x = np.arange(256) / 255.0
    return header("The sRGB transfer of 8-bit values (IEC 61966-2-1).",
                  c_array("kSrgbToLinear", np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4), "Linear value of a byte."))


FILES = {"kernels/bsdf/albedo_tables.h": albedo_header, "kernels/bsdf/fresnel_table.h": fresnel_header, "kernels/texture/srgb_table.h": srgb_header}


NUMBER = re.compile(r"\d+\.\d+f")


def same(a, b):
    """Equal texts, but for the last digit of a number: sines differ by an ulp between versions of numpy."""
    x, y = ([float(n[:-1]) for n in NUMBER.findall(t)] for t in (a, b))
    return NUMBER.sub("", a) == NUMBER.sub("", b) and len(x) == len(y) and all(abs(p - q) < 3e-7 for p, q in zip(x, y))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare instead of writing")
    check = parser.parse_args().check
    stale = False
    for name, make in FILES.items():
        path, text = ROOT / name, make()
        if check and not (path.exists() and same(path.read_text(), text)):
            print(f"{name} is not what tools/make_tables.py writes", file=sys.stderr)
            stale = True
        if not check:
            path.write_text(text)
    sys.exit(1 if stale else 0)


if __name__ == "__main__":
    main()
