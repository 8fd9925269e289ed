#!/usr/bin/env python3
"""The committed .glb files are what tools/make_assets.py makes; they are small; and the comparison notices a change."""
import importlib.util
import pathlib
import struct
import sys

ROOT = pathlib.Path(sys.argv[1])
LIMIT = 20 * 2 ** 20   # bytes of all assets together: a clone stays small

try:
    spec = importlib.util.spec_from_file_location("make_assets", ROOT / "tools" / "make_assets.py")
    assets = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(assets)
except ModuleNotFoundError as missing:
    print(f"skipped: {missing}; install python3-numpy")
    sys.exit(77)

failures = []


def expect(truth, message):
    if not truth:
        failures.append(message)


files = sorted((ROOT / "shots" / "assets").glob("*.glb"))
expect(sorted(f.stem for f in files) == sorted(assets.MAKERS), f"shots/assets holds {[f.stem for f in files]}, the script makes {sorted(assets.MAKERS)}")
expect(sum(f.stat().st_size for f in files) < LIMIT, f"the assets are larger than {LIMIT} bytes together")
for name, make in assets.MAKERS.items():
    found = (ROOT / "shots" / "assets" / f"{name}.glb").read_bytes()
    made = make()
    reason = assets.difference(made, found)
    expect(reason is None, f"{name}.glb: {reason}; run tools/make_assets.py {name} and commit the file")
    # One float moved by a tenth must be seen.
    view = assets.parts_of(found)[0]["bufferViews"][assets.parts_of(found)[0]["accessors"][0]["bufferView"]]["byteOffset"]
    at = 20 + struct.unpack("<I", found[12:16])[0] + 8 + view
    moved = found[:at] + struct.pack("<f", struct.unpack("<f", found[at:at + 4])[0] + 0.1) + found[at + 4:]
    expect(assets.difference(moved, found) is not None, f"{name}: a moved vertex goes unnoticed")

expect(assets.MAKERS["studio"]() == assets.MAKERS["studio"](), "studio: two runs differ")
print("\n".join(failures) or f"{len(files)} assets are as the script makes them")
sys.exit(1 if failures else 0)
