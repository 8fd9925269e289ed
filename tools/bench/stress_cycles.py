#!/usr/bin/env python3
"""One generated shot of `kadr stress` by Blender's Cycles; tools/bench/stress_peers.py drives it.

  VENV/bin/python tools/bench/stress_cycles.py STRESS/NAME.yaml --samples 256 --image NAME.exr

Geometry, materials, clips and copies come through Blender's own glTF importer. What the shot file adds (camera, lamp, environment, tracks of
nodes) is set as a careful user of Blender would: clipping planes as wide as they go, lamps without size, keys with linear interpolation, motion
steps at their maximum. Clamps, thresholds and denoising are off, as in a plain path tracer.
Lamps are in the importer's COMPAT units: a point of I candela lights by I / d², a sun of E lux by E.

Writes a linear EXR and prints one JSON line: seconds of rendering, and the notes, each a property that Blender keeps from taking the shot's value.
Exit code 3: the shot has what Blender cannot express; the JSON line says what.
"""
import argparse
import contextlib
import json
import math
import os
import pathlib
import sys
import time
import warnings
from fractions import Fraction

import bpy
import yaml
from mathutils import Quaternion, Vector

FRAME_LIMIT = 1048574      # Blender's
MOST_MOTION_STEPS = 7      # 2^7 + 1 transforms over the shutter
NEAREST, FARTHEST = 1e-6, 1e30
BOUNCES = 8


class Inexpressible(Exception):
    """Something that Blender has no value for."""


@contextlib.contextmanager
def quiet():
    """Blender prints its progress on the C level's standard output."""
    sys.stdout.flush()
    saved, null = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(saved, 1)
        os.close(saved), os.close(null)


def number(text):
    """Of a value with or without a unit: "0.5 s", "20 deg", 1e-09."""
    return float(str(text).split()[0])


def z_up(v):
    """glTF's +y is up, Blender's +z."""
    x, y, z = (float(c) for c in v)
    return Vector((x, -z, y))


def z_up_rotation(q):
    x, y, z, w = (float(c) for c in q)
    return Quaternion((w, x, -z, y))


def z_up_scale(s):
    x, y, z = (float(c) for c in s)
    return Vector((x, z, y))


def set_noted(owner, name, value, notes):
    """Sets a property and notes where Blender holds it at a limit."""
    setattr(owner, name, value)
    is_now = getattr(owner, name)
    if not math.isclose(is_now, value, rel_tol=1e-4, abs_tol=1e-30):
        notes.append(f"Blender holds {owner.bl_rna.name.lower()}.{name} at {is_now:.4g}, not {value:.4g}")


def set_frame_rate(scene, timing):
    rate = Fraction(str(timing["fps"]))
    scene.render.fps, scene.render.fps_base = (int(rate), 1) if rate >= 1 else (1, float(1 / rate))
    return float(rate)


def look_rotation(forward):
    """Of a camera or lamp, which look along their own -z, with +y up.

    @param forward  in glTF's axes, of any length: Blender's vectors are floats, in which those of nearby points cancel
    """
    length = math.hypot(*forward)
    return z_up([c / length for c in forward]).to_track_quat("-Z", "Y")


def place(scene, name, data, position, forward):
    item = bpy.data.objects.new(name, data)
    item.rotation_mode = "QUATERNION"
    item.location, item.rotation_quaternion = z_up(position), look_rotation(forward)
    scene.collection.objects.link(item)
    return item


def add_camera(scene, shot, gltf, notes):
    if "gltf" in shot["camera"]:
        item = next(o for o in scene.objects if o.type == "CAMERA")
        fov = next(c["perspective"]["yfov"] for c in gltf["cameras"])
    else:
        position, look_at = ([float(c) for c in shot["camera"][key]] for key in ("position", "look_at"))
        item = place(scene, "Camera", bpy.data.cameras.new("Camera"), position, [b - a for a, b in zip(position, look_at)])
        fov = math.radians(number(shot["camera"]["vertical_fov"]))
    lens = item.data
    lens.sensor_fit = "VERTICAL"
    # The property `angle`, which the importer sets, ends at 0.37 and 173 degrees, and the focal length at 1 mm; the sensor goes further.
    half = math.tan(0.5 * fov)
    lens.sensor_height = max(lens.sensor_height, 2 * half)
    set_noted(lens, "lens", 0.5 * lens.sensor_height / half, notes)
    lens.clip_start, lens.clip_end = NEAREST, FARTHEST
    scene.camera = item


def make_lamp(light, notes):
    kind = light["type"]
    lamp = bpy.data.lights.new("Key", {"directional": "SUN", "point": "POINT", "spot": "SPOT", "area": "AREA"}[kind])
    if kind == "directional":
        set_noted(lamp, "energy", number(light["illuminance"]), notes)
        lamp.angle = math.radians(number(light.get("angular_diameter", 0)))
        return lamp
    if kind == "area":
        lamp.shape = "RECTANGLE"
        lamp.size, lamp.size_y = (number(side) for side in light["size"])
        set_noted(lamp, "energy", math.pi * number(light["luminance"]) * number(light["size"][0]) * number(light["size"][1]), notes)
        return lamp
    set_noted(lamp, "energy", 4 * math.pi * number(light["intensity"]), notes)
    set_noted(lamp, "shadow_soft_size", number(light.get("radius", 0)), notes)
    lamp.use_soft_falloff = False
    if "range" in light:
        raise Inexpressible("a range of a lamp: the importer leaves it out")
    if kind == "spot":
        inner, outer = (math.radians(number(light[key])) for key in ("inner", "outer"))
        lamp.spot_size, lamp.spot_blend = 2 * outer, 1 - inner / outer
    return lamp


