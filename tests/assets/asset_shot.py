"""A shot that looks at any glTF file: reads just enough of the file to place a camera in front of its bounding box."""

import json
import math
import struct
from pathlib import Path


def document(path):
    """The JSON of a .gltf or .glb file."""
    data = Path(path).read_bytes()
    if data[:4] != b"glTF":
        return json.loads(data)
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20:20 + length])


def product(a, b):
    """Of two 4 x 4 matrices in glTF's column-major order."""
    return [sum(a[4 * k + row] * b[4 * column + k] for k in range(4)) for column in range(4) for row in range(4)]


def local_matrix(node):
    if "matrix" in node:
        return node["matrix"]
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    s = node.get("scale", [1, 1, 1])
    columns = [[1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
               [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
               [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)]]
    return [v for i in range(3) for v in [*(s[i] * c for c in columns[i]), 0]] + [*node.get("translation", [0, 0, 0]), 1]


IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]


def corners(gltf, mesh):
    for primitive in gltf["meshes"][mesh]["primitives"]:
        accessor = gltf["accessors"][primitive["attributes"]["POSITION"]]
        low, high = accessor["min"], accessor["max"]
        for i in range(8):
            yield [(high if i >> axis & 1 else low)[axis] for axis in range(3)]


def world_corners(gltf):
    nodes, scenes = gltf.get("nodes", []), gltf.get("scenes", [])
    roots = scenes[gltf.get("scene", 0)].get("nodes", []) if scenes else []
    work = [(root, IDENTITY) for root in roots]
    while work:
        index, parent = work.pop()
        matrix = product(parent, local_matrix(nodes[index]))
        work += [(child, matrix) for child in nodes[index].get("children", [])]
        for p in corners(gltf, nodes[index]["mesh"]) if "mesh" in nodes[index] else []:
            yield [sum(matrix[4 * k + row] * p[k] for k in range(3)) + matrix[12 + row] for row in range(3)]


def bounds(gltf):
    """Lowest and highest corner of the default scene; a unit cube where there is no geometry."""
    points = list(world_corners(gltf)) or [[-0.5] * 3, [0.5] * 3]
    return [[pick(p[axis] for p in points) for axis in range(3)] for pick in (min, max)]


def draws_triangles(gltf):
    return any(p.get("mode", 4) >= 4 for mesh in gltf.get("meshes", []) for p in mesh["primitives"])


SHOT = """kadr: 1
name: asset
timing: {{ fps: 24, frames: {frames} }}
image: {{ size: [{width}, {height}] }}
scenes: [ {{ id: asset, gltf: {file} }} ]
camera: {{ position: {eye}, look_at: {target}, vertical_fov: 30 deg }}
shutter: 0
lights: [ {{ id: sun, type: directional, illuminance: 2 lux, direction: [-0.4, -1, -0.8] }} ]
environment: {{ color: [0.5, 0.65, 0.8], strength: 0.8, visible: false }}
render: {{ integrator: path, samples: {samples} }}
output: {{ frames: "{output}" }}
"""


def write_shot(folder, asset, gltf=None, frames="0", width=64, height=36, samples=4, direction=(0.35, 0.3, 1.0)):
    """Writes `asset.yaml`, whose camera sees the whole bounding box (the unit cube without `gltf`), into `folder`."""
    low, high = bounds(gltf or {})
    target = [(a + b) / 2 for a, b in zip(low, high)]
    radius = max(math.dist(low, high) / 2, 1e-3)
    scale = radius / math.sin(math.radians(15)) / math.hypot(*direction)
    shot = Path(folder) / "asset.yaml"
    shot.write_text(SHOT.format(file=json.dumps(str(asset)), frames=frames, width=width, height=height, samples=samples,
                                eye=[t + scale * d for t, d in zip(target, direction)], target=target,
                                output=str(Path(folder) / "{frame:04}.png")))
    return shot
