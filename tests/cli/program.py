"""What the command-line tests share: the program under test, a tiny shot, and a reader of the PNG files it writes."""

import base64
import json
import os
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

KADR = os.environ.get("KADR_PROGRAM", "")
BUILD = ""
CMAKE = "cmake"


def main():
    """Runs the tests of the calling file: FILE KADR BUILD CMAKE [unittest's arguments]."""
    global KADR, BUILD, CMAKE
    here = sys.modules["program"]
    here.KADR, here.BUILD, here.CMAKE = sys.argv[1:4]
    unittest.main(module="__main__", argv=[sys.argv[0], *sys.argv[4:]])


def icosphere():
    """Positions and indices of an icosahedron: cheap, round enough to shade differently everywhere."""
    golden = (1 + 5 ** 0.5) / 2
    positions = [(-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0), (0, -1, golden), (0, 1, golden),
                 (0, -1, -golden), (0, 1, -golden), (golden, 0, -1), (golden, 0, 1), (-golden, 0, -1), (-golden, 0, 1)]
    indices = [0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3, 9, 4, 3,
               4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9, 4, 9, 5, 2, 4, 11, 6, 2, 10, 8, 6, 7, 9, 8, 1]
    return positions, indices


def write_gltf(path):
    positions, indices = icosphere()
    data = b"".join(struct.pack("<3f", *p) for p in positions) + struct.pack(f"<{len(indices)}H", *indices)
    at = 12 * len(positions)
    gltf = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"name": "Ball", "mesh": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.4, 0.2, 1], "metallicFactor": 0,
                                                "roughnessFactor": 0.6}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3",
             "min": [min(p[i] for p in positions) for i in range(3)],
             "max": [max(p[i] for p in positions) for i in range(3)]},
            {"bufferView": 1, "componentType": 5123, "count": len(indices), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": at},
                        {"buffer": 0, "byteOffset": at, "byteLength": len(data) - at}],
        "buffers": [{"byteLength": len(data),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
    }
    path.write_text(json.dumps(gltf))


SHOT = """kadr: 1
name: ball
timing: {{ fps: 24, frames: 0-{last} }}
image: {{ size: [{width}, {height}] }}
scenes:
  - {{ id: ball, gltf: ball.gltf, transform: {{ rotate: {{ axis: [0, 1, 0], angle: {{ keys: {{ 0 s: 0, 1 s: 360 deg }} }} }} }} }}
camera: {{ position: [0, 1, 6], look_at: [0, 0, 0] }}
lights:
  - {{ id: key, type: point, intensity: 60 cd, position: [3, 4, 3] }}
environment: {{ color: [0.2, 0.3, 0.4], strength: 1 }}
render: {{ integrator: path, samples: {samples}, bounces: {{ total: 2 }} }}
output:
  frames: "out/{{name}}.{{frame:04}}.png"
{more}"""


class ProgramTest(unittest.TestCase):
    denoiser = "/nowhere/libOpenImageDenoise.so.2"   # the library that the program is told to open

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.folder = Path(self._folder.name)
        self.addCleanup(self._folder.cleanup)
        write_gltf(self.folder / "ball.gltf")
        self.shot = self.write_shot()

    def write_shot(self, last=2, samples=4, width=48, height=32, more="", name="ball.yaml"):
        path = self.folder / name
        path.write_text(SHOT.format(last=last, samples=samples, width=width, height=height, more=more))
        return path

    def environment(self):
        return {**os.environ, "KADR_CACHE": str(self.folder / "cache"), "KADR_OIDN_LIBRARY": self.denoiser}

    def start(self, *arguments, **more):
        return subprocess.Popen([KADR, *map(str, arguments)], cwd=more.pop("cwd", self.folder), text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=self.environment(), **more)

    def run_kadr(self, *arguments, code=0, **more):
        process = self.start(*arguments, **more)
        process.out, process.err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, code, f"kadr {' '.join(map(str, arguments))}\n{process.out}{process.err}")
        return process

    def frames(self, pattern="out/*.png"):
        return sorted(path.name for path in self.folder.glob(pattern) if not path.name.startswith(".kadr"))

    def temporary_files(self):
        return sorted(str(path) for path in self.folder.rglob(".kadr*"))


def png(path):
    """Decompressed scanlines (filter bytes included) and the text chunks of a PNG file."""
    data = Path(path).read_bytes()
    at, pixels, texts = 8, b"", {}
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IDAT":
            pixels += body
        elif kind == b"tEXt":
            key, value = body.split(b"\0", 1)
            texts[key.decode("latin-1")] = value.decode("latin-1")
        at += 12 + length
    return zlib.decompress(pixels), texts


def texts_but_seconds(path):
    """Metadata apart from what depends on when and how fast a frame was rendered."""
    return {key: re.sub(r'"seconds": ?"[0-9.]+"', "", value) for key, value in png(path)[1].items() if key != "DateTime"}