def add_lamps(scene, shot, notes):
    for light in shot["lights"] or []:
        place(scene, "Key", make_lamp(light, notes), light.get("position", (0, 0, 0)), [float(c) for c in light.get("direction", (0, -1, 0))])


def add_environment(scene, shot, folder):
    environment = shot["environment"]
    world = scene.world = bpy.data.worlds.new("Sky")
    with warnings.catch_warnings(action="ignore"):
        world.use_nodes = True  # 5.0 still needs it, and warns of 6.0
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = next(n for n in nodes if n.type == "BACKGROUND")
    background.inputs["Strength"].default_value = float(environment.get("strength", 1))
    if "image" not in environment:
        background.inputs["Color"].default_value = (*(float(c) for c in environment["color"]), 1)
        return
    image, turn, direction = (nodes.new(f"ShaderNode{kind}") for kind in ("TexEnvironment", "Mapping", "TexCoord"))
    image.image = bpy.data.images.load(str(folder / environment["image"]))
    turn.inputs["Rotation"].default_value = (0, 0, -0.5 * math.pi)  # the image's middle is at glTF's -z, for Blender at +x
    links.new(direction.outputs["Generated"], turn.inputs["Vector"])
    links.new(turn.outputs["Vector"], image.inputs["Vector"])
    links.new(image.outputs["Color"], background.inputs["Color"])


def insert_keys(item, path, track, fps, value_of):
    for time_of, value in track["keys"].items():
        setattr(item, path, value_of(value))
        item.keyframe_insert(path, frame=number(time_of) * fps)


def curves_of(item):
    data = item.animation_data
    bag = data.action.layers[0].strips[0].channelbag(data.action_slot)
    return bag.fcurves if bag else []


def move_node(item, node, fps):
    if "translate" in node:
        insert_keys(item, "location", node["translate"], fps, z_up)
    if "scale" in node:
        insert_keys(item, "scale", node["scale"], fps, z_up_scale)
    if "angle" in node.get("rotate", {}):
        item.rotation_mode = "AXIS_ANGLE"
        axis = z_up(node["rotate"]["axis"])
        insert_keys(item, "rotation_axis_angle", node["rotate"]["angle"], fps, lambda angle: (math.radians(number(angle)), *axis))
    elif "rotate" in node:
        item.rotation_mode = "QUATERNION"
        insert_keys(item, "rotation_quaternion", node["rotate"], fps, z_up_rotation)
    for curve in curves_of(item):
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"


def set_motion(scene, shot, fps):
    for name, node in shot["scenes"][0].get("nodes", {}).items():
        move_node(scene.objects[name], node, fps)
    shutter_s = number(shot["shutter"]["time"]) if shot["shutter"] else 0
    scene.render.use_motion_blur = shutter_s > 0
    if shutter_s > 0:
        scene.render.motion_blur_shutter, scene.render.motion_blur_position = shutter_s * fps, "START"
        for item in scene.objects:
            item.cycles.motion_steps = MOST_MOTION_STEPS
    frame = int(shot["timing"]["frames"])
    if abs(frame) > FRAME_LIMIT:
        raise Inexpressible(f"frame {frame}: Blender's last one is {FRAME_LIMIT}")
    scene.frame_set(frame)


def set_renderer(scene, shot, options, notes):
    render, cycles = scene.render, scene.cycles
    render.engine, cycles.device = "CYCLES", "CPU"
    for side, pixels in zip(("resolution_x", "resolution_y"), shot["image"]["size"]):
        set_noted(render, side, pixels, notes)
    render.resolution_percentage = 100
    render.use_compositing = render.use_sequencer = False
    render.threads_mode, render.threads = "FIXED", options.threads
    form = render.image_settings
    form.file_format, form.color_depth, form.color_mode = "OPEN_EXR", "32", "RGB"
    scene.view_settings.view_transform = "Raw"
    set_noted(scene.view_settings, "exposure", float(shot["view"]["exposure"]), notes)  # not of the EXR, which stays linear
    render.filepath = str(options.image.resolve())
    cycles.samples, cycles.seed, cycles.time_limit = options.samples, options.seed, 0
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = BOUNCES
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_light_tree = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = cycles.light_sampling_threshold = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True


def render(options):
    notes = []
    shot = yaml.safe_load(options.shot.read_text())
    folder = options.shot.parent
    file = folder / shot["scenes"][0]["gltf"]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    fps = set_frame_rate(scene, shot["timing"])  # before the import, which turns seconds into frames
    bpy.ops.import_scene.gltf(filepath=str(file.resolve()), export_import_convert_lighting_mode="COMPAT")
    add_camera(scene, shot, json.loads(file.read_text()), notes)
    add_lamps(scene, shot, notes)
    add_environment(scene, shot, folder)
    set_renderer(scene, shot, options, notes)
    set_motion(scene, shot, fps)
    start = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    return {"seconds": time.perf_counter() - start, "notes": notes}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("shot", type=pathlib.Path)
    parser.add_argument("--image", type=pathlib.Path, required=True)
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    try:
        with quiet():
            result = render(options)
    except Inexpressible as reason:
        print(json.dumps({"inexpressible": str(reason)}))
        sys.exit(3)
    print(json.dumps(result))


if __name__ == "__main__":
    main()
