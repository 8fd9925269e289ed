#!/usr/bin/env python3
"""Kadr's motion blur against Cycles' on the same glTF scene: 100 instances that spin and bob.

  tools/bench/motion_peers.py --kadr BUILD/src/cli/kadr --python VENV/bin/python

Both render spin at 320×180, 64 samples, 4 bounces, box filter, a shutter of half a frame around the frame's time. Cycles
samples the way at the opening, the frame's time and the closing. The file's keys lie at whole frames only, and between them
Blender mixes the quaternions' components, where glTF asks for the arc at constant speed: up to 3 % less of a turn at a
quarter of the way. So the keys are first refined to quarter frames along the arc: at the times that Cycles looks at, both
then read a key, and the motion steps are the same. That the difference with the file's own keys (--keys file) is this
mixing and nothing else shows --keys mixed: Cycles gets the file as it is, Kadr the quarters that Blender makes of it.

How long a blur is cannot be read off two noisy images pixel by pixel. It is fitted: with many samples Kadr renders the
frame, the frame with a shutter that is longer and shorter by 0.1 frames, and one that opens earlier and later by 0.05.
Their differences say how each pixel changes with the length and with the place of the shutter, the image's gradient how it
changes with a shift. Least squares over all pixels then tells by how much the 64-sample image of each renderer is blurred
longer, later or farther aside; in pixels along the way of the fastest blade tip.

The scene lies in the folder that KADR_PEERS names (default: ../shared/peers beside the repository); --python is an
interpreter with bpy, numpy and OpenImageIO. Without them the tool says so and skips. Exit code 1 when a difference is
above its limit: 0.1 px, 1 % of mean radiance.
"""
import argparse
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
WIDTH, HEIGHT, FRAME, BOUNCES = 320, 180, 12, 4
SHUTTER, STEP = 0.5, 0.1            # frames
MOST_PX, MOST_MEAN = 0.1, 0.01      # the limits

SHOT = """kadr: 1
name: spin
timing: {{ fps: 24, frames: {frame} }}
image: {{ size: [{width}, {height}] }}
scenes: [ {{ id: scene, gltf: "{gltf}" }} ]
camera: {{ gltf: scene/{camera} }}
shutter: {{ open: {open}, close: {close} }}
environment: {{ color: [{background}], strength: 1 }}
render: {{ samples: {samples}, bounces: {{ total: {bounces} }}, filter: {{ type: box, width: 1 px }}, seed: {seed} }}
output: {{ frames: "{image}" }}
"""


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(0)


