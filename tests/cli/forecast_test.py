"""The forecast of memory by kadr explain against what render takes."""

import json
import struct
import unittest
from pathlib import Path

try:
    import numpy
except ImportError:
    numpy = None

import program
from explain_test import ExplainTest, png_bytes


def write_grid(path, cells, images=0):
    """A GLB file of a wavy grid of 2 * cells^2 triangles, once for each image; or once, without any."""
    y, x = (numpy.mgrid[0:cells + 1, 0:cells + 1] / cells).astype(numpy.float32)
    positions = numpy.stack([2 * x - 1, 0.1 * numpy.sin(20 * x) * numpy.cos(17 * y), 2 * y - 1], -1).reshape(-1, 3)
    first = (numpy.arange(cells)[:, None] * (cells + 1) + numpy.arange(cells)).astype(numpy.uint32)
    a, b, c, d = first, first + 1, first + cells + 1, first + cells + 2
    blobs = [positions.tobytes(), numpy.stack([a, c, b, b, c, d], -1).tobytes(), numpy.stack([x, y], -1).tobytes()]
    views, at = [], 0
    for blob in blobs:
        views.append({"buffer": 0, "byteOffset": at, "byteLength": len(blob)})
        at += len(blob)
    count = len(positions)
    primitive = {"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1}
    gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"name": "Grid", "mesh": 0}],
            "meshes": [{"primitives": [{**primitive, "material": i} for i in range(max(images, 1))]}],
            "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0, **({"baseColorTexture": {"index": i}} if images else {})}}
                          for i in range(max(images, 1))],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3", "min": [-1, -1, -1], "max": [1, 1, 1]},
                          {"bufferView": 1, "componentType": 5125, "count": 6 * cells * cells, "type": "SCALAR"},
                          {"bufferView": 2, "componentType": 5126, "count": count, "type": "VEC2"}],
            "bufferViews": views, "buffers": [{"byteLength": at}]}
    if images:
        gltf["images"] = [{"uri": f"{i}.png"} for i in range(images)]
        gltf["textures"] = [{"source": i} for i in range(images)]
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(b"glTF" + struct.pack("<II", 2, 12 + 8 + len(text) + 8 + at) + struct.pack("<I4s", len(text), b"JSON") + text +
                     struct.pack("<I4s", at, b"BIN\0") + b"".join(blobs))


@unittest.skipUnless(numpy, "needs NumPy")
class Forecast(ExplainTest):
    """The forecast of memory against the peak of the process that renders.

    A tenth: what it says of itself. The program's own part is measured, structures go by bytes a triangle that differ by
    a tenth between meshes, and what the allocator keeps of what was freed is not forecast.
    """

    def check(self, *arguments):
        arguments = ("--device", "cpu", *arguments)
        memory = json.loads(self.run_kadr("explain", self.shot, "--json", *arguments).out)["memory"]
        peak = self.peak_bytes("render", self.shot, "--overwrite", *arguments)
        self.assertAlmostEqual(memory["bytes"] / peak, 1, delta=0.1, msg=f"{memory} against {peak}")
        self.assertEqual(sum(part["bytes"] for part in memory["parts"]) // 1000, memory["bytes"] // 1000)
        return {part["name"]: part["bytes"] for part in memory["parts"]}, memory["when"]

    def change_shot(self, before, after):
        text = self.shot.read_text()
        self.assertIn(before, text)
        self.shot.write_text(text.replace(before, after))

    def test_of_a_small_shot_is_the_program(self):
        parts, _ = self.check()
        self.assertGreater(parts["program"], 0.9 * sum(parts.values()))

    def test_of_a_large_picture_is_the_film(self):
        parts, when = self.check("--size", "2560x1440", "--frames", "0-1")
        self.assertGreater(parts["film"], 0.4 * sum(parts.values()))
        self.assertEqual(when, "a frame is finished and written")

    def test_of_a_large_picture_with_layers(self):
        self.change_shot(".png", ".exr")
        self.check("--size", "1920x1080", "--frames", "0", "--set", "output.aovs=[albedo, normal, depth, motion, samples]")

    def test_of_a_large_mesh_is_its_structure(self):
        write_grid(self.folder / "grid.glb", 600)
        self.change_shot("ball.gltf", "grid.glb")
        self.assertEqual(self.check("--frames", "0")[1], "structures are built")
        self.change_shot("keys: { 0 s: 0, 1 s: 360 deg }", "keys: { 0 s: 0, 1 s: 0 deg }")
        self.assertEqual(self.check("--frames", "0")[1], "structures are built")  # flattened, where it stands still

    def test_of_large_images_is_their_decoding(self):
        write_grid(self.folder / "grid.glb", 4, images=6)
        for i in range(6):
            (self.folder / f"{i}.png").write_bytes(png_bytes(2500, 2500, 40 * i))
        self.change_shot("ball.gltf", "grid.glb")
        parts, when = self.check("--frames", "0")
        self.assertEqual(when, "the files are read")
        self.assertGreater(parts["textures"], 0.3 * sum(parts.values()))

    def test_of_many_instances(self):
        copies = "gltf: ball.gltf, instances: { grid: [250, 1, 250], spacing: [3 m, 3 m, 3 m] },"
        self.change_shot("gltf: ball.gltf,", copies)
        self.change_shot("rotate: { axis: [0, 1, 0], angle: { keys: { 0 s: 0, 1 s: 360 deg } } }", "translate: { keys: { 0 s: [0, 0, 0], 1 s: [1, 0, 0] } }")
        parts, _ = self.check("--frames", "0")
        self.assertGreater(parts["instances"], 0.1 * sum(parts.values()))
        self.change_shot("1 s: [1, 0, 0]", "1 s: [0, 0, 0]")
        self.check("--frames", "0")

    def test_of_a_bending_mesh(self):
        # tests/cli has no skins of its own; the sample has.
        self.shot = Path(__file__).resolve().parents[2] / "shots" / "skin.yaml"
        self.check("--frames", "8", "--samples", "2", "--set", f"output.frames='{self.folder}/{{frame:04}}.png'", "--set", "output.video=null")


if __name__ == "__main__":
    program.main()
