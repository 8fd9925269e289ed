"""Every glTF file of the assets folder renders or is refused by name, and no malformed one brings the program down.

Usage: gallery_test.py KADR [ASSETS]; without ASSETS, $KADR_TEST_ASSETS, else ../shared/assets beside the sources.
"""

import os
import re
import struct
import subprocess
import sys
import tempfile
import threading
import unittest
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import asset_shot

SKIPPED = 77
KADR = sys.argv[1] if len(sys.argv) > 1 else "kadr"
ASSETS = Path(sys.argv[2] if len(sys.argv) > 2 else
              os.environ.get("KADR_TEST_ASSETS") or Path(__file__).resolve().parents[3] / "shared" / "assets").resolve()
MALFORMED = ASSETS / "malformed"

# What Kadr may leave to later, as its refusals call it: features, extensions that a file requires, newer versions of glTF.
FEATURES = re.compile(r"/extensionsRequired/\d+ is (KHR|EXT)_\w+|/asset/minVersion")
FEWEST_RENDERED = 100
CPU_SECONDS = 2.0  # for a malformed file: processor time, since other programs may hold the processors
WALL_SECONDS = 30.0
PEAK_KIB = 1 << 20
JOBS = 2


def gltf_files(folder):
    return sorted(path for path in folder.rglob("*.gl*") if path.suffix in (".gltf", ".glb"))


class Result:
    """How one run of the program ended, and what it took."""

    def __init__(self, *arguments, wall_s=WALL_SECONDS):
        with tempfile.TemporaryFile() as words:
            process = subprocess.Popen([KADR, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=words, stderr=words)
            watch = threading.Timer(wall_s, process.kill)
            watch.start()
            # wait4 alone tells the peak memory and processor time of this one child.
            _, status, usage = os.wait4(process.pid, 0)
            watch.cancel()
            self.code = process.returncode = os.waitstatus_to_exitcode(status)
            self.cpu_s, self.peak_kib = usage.ru_utime + usage.ru_stime, usage.ru_maxrss
            words.seek(0)
            self.words = words.read().decode(errors="replace").strip()

    def __str__(self):
        return f"exit code {self.code}, {self.cpu_s:.2f} CPU-s, {self.peak_kib >> 10} MiB\n{self.words}"


def is_empty(path):
    """Whether no pixel of a PNG has colour or coverage. The shots' sky is invisible to the camera, so only surfaces do."""
    data, at, packed, stride = path.read_bytes(), 8, b"", 0
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, _, depth, color = struct.unpack(">IIBB", body[:10])
            stride = width * {2: 3, 6: 4}[color] * depth // 8 + 1
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    lines = zlib.decompress(packed)
    # A line of zeros is zeros under every filter; its first byte names the filter.
    return not any(any(lines[start + 1:start + stride]) for start in range(0, len(lines), stride))


def problem_of_render(asset):
    """("rendered" or "refused", what is wrong or None)."""
    gltf = asset_shot.document(asset)
    with tempfile.TemporaryDirectory() as folder:
        result = Result("render", asset_shot.write_shot(folder, asset, gltf))
        if result.code == 2:
            return "refused", None if FEATURES.search(result.words) else f"refused for no feature's name: {result}"
        image = Path(folder) / "0000.png"
        if result.code != 0 or not image.exists():
            return "failed", str(result)
        if asset_shot.draws_triangles(gltf) and is_empty(image):
            return "rendered", f"nothing is to be seen: {result}"
    return "rendered", None


def problems_of_malformed(asset):
    with tempfile.TemporaryDirectory() as folder:
        shot = asset_shot.write_shot(folder, asset)
        results = {command: Result(command, shot) for command in ("check", "render")}
    for command, result in results.items():
        if result.code not in (0, 2):
            yield f"{command}: {result}"
        elif result.cpu_s > CPU_SECONDS or result.peak_kib > PEAK_KIB:
            yield f"{command} took more than {CPU_SECONDS:g} CPU-s or {PEAK_KIB >> 10} MiB: {result}"
        elif result.code == 2 and not result.words:
            yield f"{command}: refused without a word"
    if results["check"].code == 0 and results["render"].code == 2:
        yield f"check lets pass what render refuses: {results['render']}"


def over(files, judge):
    with ThreadPoolExecutor(JOBS) as pool:
        return list(zip(files, pool.map(judge, files)))


class GalleryTest(unittest.TestCase):
    maxDiff = None

    def report(self, problems):
        self.assertFalse(problems, "\n" + "\n".join(f"{path.relative_to(ASSETS)}: {text}" for path, text in problems))

    def test_every_asset_renders_or_is_refused_by_name(self):
        files = [path for path in gltf_files(ASSETS) if MALFORMED not in path.parents]
        verdicts = over(files, problem_of_render)
        count = {word: sum(verdict == word for _, (verdict, _) in verdicts) for word in ("rendered", "refused", "failed")}
        print(f"{len(files)} assets:", ", ".join(f"{n} {word}" for word, n in count.items()), file=sys.stderr)
        self.report([(path, problem) for path, (_, problem) in verdicts if problem])
        self.assertGreaterEqual(count["rendered"], FEWEST_RENDERED)

    def test_malformed_files_end_quickly_and_quietly(self):
        files = gltf_files(MALFORMED)
        self.assertTrue(files)
        verdicts = over(files, lambda path: list(problems_of_malformed(path)))
        print(f"{len(files)} malformed files", file=sys.stderr)
        self.report([(path, problem) for path, problems in verdicts for problem in problems])


if __name__ == "__main__":
    if not ASSETS.is_dir():
        print(f"skipped: no folder {ASSETS}; KADR_TEST_ASSETS names it")
        sys.exit(SKIPPED)
    unittest.main(argv=sys.argv[:1], verbosity=2)
