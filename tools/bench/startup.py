#!/usr/bin/env python3
"""How fast kadr answers and how much memory it takes, as whole processes.

  tools/bench/startup.py --kadr BUILD/src/cli/kadr [--instances] [--output report.json]

check      seconds of `kadr check shots/turntable.yaml`, without a video (so without ffmpeg's probe)
first ray  seconds from start to the first traced ray on the peers' spheres: of a 1 × 1 frame with one sample, what kadr itself
           reports for loading and for building the scene, and the wall time of the whole process, an upper bound, because it
           holds opening the image module, writing the image and the end of the process too
preview    seconds of `kadr preview` of a 100 k-triangle scene at 640×360
memory     peak resident memory of spheres at 640×360 with 4 samples
instances  (with --instances) a scene of 100 instances of a 0.5 M-triangle mesh, made here: CPU seconds and memory at 640×360
"""
import argparse
import json
import math
import os
import pathlib
import statistics
import struct
import sys
import tempfile
from array import array

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from peers import ROOT, machine, timed, write_shot  # noqa: E402


def big_mesh_glb(path, rings=500, segments=500, count=100):
    """`count` nodes of one wavy sphere of 2 × rings × segments triangles."""
    position, index = array("f"), array("I")
    for i in range(rings + 1):
        a = math.pi * i / rings
        for j in range(segments + 1):
            b = 2 * math.pi * (j % segments) / segments
            r = 0.42 * (1 + 0.04 * math.sin(9 * a) * math.sin(9 * b))
            position.extend((r * math.sin(a) * math.sin(b), r * math.cos(a), r * math.sin(a) * math.cos(b)))
    for i in range(rings):
        for j in range(segments):
            k = i * (segments + 1) + j
            index.extend((k, k + segments + 1, k + segments + 2, k, k + segments + 2, k + 1))
    side = int(math.sqrt(count))
    nodes = [{"mesh": 0, "translation": [k % side - (side - 1) / 2, 0, k // side - (side - 1) / 2]} for k in range(count)]
    p, q = position.tobytes(), index.tobytes()
    gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(count))}], "nodes": nodes,
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
            "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.5, 0.3, 1], "metallicFactor": 0, "roughnessFactor": 0.4}}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(position) // 3, "type": "VEC3", "min": [-0.45] * 3, "max": [0.45] * 3},
                          {"bufferView": 1, "componentType": 5125, "count": len(index), "type": "SCALAR"}],
            "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(p)}, {"buffer": 0, "byteOffset": len(p), "byteLength": len(q)}],
            "buffers": [{"byteLength": len(p) + len(q)}]}
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 28 + len(text) + len(p) + len(q)) + struct.pack("<II", len(text), 0x4E4F534A) + text
                     + struct.pack("<II", len(p) + len(q), 0x004E4942) + p + q)


INSTANCES_SHOT = """kadr: 1
timing: { frames: 0 }
image: { size: [640, 360] }
scenes: [ { id: field, gltf: field.glb } ]
camera: { position: [0, 4, 9], look_at: [0, 0, 0], focal_length: 35 mm }
shutter: 0
lights: [ { type: directional, illuminance: 3 lux, direction: [-1, -2, -1] } ]
environment: { color: [0.3, 0.4, 0.6] }
render: { integrator: path, samples: 16, bounces: { total: 4 }, filter: { type: box, width: 1 px } }
output: { frames: "field.{frame:04}.exr" }
"""


def median_run(command, rounds):
    rows = [timed(command)[1] for _ in range(rounds)]
    return {k: statistics.median(r[k] for r in rows) for k in rows[0]}


def median_first_ray(command, rounds):
    """The stages of the job before the first ray; the loader's share before main comes on top (`kadr --version`: 0.01 s)."""
    rows = []
    for _ in range(rounds):
        text, figures = timed(command)
        stages = json.loads(text.splitlines()[-1])["seconds"]
        rows.append({"wall_s": stages["load"] + stages["scene"], "cpu_s": figures["cpu_s"], "peak_mib": figures["peak_mib"]})
    return {k: statistics.median(r[k] for r in rows) for k in rows[0]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kadr", type=pathlib.Path, default=ROOT / "build" / "release" / "src" / "cli" / "kadr")
    parser.add_argument("--peers", type=pathlib.Path, default=pathlib.Path(os.environ.get("KADR_PEERS", ROOT.parent / "shared" / "peers")))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--instances", action="store_true")
    parser.add_argument("--output", type=pathlib.Path)
    options = parser.parse_args()
    kadr, peers = options.kadr.resolve(), options.peers.resolve()
    if not kadr.exists():
        parser.error(f"no program at {kadr}; give --kadr")
    report = {}
    with tempfile.TemporaryDirectory(prefix="kadr-startup-") as name:
        folder = pathlib.Path(name)
        # The same shot without its video, beside its assets, so that ffmpeg is not asked.
        lines = [t for t in (ROOT / "shots" / "turntable.yaml").read_text().splitlines() if not t.strip().startswith("video:")]
        still = folder / "turntable.yaml"
        still.write_text("\n".join(lines).replace("assets/", f"{ROOT}/shots/assets/") + "\n")
        report["check turntable"] = median_run([kadr, "check", still], options.rounds)
        report["preview light_sweep, 111 k triangles"] = median_run(
            [kadr, "preview", ROOT / "shots" / "light_sweep.yaml", "--frame", "10", "--size", "640x360", "--output", folder / "still.png"], 3)
        if (peers / "scenes").is_dir():
            tiny = write_shot(folder, peers, "spheres", (1, 1), 1, 4, 0, folder / "tiny.exr")
            report["first ray on spheres"] = median_first_ray([kadr, "render", tiny, "--overwrite", "--json"], options.rounds)
            report["1 x 1 frame of spheres, whole process"] = median_run([kadr, "render", tiny, "--overwrite"], options.rounds)
            full = write_shot(folder, peers, "spheres", (640, 360), 4, 4, 0, folder / "full.exr")
            report["spheres 640x360, 4 samples"] = median_run([kadr, "render", full, "--overwrite"], 3)
        else:
            print(f"skipped spheres: no folder {peers / 'scenes'}; set KADR_PEERS")
        if options.instances:
            big_mesh_glb(folder / "field.glb")
            (folder / "field.yaml").write_text(INSTANCES_SHOT)
            report["100 instances of 0.5 M triangles"] = median_run([kadr, "render", folder / "field.yaml", "--overwrite"], 1)
    print(f"{'what':40} {'wall s':>8} {'CPU s':>8} {'MiB':>7}")
    for name, r in report.items():
        print(f"{name:40} {r['wall_s']:8.3f} {r['cpu_s']:8.3f} {r['peak_mib']:7.0f}")
    if options.output:
        options.output.write_text(json.dumps({"machine": machine(), "report": report}, indent=1) + "\n")


if __name__ == "__main__":
    main()