def run(command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{command[0]} failed:\n" + "\n".join((done.stdout + done.stderr).splitlines()[-10:]))


class Glb:
    """A binary glTF file whose accessors are floats."""

    def __init__(self, path):
        data = path.read_bytes()
        size = struct.unpack("<I", data[12:16])[0]
        self.json, self.blob = json.loads(data[20:20 + size]), data[20 + size + 8:]

    def values(self, index):
        import numpy as np
        accessor = self.json["accessors"][index]
        view, width = self.json["bufferViews"][accessor["bufferView"]], {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        at = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.frombuffer(self.blob, "<f4", accessor["count"] * width, at).reshape(-1, width).astype(float)

    def add(self, values, like):
        """A new accessor of the type of another one; its index."""
        view = {"buffer": 0, "byteOffset": len(self.blob), "byteLength": values.size * 4}
        self.blob += values.astype("<f4").tobytes()
        self.json["bufferViews"].append(view)
        self.json["accessors"].append({"bufferView": len(self.json["bufferViews"]) - 1, "componentType": 5126,
                                       "count": len(values), "type": self.json["accessors"][like]["type"],
                                       "min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()})
        return len(self.json["accessors"]) - 1

    def write(self, path):
        self.json["buffers"][0]["byteLength"] = len(self.blob)
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        path.write_bytes(struct.pack("<III", 0x46546C67, 2, 28 + len(text) + len(self.blob))
                         + struct.pack("<II", len(text), 0x4E4F534A) + text
                         + struct.pack("<II", len(self.blob), 0x004E4942) + self.blob)


def between(a, b, u, arc=True):
    """Rows of a mixed with rows of b: quaternions along the shorter arc (or by their components, then normalised), all else
    linearly."""
    import numpy as np
    if a.shape[1] != 4:
        return a + (b - a) * u
    cosine = (a * b).sum(axis=1, keepdims=True)
    if not arc:
        mixed = a + (b * np.sign(cosine) - a) * u
        return mixed / np.linalg.norm(mixed, axis=1, keepdims=True)
    b, angle = b * np.sign(cosine), np.arccos(np.minimum(np.abs(cosine), 1))
    sine = np.where(angle > 1e-6, np.sin(angle), 1)
    mixed = np.where(angle > 1e-6, (a * np.sin((1 - u) * angle) + b * np.sin(u * angle)) / sine, a)
    return mixed / np.linalg.norm(mixed, axis=1, keepdims=True)


def refine_keys(glb, arc, pieces=4):
    """Puts keys between the linear keys of every channel; quaternions as between() does."""
    import numpy as np

    def refined(values):
        steps = [between(values[:-1], values[1:], k / pieces, arc) for k in range(pieces)]
        return np.concatenate([np.stack(steps, axis=1).reshape(-1, values.shape[1]), values[-1:]])
    for sampler in glb.json["animations"][0]["samplers"]:
        assert sampler.get("interpolation", "LINEAR") == "LINEAR"
        sampler["input"] = glb.add(refined(glb.values(sampler["input"])), sampler["input"])
        sampler["output"] = glb.add(refined(glb.values(sampler["output"])), sampler["output"])


class Renderers:
    def __init__(self, options, peers, folder):
        self.options, self.peers, self.folder = options, peers, folder
        self.side = json.loads((peers / "scenes" / "spin.json").read_text())
        self.tip_px = fastest_tip_px(Glb(peers / "scenes" / "spin.glb"))
        self.kadr_scene = self.scene("kadr", {"refined": "arc", "file": None, "mixed": "components"}[options.keys])
        self.cycles_scene = self.scene("cycles", "arc" if options.keys == "refined" else None)

    def scene(self, name, between_keys):
        path = self.folder / f"{name}.glb"
        path.with_suffix(".json").write_text(json.dumps(self.side))
        glb = Glb(self.peers / "scenes" / "spin.glb")
        if between_keys:
            refine_keys(glb, between_keys == "arc")
        glb.write(path)
        return path

    def kadr(self, samples, seed, length=SHUTTER, middle=0.0):
        image = self.folder / f"kadr_{samples}_{seed}_{length}_{middle}.exr"
        shot = image.with_suffix(".yaml")
        shot.write_text(SHOT.format(frame=FRAME, width=WIDTH, height=HEIGHT, gltf=self.kadr_scene,
                                    camera=self.side["camera"], open=middle - length / 2, close=middle + length / 2,
                                    background=", ".join(str(x) for x in self.side["background"]), samples=samples,
                                    bounces=BOUNCES, seed=seed, image=image))
        run([self.options.kadr, "render", shot])
        return read_image(image)

    def cycles(self, samples, seed):
        image = self.folder / f"cycles_{samples}_{seed}.exr"
        run([self.options.python, self.peers / "cycles_render.py", self.cycles_scene, "--out", image,
             "--spp", samples, "--res", f"{WIDTH}x{HEIGHT}", "--frames", FRAME, "--max-bounces", BOUNCES,
             "--motion-blur", SHUTTER, "--shutter-position", "CENTER", "--seed", seed])
        return read_image(image)


def read_image(path):
    import OpenImageIO
    return OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.FLOAT)[:, :, :3].mean(axis=2).astype(float)


def fastest_tip_px(glb):
    """Pixels that the fastest vertex's circle passes in a frame: its angle times its radius, at the instance's distance."""
    import numpy as np
    gltf = glb.json
    camera = next(node for node in gltf["nodes"] if "camera" in node)
    focal_px = 0.5 * HEIGHT / np.tan(0.5 * gltf["cameras"][camera["camera"]]["perspective"]["yfov"])
    fastest = 0
    for channel in gltf["animations"][0]["channels"]:
        if channel["target"]["path"] != "rotation":
            continue
        node = gltf["nodes"][channel["target"]["node"]]
        sampler = gltf["animations"][0]["samplers"][channel["sampler"]]
        turns = glb.values(sampler["output"])
        cosine = np.abs((turns[FRAME - 2] * turns[FRAME - 1]).sum()) / np.linalg.norm(turns[FRAME - 2]) / np.linalg.norm(turns[FRAME - 1])
        mesh = gltf["meshes"][node["mesh"]]["primitives"][0]
        radius = np.linalg.norm(glb.values(mesh["attributes"]["POSITION"]), axis=1).max() * node["scale"][0]
        distance = np.linalg.norm(np.array(node["translation"]) - np.array(camera["translation"]))
        fastest = max(fastest, 2 * np.arccos(min(cosine, 1)) * radius * focal_px / distance)
    return fastest


def derivatives(kadr, samples):
    """The frame with many samples, and how it changes with the shutter's length and middle (frames), x and y (pixels)."""
    import numpy as np
    middle = kadr(samples, 101)
    longer, shorter = kadr(samples, 102, length=SHUTTER + STEP), kadr(samples, 102, length=SHUTTER - STEP)
    later, earlier = kadr(samples, 103, middle=STEP / 2), kadr(samples, 103, middle=-STEP / 2)
    down, aside = np.gradient(middle)
    return middle, np.stack([(longer - shorter) / (2 * STEP), (later - earlier) / STEP, -aside, -down])


def fitted(image, middle, changes):
    """By how much an image's shutter is longer and later, and how far it is shifted; and the standard errors."""
    import numpy as np
    # The frame's edge has one-sided gradients only.
    a = changes[:, 1:-1, 1:-1].reshape(4, -1).T
    b = (image - middle)[1:-1, 1:-1].ravel()
    solution, rest, _, _ = np.linalg.lstsq(a, b, rcond=None)
    error = np.sqrt(np.diag(np.linalg.inv(a.T @ a)) * rest[0] / (len(b) - 4))
    return solution, error


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kadr", required=True, type=pathlib.Path)
    parser.add_argument("--python", required=True, type=pathlib.Path, help="interpreter with bpy, numpy and OpenImageIO")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--reference-samples", type=int, default=512)
    parser.add_argument("--keys", choices=("refined", "file", "mixed"), default="refined",
                        help="quarter frames along the arc for both; the file's own for both; Blender's mix of them for Kadr")
    parser.add_argument("--output", type=pathlib.Path, help="JSON report")
    options = parser.parse_args()
    peers = pathlib.Path(os.environ.get("KADR_PEERS", ROOT.parent / "shared" / "peers")).resolve()
    if not (peers / "scenes" / "spin.glb").exists():
        skip(f"{peers} has no scenes/spin.glb; set KADR_PEERS")
    if not options.python.exists():
        skip(f"{options.python} does not exist")
    if pathlib.Path(sys.executable) != options.python.absolute():
        os.execv(options.python, [str(options.python), *sys.argv])  # numpy and OpenImageIO live there
    with tempfile.TemporaryDirectory() as folder:
        report = compare(Renderers(options, peers, pathlib.Path(folder)), options)
    print(json.dumps(report, indent=2))
    if options.output:
        options.output.write_text(json.dumps(report, indent=2) + "\n")
    sys.exit(0 if report["within_limits"] else 1)


def compare(renderers, options):
    middle, changes = derivatives(renderers.kadr, options.reference_samples)
    tip_px = renderers.tip_px
    images = {"kadr": renderers.kadr(options.samples, 1), "cycles": renderers.cycles(options.samples, 1)}
    report = {"keys": renderers.options.keys, "frame": FRAME, "samples": options.samples, "shutter_frames": SHUTTER, "tip_px_per_frame": round(tip_px, 2),
              "mean": {name: image.mean() for name, image in images.items()}}
    units = (tip_px, tip_px, 1, 1)  # frames to pixels of the fastest tip; pixels
    for name, image in images.items():
        solution, error = fitted(image, middle, changes)
        report[name] = {key: [round(value * unit, 4), round(e * unit, 4)]
                        for key, value, e, unit in zip(("extent_px", "delay_px", "right_px", "down_px"), solution, error, units)}
    apart = {key: round(abs(report["cycles"][key][0] - report["kadr"][key][0]), 4) for key in report["kadr"]}
    brightness = report["mean"]["cycles"] / report["mean"]["kadr"] - 1
    report.update(differences=apart, mean_difference=round(brightness, 5), limits={"px": MOST_PX, "mean": MOST_MEAN},
                  within_limits=bool(max(apart.values()) <= MOST_PX and abs(brightness) <= MOST_MEAN))
    return report


if __name__ == "__main__":
    main()
