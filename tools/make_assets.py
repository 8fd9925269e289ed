#!/usr/bin/env python3
"""Makes the glTF files of the sample shots, geometry and textures, from nothing but the modules in tools/assets.

  tools/make_assets.py                 write shots/assets/*.glb
  tools/make_assets.py room street     write these alone
  tools/make_assets.py --check         make all in memory and compare with the files in shots/assets

Every module of tools/assets that holds a table MAKERS, {file name: function that returns the bytes}, adds its files. Needs
Python 3.9 and numpy (apt: python3-numpy). `--check` compares decoded values, because another numpy or zlib may differ in a
last bit.
"""
import argparse
import importlib
import json
import pathlib
import pkgutil
import struct
import sys

import numpy as np

TOOLS = pathlib.Path(__file__).resolve().parent
ASSETS = TOOLS.parent / "shots" / "assets"

sys.dont_write_bytecode = True  # a checkout stays as it is
sys.path.insert(0, str(TOOLS))
MAKERS = {}
for module in pkgutil.iter_modules([str(TOOLS / "assets")]):
    MAKERS.update(getattr(importlib.import_module(f"assets.{module.name}"), "MAKERS", {}))
from assets.toolkit import png_pixels  # noqa: E402  (after the path is set)


# ---------------------------------------------------------------------------------------------- check

def parts_of(data):
    size = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20:20 + size]), data[20 + size + 8:]


def difference(made, found):
    """None when two .glb files hold the same, else what differs first. Floats may differ by 1e-5, texels by 2 of 255."""
    if made == found:
        return None
    (a, a_bin), (b, b_bin) = parts_of(made), parts_of(found)
    for key in sorted(set(a) | set(b)):
        if key in ("buffers", "bufferViews"):
            continue
        if not close(a.get(key), b.get(key)):
            return f"/{key} differs"
    slices = lambda j, blob: [blob[v["byteOffset"]:v["byteOffset"] + v["byteLength"]] for v in j["bufferViews"]]
    a_views, b_views = slices(a, a_bin), slices(b, b_bin)
    for i, accessor in enumerate(a["accessors"]):
        kind = {5126: "<f4", 5125: "<u4", 5123: "<u2"}[accessor["componentType"]]
        x, y = (np.frombuffer(v[accessor["bufferView"]], kind).astype(float) for v in (a_views, b_views))
        if x.shape != y.shape or np.abs(x - y).max() > (1e-5 if kind == "<f4" else 0):
            return f"/accessors/{i} differs"
    for i, image in enumerate(a.get("images", [])):
        x, y = a_views[image["bufferView"]], b_views[image["bufferView"]]
        if x != y and np.abs(png_pixels(x).astype(int) - png_pixels(y).astype(int)).max() > 2:
            return f"/images/{i} differs"
    return None


def close(a, b):
    if isinstance(a, float) or isinstance(b, float):
        return isinstance(a, (int, float)) and isinstance(b, (int, float)) and abs(a - b) <= 1e-5
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(close(a[k], b[k]) for k in a)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(close(x, y) for x, y in zip(a, b))
    return a == b


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(MAKERS)}; default: all")
    parser.add_argument("--check", action="store_true", help="compare with the files instead of writing them; exit 1 when one differs")
    parser.add_argument("--output", type=pathlib.Path, default=ASSETS, metavar="FOLDER")
    options = parser.parse_args()
    unknown = [n for n in options.names if n not in MAKERS]
    if unknown:
        parser.error(f"no asset is called {', '.join(unknown)}; there are {', '.join(MAKERS)}")
    failed = 0
    for name in options.names or MAKERS:
        data, path = MAKERS[name](), options.output / f"{name}.glb"
        triangles = sum(parts_of(data)[0]["accessors"][p["indices"]]["count"] // 3 for m in parts_of(data)[0]["meshes"] for p in m["primitives"])
        note = f"{len(data) / 2 ** 20:.2f} MiB, {triangles} triangles"
        if options.check:
            reason = difference(data, path.read_bytes()) if path.exists() else "the file is missing"
            failed += reason is not None
            print(f"{name}: {'same' if reason is None else reason + f'; run {pathlib.Path(__file__).name} {name}'}")
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
            print(f"{path.name}: {note}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
