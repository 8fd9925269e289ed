#!/usr/bin/env python3
"""Makes the glTF files of the sample shots, geometry and textures, from nothing but this script.

  tools/make_assets.py                 write shots/assets/*.glb
  tools/make_assets.py room street     write these alone
  tools/make_assets.py --check         make all in memory and compare with the files in shots/assets

Needs Python 3.9 and numpy (apt: python3-numpy). Everything is deterministic: noise comes from an integer hash, never from
a random number generator. `--check` compares decoded values, because another numpy or zlib may differ in a last bit.
"""
import argparse
import json
import math
import pathlib
import struct
import sys
import zlib

import numpy as np

ASSETS = pathlib.Path(__file__).resolve().parent.parent / "shots" / "assets"
TAU = 2 * math.pi


# ---------------------------------------------------------------------------------------------- images

def png_bytes(pixels):
    """An 8-bit RGB or grey PNG of an array [row][column][channel]; each row takes the filter that suits it best."""
    height, width, channels = pixels.shape
    data = pixels.astype(np.int16)
    left, up, corner = np.zeros_like(data), np.zeros_like(data), np.zeros_like(data)
    left[:, 1:], up[1:], corner[1:, 1:] = data[:, :-1], data[:-1], data[:-1, :-1]
    guess = left + up - corner
    to_left, to_up, to_corner = abs(guess - left), abs(guess - up), abs(guess - corner)
    paeth = np.where((to_left <= to_up) & (to_left <= to_corner), left, np.where(to_up <= to_corner, up, corner))
    filtered = np.stack([(data - base) & 255 for base in (np.zeros_like(data), left, up, (left + up) // 2, paeth)])
    cost = np.abs(np.where(filtered > 127, filtered - 256, filtered)).reshape(5, height, -1).sum(axis=2)
    best = cost.argmin(axis=0)
    rows = filtered[best, np.arange(height)].astype(np.uint8).reshape(height, -1)
    raw = np.concatenate([best.astype(np.uint8)[:, None], rows], axis=1).tobytes()

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    header = struct.pack(">IIBBBBB", width, height, 8, {1: 0, 3: 2, 4: 6}[channels], 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b"")


def png_pixels(data):
    """Decodes what png_bytes wrote."""
    width, height, _, kind = struct.unpack(">IIBB", data[16:26])
    channels = {0: 1, 2: 3, 6: 4}[kind]
    at, packed = 8, b""
    while at < len(data):
        size = struct.unpack(">I", data[at:at + 4])[0]
        if data[at + 4:at + 8] == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += size + 12
    raw = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + width * channels)
    out = np.zeros((height + 1, width + 1, channels), np.int64)
    for y in range(height):
        row, kind = raw[y, 1:].reshape(width, channels).astype(np.int64), raw[y, 0]
        if kind == 0:
            out[y + 1, 1:] = row
        elif kind == 1:
            out[y + 1, 1:] = np.cumsum(row, axis=0) & 255
        elif kind == 2:
            out[y + 1, 1:] = (row + out[y, 1:]) & 255
        else:
            for x in range(width):
                a, b, c = out[y + 1, x], out[y, x + 1], out[y, x]
                if kind == 3:
                    base = (a + b) // 2
                else:
                    p = a + b - c
                    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
                    base = np.where((pa <= pb) & (pa <= pc), a, np.where(pb <= pc, b, c))
                out[y + 1, x + 1] = (row[x] + base) & 255
    return out[1:, 1:].astype(np.uint8)


def srgb(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def to_bytes(values):
    return np.clip(np.floor(values * 255 + 0.5), 0, 255).astype(np.uint8)


def color_png(linear):
    return png_bytes(to_bytes(srgb(linear)))


def metal_rough_png(metallic, roughness):
    """glTF's packing: green is roughness, blue is metallic; red is free for occlusion."""
    metallic, roughness = np.broadcast_arrays(metallic, roughness)
    return png_bytes(to_bytes(np.stack([np.ones_like(roughness), roughness, metallic], axis=-1)))


def normal_png(height, depth_px):
    """Tangent-space normals of a tileable height field; `depth_px` is the height of value 1 in pixels. +Y is up the image."""
    dx = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) * 0.5 * depth_px
    dy = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) * 0.5 * depth_px
    n = np.stack([-dx, dy, np.ones_like(dx)], axis=-1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    return png_bytes(to_bytes(n * 0.5 + 0.5))


# ---------------------------------------------------------------------------------------------- patterns

def lattice(ix, iy, seed):
    """A value in [0, 1) of every lattice point, from an integer hash (murmur's finaliser)."""
    h = (ix.astype(np.uint32) * np.uint32(0x9E3779B1)) ^ (iy.astype(np.uint32) * np.uint32(0x85EBCA77)) ^ np.uint32(seed * 0x27D4EB2F & 0xFFFFFFFF)
    h ^= h >> np.uint32(16)
    h *= np.uint32(0x85EBCA6B)
    h ^= h >> np.uint32(13)
    h *= np.uint32(0xC2B2AE35)
    h ^= h >> np.uint32(16)
    return h.astype(np.float64) / 2 ** 32


def noise(u, v, nx, ny, seed):
    """Value noise with nx × ny cells over the unit square, tileable."""
    x, y = u * nx, v * ny
    ix, iy = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    fx, fy = x - ix, y - iy
    fx, fy = fx * fx * (3 - 2 * fx), fy * fy * (3 - 2 * fy)
    at = lambda a, b: lattice((ix + a) % nx, (iy + b) % ny, seed)
    return (at(0, 0) * (1 - fx) + at(1, 0) * fx) * (1 - fy) + (at(0, 1) * (1 - fx) + at(1, 1) * fx) * fy


def fbm(u, v, nx, ny, octaves, seed):
    total, weight, norm = 0, 1.0, 0
    for k in range(octaves):
        total = total + weight * noise(u, v, nx << k, ny << k, seed + k)
        norm += weight
        weight *= 0.5
    return total / norm


def step(edge, x, width):
    """Smooth step around `edge`, `width` wide."""
    t = np.clip((x - edge) / width + 0.5, 0, 1)
    return t * t * (3 - 2 * t)


def mix(a, b, t):
    a, b = np.asarray(a, float), np.asarray(b, float)
    t = np.asarray(t)[..., None] if a.ndim == 1 or a.ndim > np.ndim(t) else t
    return a * (1 - t) + b * t


def square(size=512):
    """u (column) and v (row) of every pixel's centre."""
    c = (np.arange(size) + 0.5) / size
    return np.meshgrid(c, c)


def ceramic_textures():
    """White glaze with cobalt bands, lozenges and dots painted on; u once around the body, v from the top to the bottom."""
    u, v = square()
    px = 1 / 512

    def band(centre, half):
        return step(-half, -abs(v - centre), px * 2)
    cell = (u * 12) % 1 - 0.5
    lozenge_field = np.abs(cell) * 2 + np.abs(v - 0.5) / 0.095
    lozenge = step(-0.95, -lozenge_field, 0.05) - step(-0.66, -lozenge_field, 0.05) + step(-0.4, -lozenge_field, 0.06)
    dots = 0
    for row, shift in ((0.335, 0.0), (0.665, 0.5)):
        c = ((u * 24 + shift) % 1 - 0.5) / 24
        dots = np.maximum(dots, step(-0.011, -np.hypot(c * 2.0, (v - row)), 0.004))
    petals_cell = (u * 18) % 1 - 0.5
    petal = lambda top, way: step(0, (1 - np.abs(petals_cell) * 2.3) - ((v - top) * way / 0.11) ** 2, 0.12) * ((v - top) * way > 0)
    blue = np.clip(lozenge + dots + band(0.375, 0.006) + band(0.625, 0.006) + band(0.30, 0.009) + band(0.70, 0.009)
                   + petal(0.72, 1) + petal(0.28, -1), 0, 1)
    copper = np.clip(band(0.395, 0.004) + band(0.605, 0.004), 0, 1)
    cloud, fine = fbm(u, v, 6, 4, 4, 1), fbm(u, v, 40, 40, 2, 9)
    glaze = mix([0.80, 0.77, 0.70], [0.90, 0.88, 0.84], cloud)
    cobalt = mix([0.012, 0.035, 0.20], [0.03, 0.12, 0.42], np.clip(cloud * 1.2 + fine * 0.3 - 0.25, 0, 1))
    color = mix(glaze, cobalt, blue)
    color = mix(color, np.broadcast_to([0.92, 0.55, 0.30], color.shape), copper)
    rough = 0.10 + 0.10 * fine * (1 - blue) + 0.16 * blue
    height = blue * 0.6 + copper * 0.9 + cloud * 0.6
    return color_png(color), metal_rough_png(copper, rough * (1 - copper) + 0.22 * copper), normal_png(height, 1.6)


def brushed_textures():
    """Streaks along u: the grain a lathe or a belt leaves."""
    u, v = square()
    streak = 0.55 * noise(u, v, 4, 256, 3) + 0.3 * noise(u, v, 8, 512, 4) + 0.15 * noise(u, v, 2, 64, 5)
    stain = fbm(u, v, 5, 5, 4, 6)
    color = mix([0.86, 0.56, 0.26], [0.96, 0.72, 0.40], np.clip(0.3 + 0.5 * streak + 0.5 * (stain - 0.5), 0, 1))
    rough = 0.20 + 0.16 * streak + 0.22 * step(0.62, stain, 0.25)
    return color_png(color), metal_rough_png(np.ones_like(rough), rough), normal_png(streak, 0.7)


def wood_textures():
    """Walnut: growth rings stretched along u, pores as short dark strokes."""
    u, v = square()
    warp = fbm(u, v, 2, 6, 3, 11)
    ring = np.sin((v * 14 + warp * 5.5) * TAU)
    ring = 0.5 + 0.5 * np.sign(ring) * np.abs(ring) ** 0.7
    pore = step(0.74, noise(u, v, 24, 256, 14) * 0.6 + noise(u, v, 12, 128, 15) * 0.4, 0.12)
    tone = np.clip(0.55 * ring + 0.45 * fbm(u, v, 4, 32, 3, 13), 0, 1)
    color = mix([0.055, 0.024, 0.011], [0.23, 0.105, 0.045], tone) * (1 - 0.55 * pore[..., None])
    rough = 0.30 + 0.12 * (1 - tone) + 0.25 * pore
    return color_png(color), metal_rough_png(np.zeros_like(rough), rough), normal_png(-pore * 0.6 + tone * 0.3, 1.2)


def tile_textures(count, light, dark, grout, checker, seed):
    """count × count square tiles with bevelled edges and recessed grout."""
    u, v = square()
    ix, iy = np.floor(u * count), np.floor(v * count)
    fx, fy = np.abs(u * count % 1 - 0.5), np.abs(v * count % 1 - 0.5)
    edge = 0.5 - np.maximum(fx, fy)
    tile = step(0.022, edge, 0.012)
    pick = lattice(ix.astype(np.int64), iy.astype(np.int64), seed)
    vein = fbm(u + pick * 3.7, v + pick * 5.1, 6, 6, 4, seed + 3)
    tone = (((ix + iy) % 2) * 0.85 + pick * 0.15) if checker else pick
    color = mix(light, dark, np.clip(tone + 0.35 * (vein - 0.5), 0, 1))
    color = mix(np.broadcast_to(grout, color.shape) * (0.8 + 0.4 * fbm(u, v, 64, 64, 1, seed + 9)[..., None]), color, tile)
    rough = 0.85 * (1 - tile) + tile * (0.16 + 0.10 * pick + 0.20 * step(0.55, vein, 0.3))
    # A tile is laid by hand: each one leans a little.
    lean = (lattice(ix.astype(np.int64), iy.astype(np.int64), seed + 1) - 0.5) * (u * count % 1 - 0.5) \
        + (lattice(ix.astype(np.int64), iy.astype(np.int64), seed + 2) - 0.5) * (v * count % 1 - 0.5)
    height = step(0.03, edge, 0.05) + lean * 0.35 * tile
    return color_png(color), metal_rough_png(np.zeros_like(rough), rough), normal_png(height, 5)


def stone_textures():
    """Warm limestone: clouds, and pits that catch the light."""
    u, v = square()
    cloud, grain = fbm(u, v, 3, 3, 4, 21), fbm(u, v, 48, 48, 3, 27)
    pit = step(0.70, fbm(u, v, 24, 40, 2, 33), 0.08)
    color = mix([0.42, 0.30, 0.18], [0.66, 0.52, 0.34], np.clip(0.75 * cloud + 0.25 * grain, 0, 1)) * (1 - 0.2 * pit[..., None])
    return color_png(color), normal_png(grain * 0.5 - 0.7 * pit + cloud, 1.6)


def face_textures():
    """The visor: a matrix of lamps behind dark glass, lit where the eyes and the smile are."""
    u, v = square()
    columns, rows = 36, 24
    cx, cy = (np.floor(u * columns) + 0.5) / columns, (np.floor(v * rows) + 0.5) / rows
    lamp = step(-0.36, -np.hypot(u * columns % 1 - 0.5, v * rows % 1 - 0.5), 0.10)
    eye = np.minimum(np.hypot((cx - 0.30) / 0.085, (cy - 0.42) / 0.20), np.hypot((cx - 0.70) / 0.085, (cy - 0.42) / 0.20)) < 1
    smile_at = 0.70 + 0.10 * (1 - ((cx - 0.5) / 0.16) ** 2)
    smile = (np.abs(cx - 0.5) < 0.17) & (np.abs(cy - smile_at) < 0.028)
    on = lamp * (eye | smile)
    emissive = on[..., None] * np.array([0.25, 0.95, 1.0])
    base = np.broadcast_to([0.012, 0.013, 0.016], emissive.shape) + lamp[..., None] * 0.012
    return color_png(base), color_png(emissive)


def vane_textures():
    """Eight columns, one a vane: another hue and another ornament each, so that a turn of 45 degrees is not a symmetry."""
    u, v = square()
    hues = np.array([[0.80, 0.06, 0.05], [0.93, 0.36, 0.03], [0.95, 0.72, 0.05], [0.20, 0.55, 0.10],
                     [0.02, 0.42, 0.45], [0.03, 0.16, 0.60], [0.30, 0.06, 0.50], [0.75, 0.08, 0.33]])
    which = np.minimum((u * 8).astype(int), 7)
    s = u * 8 % 1
    dots = step(-0.27, -np.hypot(s * 3 % 1 - 0.5, v * 8 % 1 - 0.5), 0.06)
    stripes = step(0.5, (v * 7) % 1, 0.05) - step(0.96, (v * 7) % 1, 0.05)
    chevrons = step(0.5, (v * 6 + np.abs(s - 0.5) * 2) % 1, 0.06) - step(0.95, (v * 6 + np.abs(s - 0.5) * 2) % 1, 0.06)
    ornament = np.choose(which % 3, [dots, stripes, chevrons])
    color = mix(hues[which], np.broadcast_to([0.92, 0.89, 0.82], hues[which].shape), np.clip(ornament, 0, 1) * 0.9)
    return color_png(color * (0.93 + 0.07 * fbm(u, v, 64, 64, 2, 41)[..., None]))


# ---------------------------------------------------------------------------------------------- geometry

class Mesh:
    """Triangles with smooth normals and one UV set. `+` joins two, `at` moves one."""

    def __init__(self, position, normal, uv, index):
        self.position, self.normal = np.asarray(position, float).reshape(-1, 3), np.asarray(normal, float).reshape(-1, 3)
        self.uv, self.index = np.asarray(uv, float).reshape(-1, 2), np.asarray(index, np.int64).reshape(-1, 3)

    def __add__(self, other):
        return Mesh(np.concatenate([self.position, other.position]), np.concatenate([self.normal, other.normal]),
                    np.concatenate([self.uv, other.uv]), np.concatenate([self.index, other.index + len(self.position)]))

    def at(self, translate=(0, 0, 0), rotate=(0, 0, 0), scale=(1, 1, 1)):
        """Scaled, then rotated by degrees about the fixed axes x, y, z in this order, then moved."""
        scale = np.broadcast_to(np.asarray(scale, float), (3,))
        turn = rotation(rotate)
        normal = (self.normal / scale) @ turn.T
        index = self.index if np.prod(scale) > 0 else self.index[:, ::-1]
        return Mesh((self.position * scale) @ turn.T + translate, unit(normal), self.uv, index)

    def tiled(self, u, v):
        return Mesh(self.position, self.normal, self.uv * [u, v], self.index)


def unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-12)


def rotation(degrees):
    out = np.eye(3)
    for axis, angle in enumerate(np.radians(degrees)):
        c, s = math.cos(angle), math.sin(angle)
        a, b = (axis + 1) % 3, (axis + 2) % 3
        m = np.eye(3)
        m[a, a], m[a, b], m[b, a], m[b, b] = c, -s, s, c
        out = m @ out
    return out


def quads(rows, columns):
    """Triangles of a grid of rows × columns vertices, counter-clockwise seen from the side of d/dcolumn × d/drow."""
    i = np.arange((rows - 1) * columns).reshape(rows - 1, columns)[:, :-1].ravel()
    return np.stack([i, i + 1, i + columns + 1, i, i + columns + 1, i + columns], axis=-1).reshape(-1, 3)


def grid(position, uv=None, wrap_columns=False):
    """A smooth surface through position[row][column]; normals from central differences."""
    rows, columns = position.shape[:2]
    along = np.gradient(position, axis=1)
    if wrap_columns:
        along[:, 0] = along[:, -1] = (position[:, 1] - position[:, -2]) * 0.5
    normal = np.cross(along, np.gradient(position, axis=0))
    if uv is None:
        uv = np.stack(np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows)), axis=-1)
    return Mesh(position, unit(normal), uv, quads(rows, columns))


def lathe(profile, segments, crease=35, repeat=(1, 1)):
    """Turns a profile [(radius, y), …], from the top down, about the y axis; corners sharper than `crease` degrees stay sharp.
    u runs once around (times repeat), v along the profile."""
    p = np.asarray(profile, float)
    steps = np.diff(p, axis=0)
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(steps, axis=1))])
    direction = unit(steps)
    turn = np.degrees(np.arccos(np.clip((direction[1:] * direction[:-1]).sum(axis=1), -1, 1)))
    cuts = [0] + [int(i) + 1 for i in np.flatnonzero(turn > crease)] + [len(p) - 1]
    theta = np.linspace(0, TAU, segments + 1)
    out = None
    for first, last in zip(cuts[:-1], cuts[1:]):
        part, sides = p[first:last + 1], direction[first:last]
        tangent = unit(np.concatenate([sides[:1], sides[1:] + sides[:-1], sides[-1:]]))
        outward = np.stack([-tangent[:, 1], tangent[:, 0]], axis=-1)
        around = lambda rv: np.stack([rv[:, :1] * np.sin(theta), np.repeat(rv[:, 1:], segments + 1, 1), rv[:, :1] * np.cos(theta)], axis=-1)
        v = length[first:last + 1] / length[-1] * repeat[1]
        uv = np.stack(np.broadcast_arrays(theta / TAU * repeat[0], v[:, None]), axis=-1)
        piece = Mesh(around(part), around(outward), uv, quads(last - first + 1, segments + 1)[:, ::-1])
        out = piece if out is None else out + piece
    return drop_slivers(out)


def drop_slivers(mesh):
    a, b, c = (mesh.position[mesh.index[:, k]] for k in range(3))
    keep = np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12
    return Mesh(mesh.position, mesh.normal, mesh.uv, mesh.index[keep])


def curve(points, count):
    """Catmull-Rom spline through points, `count` samples a span."""
    p = np.asarray(points, float)
    p = np.concatenate([[2 * p[0] - p[1]], p, [2 * p[-1] - p[-2]]])
    t = np.linspace(0, 1, count, endpoint=False)[:, None]
    spans = [0.5 * (2 * p[i] + (p[i + 1] - p[i - 1]) * t + (2 * p[i - 1] - 5 * p[i] + 4 * p[i + 1] - p[i + 2]) * t ** 2
                    + (3 * p[i] - p[i - 1] - 3 * p[i + 1] + p[i + 2]) * t ** 3) for i in range(1, len(p) - 2)]
    return np.concatenate(spans + [p[-2:-1]])


def sphere(radius=1.0, segments=48, repeat=(1, 1)):
    a = np.linspace(0, math.pi, segments // 2 + 1)
    return lathe(np.stack([radius * np.sin(a), radius * np.cos(a)], -1), segments, crease=180, repeat=repeat)


def torus(radius, tube, segments=96, sides=24):
    a = np.linspace(0, TAU, sides + 1)
    return lathe(np.stack([radius + tube * np.sin(a), tube * np.cos(a)], -1), segments, crease=180, repeat=(8, 1))


def tube(points, radius, sides=24):
    """A tube along a polyline; radius may be one number or one a point."""
    p = np.asarray(points, float)
    r = np.broadcast_to(np.asarray(radius, float), (len(p),))
    forward = unit(np.gradient(p, axis=0))
    side = unit(np.cross(forward[0], [0.3, 0.2, 1.0]))
    frames = []
    for f in forward:  # parallel transport: the frame turns no more than the curve does
        side = unit(side - f * (side @ f))
        frames.append((side, np.cross(f, side)))
    theta = np.linspace(0, TAU, sides + 1)
    ring = [q + rr * (np.cos(theta)[:, None] * a + np.sin(theta)[:, None] * b) for q, rr, (a, b) in zip(p, r, frames)]
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))])
    uv = np.stack(np.broadcast_arrays(theta / TAU, length[:, None] * 4), axis=-1)
    return grid(np.array(ring), uv, wrap_columns=True)


def capsule(a, b, radius):
    a, b = np.asarray(a, float), np.asarray(b, float)
    t = np.linspace(0, math.pi, 25)
    along = np.where(t[:, None] < math.pi / 2, a, b) - np.cos(t)[:, None] * radius * unit(b - a)
    return tube(along, np.maximum(radius * np.sin(t), radius * 1e-3), 20)


def rounded_box(size, radius, cells=8):
    """A box with rounded edges; every face is a grid of its own with UVs in [0, 1]."""
    half, out = np.asarray(size, float) / 2, None
    t = np.sort(np.concatenate([np.linspace(-1, 1, cells + 1), [-0.999, 0.999]]))
    for axis in range(3):
        for sign in (-1, 1):
            a, b = (axis + 1) % 3, (axis + 2) % 3
            arc = np.linspace(0, math.pi / 4, cells + 1)
            inner = half - radius
            ca = np.concatenate([-np.tan(arc[::-1]), [0], np.tan(arc)])
            ta, tb = np.meshgrid(ca, ca)
            core = np.zeros(ta.shape + (3,))
            direction = np.zeros_like(core)
            direction[..., axis], direction[..., a], direction[..., b] = sign, ta, tb
            core[..., axis] = sign * inner[axis]
            core[..., a], core[..., b] = np.sign(ta) * inner[a], np.sign(tb) * inner[b]
            direction = unit(direction)
            position = core + direction * radius
            uv = np.stack([0.5 + sign * position[..., a] / (2 * half[a]), 0.5 - position[..., b] / (2 * half[b])], axis=-1)
            index = quads(len(ca), len(ca))
            piece = Mesh(position, direction, uv, index if sign > 0 else index[:, ::-1])
            out = piece if out is None else out + piece
    return drop_slivers(out)


def box(size, centre=(0, 0, 0), texels_per_metre=0.5):
    """A sharp box; UVs in metres."""
    half, out = np.asarray(size, float) / 2, None
    for axis in range(3):
        for sign in (-1, 1):
            a, b = (axis + 1) % 3, (axis + 2) % 3
            corner = np.zeros((2, 2, 3))
            corner[..., axis] = sign * half[axis]
            corner[..., a] = np.array([[-1, 1], [-1, 1]]) * half[a]
            corner[..., b] = np.array([[-1, -1], [1, 1]]) * half[b]
            normal = np.zeros((2, 2, 3))
            normal[..., axis] = sign
            uv = np.stack([corner[..., a] + half[a], corner[..., b] + half[b]], -1) * texels_per_metre
            piece = Mesh(corner, normal, uv, quads(2, 2) if sign > 0 else quads(2, 2)[:, ::-1])
            out = piece if out is None else out + piece
    return out.at(centre)


def panel(origin, edge_u, edge_v, repeat=(1, 1)):
    """A parallelogram facing edge_u × edge_v; v of the texture runs along edge_v."""
    o, a, b = (np.asarray(x, float) for x in (origin, edge_u, edge_v))
    normal = unit(np.cross(a, b))
    return Mesh([o, o + a, o + a + b, o + b], [normal] * 4, np.array([[0, 1], [1, 1], [1, 0], [0, 0]]) * repeat, [[0, 1, 2], [0, 2, 3]])


# ---------------------------------------------------------------------------------------------- glTF

class Glb:
    """Collects the parts of a glTF file and writes them as one .glb."""

    def __init__(self):
        self.json = {"asset": {"version": "2.0", "generator": "Kadr tools/make_assets.py"}, "scene": 0, "scenes": [{"nodes": []}],
                     "nodes": [], "meshes": [], "materials": [], "accessors": [], "bufferViews": [], "buffers": []}
        self.bin = bytearray()
        self.used = set()

    def part(self, name, item):
        self.json.setdefault(name, []).append(item)
        return len(self.json[name]) - 1

    def view(self, data):
        while len(self.bin) % 4:
            self.bin.append(0)
        at = len(self.bin)
        self.bin += data
        return self.part("bufferViews", {"buffer": 0, "byteOffset": at, "byteLength": len(data)})

    def accessor(self, values, kind, bounds=False):
        if kind == "SCALAR" and values.dtype.kind == "i":
            wide = len(values) and values.max() > 65534
            values, component = (values.astype("<u4"), 5125) if wide else (values.astype("<u2"), 5123)
        else:
            # Multiples of 2^-20: platforms whose sine differs in the last bit still write the same file, nearly always.
            values, component = (np.round(values * 2 ** 20) / 2 ** 20).astype("<f4"), 5126
        item = {"bufferView": self.view(values.tobytes()), "componentType": component, "count": len(values), "type": kind}
        if bounds:
            flat = values.reshape(len(values), -1)
            item["min"], item["max"] = [float(x) for x in flat.min(axis=0)], [float(x) for x in flat.max(axis=0)]
        return self.part("accessors", item)

    def texture(self, png):
        if "samplers" not in self.json:
            self.part("samplers", {"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497})
        image = self.part("images", {"bufferView": self.view(png), "mimeType": "image/png"})
        return {"index": self.part("textures", {"source": image, "sampler": 0})}

    def material(self, name, color=(1, 1, 1), metallic=0.0, roughness=1.0, base=None, metal_rough=None, normal=None,
                 emissive=None, emissive_map=None, strength=1.0, two_sided=False, normal_scale=1.0):
        pbr = {"baseColorFactor": [*color, 1], "metallicFactor": metallic, "roughnessFactor": roughness}
        item = {"name": name, "pbrMetallicRoughness": pbr}
        if base:
            pbr["baseColorTexture"] = base
        if metal_rough:
            pbr["metallicRoughnessTexture"], pbr["metallicFactor"], pbr["roughnessFactor"] = metal_rough, 1, 1
        if normal:
            item["normalTexture"] = {**normal, "scale": normal_scale}
        if emissive:
            item["emissiveFactor"] = list(emissive)
        if emissive_map:
            item["emissiveTexture"] = emissive_map
        if strength != 1:
            item["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
            self.used.add("KHR_materials_emissive_strength")
        if two_sided:
            item["doubleSided"] = True
        return self.part("materials", item)

    def mesh(self, name, *parts):
        """parts: (Mesh, material) pairs."""
        primitives = [{"attributes": {"POSITION": self.accessor(m.position, "VEC3", True), "NORMAL": self.accessor(unit(m.normal), "VEC3"),
                                      "TEXCOORD_0": self.accessor(m.uv, "VEC2")},
                       "indices": self.accessor(m.index.reshape(-1), "SCALAR"), "material": material} for m, material in parts]
        return self.part("meshes", {"name": name, "primitives": primitives})

    def with_material(self, mesh, name, material):
        """The same triangles under another material."""
        primitives = [{**p, "material": material} for p in self.json["meshes"][mesh]["primitives"]]
        return self.part("meshes", {"name": name, "primitives": primitives})

    def node(self, name, mesh=None, translate=None, rotate=None, scale=None, parent=None, **more):
        item = {"name": name, **more}
        if mesh is not None:
            item["mesh"] = mesh
        if translate is not None:
            item["translation"] = [float(x) for x in translate]
        if rotate is not None:
            item["rotation"] = quaternion(rotate)
        if scale is not None:
            item["scale"] = [float(x) for x in np.broadcast_to(scale, (3,))]
        index = self.part("nodes", item)
        if parent is None:
            self.json["scenes"][0]["nodes"].append(index)
        else:
            self.json["nodes"][parent].setdefault("children", []).append(index)
        return index

    def camera(self, name, position, target, yfov_deg):
        camera = self.part("cameras", {"type": "perspective", "name": name, "perspective": {"yfov": round(math.radians(yfov_deg), 6), "znear": 0.01}})
        to = np.asarray(target, float) - position
        yaw = math.degrees(math.atan2(-to[0], -to[2]))
        pitch = math.degrees(math.atan2(to[1], math.hypot(to[0], to[2])))
        return self.node(name, None, position, (pitch, yaw, 0), camera=camera)

    def bytes(self):
        self.json["buffers"] = [{"byteLength": len(self.bin)}]
        if self.used:
            self.json["extensionsUsed"] = sorted(self.used)
        text = json.dumps({k: v for k, v in self.json.items() if v != []}, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        body = bytes(self.bin) + b"\0" * (-len(self.bin) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(body), 0x004E4942) + body
        return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def quaternion(degrees):
    """[x, y, z, w] of rotations about the fixed axes x, y, z in this order."""
    q = np.array([0, 0, 0, 1.0])
    for axis, angle in enumerate(np.radians(degrees)):
        r = np.zeros(4)
        r[axis], r[3] = math.sin(angle / 2), math.cos(angle / 2)
        v = r[3] * q[:3] + q[3] * r[:3] + np.cross(r[:3], q[:3])
        q = np.array([*v, r[3] * q[3] - r[:3] @ q[:3]])
    return [round(float(x), 9) for x in q]


# ---------------------------------------------------------------------------------------------- the assets

def robot():
    """The hero of `turntable`: a ceramic and brass robot that waves from a walnut plinth. y = 0 is the floor; it looks along +z."""
    g = Glb()
    ceramic_maps, brushed, wood, face = ceramic_textures(), brushed_textures(), wood_textures(), face_textures()
    tex = [g.texture(p) for p in (*ceramic_maps, *brushed, *wood, *face)]
    ceramic = g.material("painted glaze", base=tex[0], metal_rough=tex[1], normal=tex[2])
    brass = g.material("brushed brass", base=tex[3], metal_rough=tex[4], normal=tex[5], normal_scale=0.3)
    walnut = g.material("walnut", base=tex[6], metal_rough=tex[7], normal=tex[8], normal_scale=0.7)
    visor = g.material("visor", base=tex[9], roughness=0.07, emissive=(1, 1, 1), emissive_map=tex[10], strength=5)
    glaze = g.material("white glaze", (0.86, 0.83, 0.77), 0, 0.14)
    red = g.material("red enamel", (0.62, 0.035, 0.02), 0, 0.12)
    rubber = g.material("rubber", (0.022, 0.022, 0.024), 0, 0.55)

    plinth_profile = np.concatenate([[(0, 0.26), (0.56, 0.26)], curve([(0.56, 0.26), (0.578, 0.254), (0.584, 0.24)], 6)[1:],
                                     [(0.584, 0.215)], curve([(0.55, 0.205), (0.535, 0.15), (0.57, 0.095), (0.63, 0.075)], 12),
                                     [(0.655, 0.075)], curve([(0.655, 0.075), (0.67, 0.065), (0.672, 0.05)], 5)[1:], [(0.672, 0.0)]])
    top = lathe(plinth_profile, 128, repeat=(3, 1))
    g.node("Plinth", g.mesh("plinth", (top, walnut), (torus(0.553, 0.011).at((0, 0.2085, 0)) + torus(0.645, 0.009).at((0, 0.077, 0)), brass)))

    body_shape = curve([(0.0, 1.03), (0.11, 1.022), (0.225, 0.96), (0.315, 0.83), (0.335, 0.69), (0.29, 0.54), (0.19, 0.44), (0.10, 0.415), (0, 0.41)], 8)
    body_shape[0, 0] = body_shape[-1, 0] = 0
    body = lathe(body_shape, 96, crease=180)
    collar = lathe(curve([(0.10, 1.065), (0.135, 1.06), (0.155, 1.035), (0.17, 1.0), (0.185, 0.985)], 6), 72, crease=180, repeat=(6, 1))
    hips = lathe(curve([(0.22, 0.47), (0.225, 0.455), (0.19, 0.43), (0.10, 0.405), (0.0, 0.40)], 5), 72, crease=180, repeat=(6, 1))
    bezel = lathe(curve([(0.0, 0.014), (0.05, 0.014), (0.062, 0.03), (0.074, 0.02), (0.08, 0.0)], 6), 48, repeat=(4, 1))
    button = sphere(0.048, 40).at((0, 0.012, 0), scale=(1, 0.55, 1))
    chest = dict(translate=(0, 0.90, 0.262), rotate=(62, 0, 0))
    parts = {"brass": collar + hips + bezel.at(**chest), "red": button.at(**chest), "rubber": None, "glaze": None}

    def add(kind, mesh):
        parts[kind] = mesh if parts[kind] is None else parts[kind] + mesh
    neck = curve([(0, 1.04, 0), (0, 1.12, 0)], 40)
    add("rubber", tube(neck, 0.082 + 0.010 * np.cos(np.linspace(0, 4 * TAU, len(neck))), 48))
    for side in (-1, 1):
        add("brass", lathe(curve([(0.0, 0.0), (0.09, -0.005), (0.135, -0.04), (0.15, -0.085), (0.152, -0.10)], 6), 56, repeat=(5, 1))
            .at((side * 0.175, 0.36, 0.045), scale=(1, 1, 1.3)))
        add("rubber", lathe([(0.156, 0.017), (0.160, 0.0)], 56).at((side * 0.175, 0.26, 0.045), scale=(1, 1, 1.3)))
        add("rubber", tube(curve([(side * 0.13, 0.46, 0), (side * 0.16, 0.40, 0.015), (side * 0.175, 0.345, 0.03)], 16), 0.05, 32))
        add("brass", sphere(0.075, 40, (3, 1)).at((side * 0.325, 0.865, 0)))
    # One arm hangs, the other waves.
    arms = {-1: [(-0.34, 0.86, 0), (-0.46, 0.80, 0.02), (-0.50, 0.68, 0.07), (-0.47, 0.585, 0.14)],
            1: [(0.34, 0.86, 0), (0.47, 0.84, 0.02), (0.575, 0.93, 0.05), (0.60, 1.06, 0.08)]}
    for side, points in arms.items():
        line = curve(points, 44)
        add("rubber", tube(line, 0.034 + 0.006 * np.cos(np.linspace(0, 22 * TAU, len(line))), 28))
        hand, towards = line[-1], unit(line[-1] - line[-4])
        add("glaze", sphere(0.072, 40).at(hand + towards * 0.035))
        add("brass", torus(0.046, 0.014, 48, 16).at(hand - towards * 0.018, (0, 0, 0) if side > 0 else (55, 0, 0)))
        across = unit(np.cross(towards, [0, 0, 1]))
        spread = [(-0.75, 0.0), (0.0, 0.15), (0.75, 0.0)] if side > 0 else [(-0.6, 0.3), (0.0, 0.45), (0.6, 0.3)]
        for sideways, forward in spread:
            finger = unit(towards + across * sideways + np.array([0, 0, forward]))
            start = hand + towards * 0.05 + finger * 0.05
            add("brass", capsule(start, start + finger * 0.065, 0.021))
    head = rounded_box((0.64, 0.44, 0.46), 0.17, 10).at((0, 1.325, 0))
    add("glaze", head)
    for side in (-1, 1):
        ear = lathe(curve([(0.0, 0.05), (0.06, 0.048), (0.085, 0.035), (0.10, 0.012), (0.112, 0.0), (0.115, -0.02)], 6), 56, crease=180, repeat=(4, 1))
        add("brass", ear.at((side * 0.318, 1.325, 0), (0, 0, -90 * side)))
        add("red", sphere(0.045, 32).at((side * 0.362, 1.325, 0), scale=(0.5, 1, 1)))
    add("brass", lathe(curve([(0.0, 0.045), (0.035, 0.04), (0.05, 0.02), (0.075, 0.004), (0.08, -0.02)], 6), 48, repeat=(3, 1)).at((0, 1.545, 0)))
    add("brass", tube(curve([(0, 1.56, 0), (0.0, 1.66, -0.005), (-0.015, 1.76, -0.02)], 16), 0.011, 16))
    add("red", sphere(0.045, 40).at((-0.017, 1.79, -0.023)))

    # The visor: a rounded rectangle that bulges, with a brass rim.
    s, a = np.linspace(0, 1, 14)[:, None], np.linspace(0, TAU, 97)[None]
    power = lambda x: np.sign(x) * np.abs(x) ** 0.5
    ex, ey = power(np.cos(a)), power(np.sin(a))
    glass = np.stack(np.broadcast_arrays(0.232 * s * ex, 0.142 * s * ey, 0.030 * (1 - s ** 4)), axis=-1)
    uv = np.stack([0.5 + glass[..., 0] / 0.464, 0.5 - glass[..., 1] / 0.284], axis=-1)
    glass_normal = unit(np.stack(np.broadcast_arrays(0.12 * s ** 3 * ex / 0.232 * 1.0, 0.12 * s ** 3 * ey / 0.142, np.ones_like(s * a)), -1))
    face_mesh = drop_slivers(Mesh(glass, glass_normal, uv, quads(14, 97)[:, ::-1])).at((0, 1.335, 0.226))
    rim = np.stack([0.236 * ex[0], 0.146 * ey[0], np.zeros(97)], -1) + np.array([0, 1.335, 0.228])
    ring = np.linspace(0, TAU, 17)
    outward = unit(np.stack([ex[0] / 0.236, ey[0] / 0.146, np.zeros(97)], -1))
    tube_points = rim[:, None] + 0.014 * (np.cos(ring)[None, :, None] * outward[:, None] + np.sin(ring)[None, :, None] * np.array([0, 0, 1.0]))
    tube_normal = np.cos(ring)[None, :, None] * outward[:, None] + np.sin(ring)[None, :, None] * np.array([0, 0, 1.0])
    add("brass", Mesh(tube_points, tube_normal, np.stack(np.broadcast_arrays(np.linspace(0, 6, 97)[:, None], ring / TAU), -1), quads(97, 17)))

    materials = {"brass": brass, "red": red, "rubber": rubber, "glaze": glaze}
    g.node("Robot", g.mesh("robot", (body, ceramic), (face_mesh, visor), *((parts[k], materials[k]) for k in ("brass", "red", "rubber", "glaze"))))
    return g.bytes()


def studio():
    """A tiled floor before a plain wall that rises out of it in a curve."""
    g = Glb()
    tex = [g.texture(p) for p in tile_textures(4, [0.085, 0.13, 0.14], [0.035, 0.062, 0.07], [0.17, 0.165, 0.155], False, 50)]
    floor = g.material("slate tiles", base=tex[0], metal_rough=tex[1], normal=tex[2])
    wall = g.material("plaster", (0.42, 0.175, 0.10), 0, 0.9)
    g.node("Floor", g.mesh("floor", (panel((-6, 0, 4.5), (12, 0, 0), (0, 0, -7.2), (8, 4.8)), floor)))
    bend = np.linspace(0, math.pi / 2, 17)
    profile = np.concatenate([[[0.0, -2.69], [0.03, -2.69]], np.stack([0.04 + 0.9 * (1 - np.cos(bend)), -2.7 - 0.9 * np.sin(bend)], -1), [[5.5, -3.6]]])
    y, z = profile.T
    x = np.array([-6.0, 6.0])
    surface = np.stack(np.broadcast_arrays(x[None, :], y[:, None], z[:, None]), -1)
    g.node("Wall", g.mesh("wall", (grid(surface), wall)))
    return g.bytes()


def spheres():
    """Metallic (rows) × roughness (columns) on a dark floor: the grid of `light_sweep`."""
    g = Glb()
    ball = None
    columns, rows = 7, 4
    for row in range(rows):
        metallic = row / (rows - 1)
        for column in range(columns):
            rough = 0.04 + 0.96 * column / (columns - 1)
            # From a teal lacquer to copper: each row is a material of its own.
            color = (np.array([0.03, 0.30, 0.30]) * (1 - metallic) + np.array([0.95, 0.52, 0.30]) * metallic).round(4)
            material = g.material(f"metallic {metallic:.2f} roughness {rough:.2f}", [float(c) for c in color], round(metallic, 4), round(rough, 4))
            if ball is None:
                ball = g.mesh("ball", (sphere(0.44, 64), material))
                mesh = ball
            else:
                mesh = g.with_material(ball, f"ball {row} {column}", material)
            g.node(f"Ball {row} {column}", mesh, (column - (columns - 1) / 2, 0.44, (rows - 1) / 2 - row))
    tex = [g.texture(p) for p in tile_textures(4, [0.17, 0.165, 0.16], [0.12, 0.118, 0.115], [0.05, 0.05, 0.05], False, 70)]
    floor = g.material("floor", base=tex[0], metal_rough=tex[1], normal=tex[2], normal_scale=0.6)
    g.node("Floor", g.mesh("floor", (panel((-12, 0, 8), (24, 0, 0), (0, 0, -24), (6, 6)), floor)))
    return g.bytes()


def room():
    """A room lit by one panel in its ceiling; coloured walls, a table, and things that catch their colours."""
    g = Glb()
    wood = [g.texture(p) for p in wood_textures()]
    white = g.material("white paint", (0.76, 0.74, 0.70), 0, 0.9)
    left = g.material("terracotta paint", (0.62, 0.15, 0.07), 0, 0.9)
    right = g.material("petrol paint", (0.05, 0.24, 0.30), 0, 0.9)
    floor = g.material("floor boards", (1, 1, 1), 0, 0.4, base=wood[0], metal_rough=wood[1], normal=wood[2])
    lamp = g.material("panel", (0, 0, 0), 0, 1, emissive=(1, 0.87, 0.70), strength=9)
    light_wood = g.material("ash", (0.55, 0.38, 0.22), 0, 0.38)
    china = g.material("china", (0.85, 0.83, 0.80), 0, 0.12)
    gold = g.material("gold", (1.0, 0.71, 0.29), 1, 0.25)
    navy = g.material("navy cloth", (0.035, 0.06, 0.16), 0, 0.8)
    ochre = g.material("ochre cloth", (0.70, 0.38, 0.06), 0, 0.8)
    paper = g.material("paper", (0.80, 0.76, 0.66), 0, 0.95)
    w, h, d = 2.1, 2.7, 2.2   # half width, height, half depth
    g.node("Floor", g.mesh("floor", (panel((-w, 0, d), (2 * w, 0, 0), (0, 0, -2 * d), (1.5, 1.5)), floor)))
    g.node("Ceiling", g.mesh("ceiling", (panel((-w, h, -d), (2 * w, 0, 0), (0, 0, 2 * d)), white)))
    g.node("Back", g.mesh("back", (panel((-w, 0, -d), (2 * w, 0, 0), (0, h, 0)), white)))
    g.node("Left", g.mesh("left", (panel((-w, 0, d), (0, 0, -2 * d), (0, h, 0)), left)))
    g.node("Right", g.mesh("right", (panel((w, 0, -d), (0, 0, 2 * d), (0, h, 0)), right)))
    g.node("Panel", g.mesh("lamp", (panel((-0.65, h - 0.02, -0.55), (1.3, 0, 0), (0, 0, 0.9)), lamp)))

    leg = lathe(curve([(0.045, 0.70), (0.04, 0.45), (0.028, 0.02), (0.028, 0.0)], 8), 32, crease=60)
    table = rounded_box((1.9, 0.07, 1.0), 0.03, 4).at((0, 0.735, 0))
    for x in (-0.82, 0.82):
        for z in (-0.38, 0.38):
            table = table + leg.at((x, 0, z), (8 * np.sign(z), 0, -8 * np.sign(x)))
    g.node("Table", g.mesh("table", (table, light_wood)), (0, 0, -0.35))
    vase = lathe(curve([(0.058, 0.50), (0.052, 0.46), (0.062, 0.40), (0.145, 0.29), (0.17, 0.19), (0.12, 0.05), (0.085, 0.0)], 10)
                 .tolist() + [[0, 0]], 72, crease=60)
    bowl = lathe(np.concatenate([curve([(0.0, 0.03), (0.12, 0.05), (0.20, 0.10), (0.245, 0.17)], 10)[:-1], curve([(0.247, 0.172), (0.253, 0.17)], 3),
                                 curve([(0.255, 0.165), (0.21, 0.085), (0.10, 0.02), (0.09, 0.0)], 10), [(0, 0)]]), 72, crease=70)
    g.node("Vase", g.mesh("vase", (vase, china)), (-0.60, 0.77, -0.50))
    g.node("Bowl", g.mesh("bowl", (bowl, g.material("celadon", (0.30, 0.48, 0.36), 0, 0.15))), (0.12, 0.77, -0.22))
    g.node("Ball", g.mesh("gold ball", (sphere(0.13, 72), gold)), (0.70, 0.90, -0.12))
    orange = g.mesh("orange", (sphere(0.075, 40), g.material("orange", (0.85, 0.24, 0.01), 0, 0.35)))
    for k, (x, y, z) in enumerate([(0.06, 0.90, -0.27), (0.20, 0.895, -0.21), (0.10, 0.893, -0.13), (0.14, 1.0, -0.20)]):
        g.node(f"Orange {k}", orange, (x, y, z))
    y = 0.77
    for k, (cover, size, turn) in enumerate([(navy, (0.42, 0.06, 0.30), 12), (ochre, (0.38, 0.05, 0.27), -6), (left, (0.34, 0.045, 0.25), 20)]):
        pages = box((size[0] - 0.012, size[1] - 0.016, size[2] - 0.02)).at((0.002, 0, 0))
        spine = box((size[0], 0.008, size[2]), (0, size[1] / 2 - 0.004, 0)) + box((size[0], 0.008, size[2]), (0, 0.004 - size[1] / 2, 0)) \
            + box((0.008, size[1], size[2]), (-size[0] / 2 + 0.004, 0, 0))
        g.node(f"Book {k}", g.mesh(f"book {k}", (pages, paper), (spine, cover)), (0.56, y + size[1] / 2, -0.58), (0, turn, 0))
        y += size[1]
    # A picture, a stool and a plain sphere, so that the eye finds something in every third of the frame.
    g.node("Picture", g.mesh("picture", (rounded_box((0.95, 0.68, 0.04), 0.012, 3).at((-0.15, 1.72, -d + 0.03)), g.material("frame", (0.06, 0.035, 0.02), 0, 0.35)),
                             (panel((-0.565, 1.44, -d + 0.056), (0.83, 0, 0), (0, 0.56, 0)), ochre),
                             (panel((-0.565, 1.44, -d + 0.058), (0.83, 0, 0), (0, 0.20, 0)), navy),
                             (lathe([(0.0, 0.0), (0.11, 0.0)], 48).at((0.02, 1.745, -d + 0.060), (90, 0, 0)), china)))
    stool = lathe(np.concatenate([[(0, 0.45)], curve([(0.20, 0.45), (0.225, 0.435), (0.225, 0.40), (0.19, 0.39)], 6), [(0.0, 0.39)]]), 56)
    for k in range(3):
        a = TAU * k / 3 + 0.4
        stool = stool + tube(np.linspace((0.13 * math.cos(a), 0.40, 0.13 * math.sin(a)), (0.21 * math.cos(a), 0.0, 0.21 * math.sin(a)), 6), 0.022, 16)
    g.node("Stool", g.mesh("stool", (stool, navy)), (-1.25, 0, 0.55))
    g.node("Globe", g.mesh("globe", (sphere(0.30, 72), china)), (1.35, 0.30, 0.45))
    # The camera itself is authored, and animated: it walks in and to the right.
    camera = g.camera("Camera", (-0.35, 1.30, 4.75), (-0.05, 1.17, 0), 35)
    g.part("animations", {"name": "walk in", "samplers": [{"input": g.accessor(np.array([0.0, 1.0]), "SCALAR", True),
           "output": g.accessor(np.array([(-0.35, 1.30, 4.75), (0.25, 1.30, 4.35)]), "VEC3"), "interpolation": "LINEAR"}],
           "channels": [{"sampler": 0, "target": {"node": camera, "path": "translation"}}]})
    return g.bytes()


def rotor():
    """A pinwheel that turns about z; eight vanes, each with its own colours. Its hub is the origin."""
    g = Glb()
    paper = g.material("paper", (1, 1, 1), 0, 0.45, base=g.texture(vane_textures()), two_sided=True)
    brass = g.material("pin", (0.95, 0.68, 0.35), 1, 0.22)
    s, t = np.linspace(0.03, 1, 40)[:, None], np.linspace(0, 1, 28)[None]
    vanes = None
    for k in range(8):
        # A vane leaves the hub, widens, and curls forward along its leading edge.
        angle = TAU * k / 8 + (t - 0.15) * (TAU / 8) * (1.12 - 0.25 * s ** 2) + 0.35 * s
        radius = 0.62 * s * (1 - 0.20 * (2 * t - 1) ** 2 * s)
        lift = 0.17 * s ** 1.3 * (1 - t) ** 2 + 0.02
        vane = np.stack(np.broadcast_arrays(radius * np.cos(angle), radius * np.sin(angle), lift), -1)
        uv = np.stack(np.broadcast_arrays((k + 0.04 + 0.92 * t) / 8, s), -1)
        piece = grid(vane, uv)
        piece = Mesh(piece.position, piece.normal * np.sign(piece.normal[:, 2:].mean()), piece.uv, piece.index[:, ::-1] if piece.normal[:, 2].mean() < 0 else piece.index)
        vanes = piece if vanes is None else vanes + piece
    hub = lathe(curve([(0.0, 0.075), (0.035, 0.065), (0.055, 0.03), (0.058, 0.0), (0.058, -0.03)], 6), 48, crease=180).at((0, 0, 0.05), (90, 0, 0))
    g.node("Rotor", g.mesh("pinwheel", (vanes, paper), (hub, brass)))
    return g.bytes()


def stand():
    """The stick and foot of the pinwheel, whose hub is at (0, 1.15, 0)."""
    g = Glb()
    tex = [g.texture(p) for p in wood_textures()]
    wood = g.material("walnut", base=tex[0], metal_rough=tex[1], normal=tex[2])
    brass = g.material("brass", (0.95, 0.68, 0.35), 1, 0.25)
    foot = lathe(np.concatenate([[(0, 0.10)], curve([(0.05, 0.10), (0.09, 0.07), (0.20, 0.05), (0.235, 0.03)], 8), [(0.24, 0.0)]]), 72, repeat=(2, 1))
    stick = lathe(curve([(0.0, 1.245), (0.016, 1.24), (0.021, 1.20), (0.022, 0.6), (0.026, 0.12), (0.028, 0.09)], 10), 32, crease=60, repeat=(1, 4))
    pin = tube(np.linspace((0, 1.15, -0.10), (0, 1.15, 0.06), 4), 0.009, 20)
    g.node("Stand", g.mesh("stand", (foot + stick.at((0, 0, -0.07)), wood), (pin, brass)))
    return g.bytes()


def street():
    """A colonnade that runs along x: fluted columns, arches, a paved walk, a wall behind, lanterns that swing."""
    g = Glb()
    stone_maps = [g.texture(p) for p in stone_textures()]
    paving_maps = [g.texture(p) for p in tile_textures(4, [0.52, 0.44, 0.34], [0.26, 0.115, 0.07], [0.16, 0.14, 0.12], True, 90)]
    stone = g.material("limestone", (1, 1, 1), 0, 0.85, base=stone_maps[0], normal=stone_maps[1])
    plaster = g.material("ochre plaster", (0.66, 0.36, 0.16), 0, 0.92, normal=stone_maps[1], normal_scale=0.35)
    paving = g.material("paving", base=paving_maps[0], metal_rough=paving_maps[1], normal=paving_maps[2])
    iron = g.material("iron", (0.05, 0.045, 0.04), 1, 0.45)
    glow = g.material("lantern glass", (0.9, 0.75, 0.5), 0, 0.3, emissive=(1, 0.62, 0.25), strength=2.5)
    door = g.material("green door", (0.03, 0.11, 0.085), 0, 0.4)
    bays, span, height = 9, 2.6, 3.0

    theta, level = np.linspace(0, TAU, 161), np.linspace(0, 1, 24)
    flute = 1 - 0.055 * np.abs(np.sin(theta * 10)) ** 0.8
    taper = 0.25 - 0.045 * level ** 1.6
    shaft = np.stack(np.broadcast_arrays(taper[:, None] * flute * np.sin(theta), 0.34 + level[:, None] * (height - 0.72), taper[:, None] * flute * np.cos(theta)), -1)
    shaft_uv = np.stack(np.broadcast_arrays(theta / TAU, level[:, None] * 2), -1)
    base = lathe(curve([(0.27, 0.36), (0.285, 0.33), (0.27, 0.30), (0.275, 0.28), (0.33, 0.25), (0.345, 0.21), (0.33, 0.17)], 6), 64, crease=180)
    cap = lathe(curve([(0.36, height - 0.16), (0.33, height - 0.23), (0.25, height - 0.30), (0.235, height - 0.34), (0.22, height - 0.40)], 6), 64, crease=180)
    column = grid(shaft, shaft_uv, wrap_columns=True) + base + cap + box((0.74, 0.18, 0.74), (0, 0.09, 0)) + box((0.78, 0.16, 0.78), (0, height - 0.08, 0))
    column_mesh = g.mesh("column", (column, stone))

    # One bay of the arcade: a wall with a half-circle cut out, from column to column.
    radius, thick, top = span / 2 - 0.26, 0.56, height + span / 2 + 0.15
    a = np.linspace(math.pi, 0, 49)
    ax, ay = radius * np.cos(a), height + radius * np.sin(a)
    edge_x = np.concatenate([[-span / 2], ax, [span / 2]])
    edge_y = np.concatenate([[height], ay, [height]])
    bay = None
    for sign in (1, -1):
        face = np.stack([np.stack([edge_x, edge_y, np.full(51, sign * thick / 2)], -1), np.stack([edge_x, np.full(51, top), np.full(51, sign * thick / 2)], -1)])
        normal = np.broadcast_to([0, 0, sign], face.shape)
        index = quads(2, 51) if sign > 0 else quads(2, 51)[:, ::-1]
        piece = drop_slivers(Mesh(face, normal, face[..., :2] * 0.5, index))
        bay = piece if bay is None else bay + piece
    soffit = np.stack([np.stack([ax, ay, np.full(49, z)], -1) for z in (-thick / 2, thick / 2)])
    inward = np.broadcast_to(np.stack([-np.cos(a), -np.sin(a), np.zeros(49)], -1), soffit.shape)
    soffit_uv = np.stack(np.broadcast_arrays(np.linspace(0, 2, 49), np.array([[0.0], [0.3]])), -1)
    bay = bay + Mesh(soffit, inward, soffit_uv, quads(2, 49))
    under = panel((-span / 2, height, -thick / 2), (span / 2 - radius, 0, 0), (0, 0, thick))
    bay = bay + under + under.at((span / 2 + radius, 0, 0))
    # Voussoirs: a moulding that follows the arch.
    for r, width, out in ((radius + 0.02, 0.045, 0.035), (radius + 0.26, 0.03, 0.05)):
        line = np.stack([r * np.cos(a), height + r * np.sin(a), np.full(49, thick / 2 + out * 0.4)], -1)
        bay = bay + tube(line, width, 12)
    bay = bay + box((span, 0.20, thick + 0.22), (0, top + 0.10, 0)) + box((span, 0.14, thick + 0.42), (0, top + 0.27, 0))
    bay_mesh = g.mesh("bay", (bay, stone))
    keystone = g.mesh("keystone", (rounded_box((0.26, 0.50, thick + 0.16), 0.03, 3), stone))

    frame = box((1.34, 0.16, 0.12), (0, 2.50, 0)) + box((0.16, 2.5, 0.12), (-0.59, 1.25, 0)) + box((0.16, 2.5, 0.12), (0.59, 1.25, 0))
    leaf = box((1.04, 2.42, 0.06), (0, 1.21, -0.02))
    for k in range(3):
        for side in (-0.26, 0.26):
            leaf = leaf + rounded_box((0.40, 0.62, 0.05), 0.02, 2).at((side, 0.42 + 0.78 * k, 0.02))
    door_mesh = g.mesh("door", (frame, stone), (leaf, door))

    lantern_top = lathe([(0.012, 0.0), (0.03, -0.03), (0.13, -0.12), (0.135, -0.14), (0.11, -0.145)], 6, crease=10)
    cage = lathe([(0.10, -0.40), (0.075, -0.44), (0.0, -0.455)], 6, crease=10)
    for k in range(6):
        x, z = math.sin(TAU * k / 6), math.cos(TAU * k / 6)
        cage = cage + tube(np.linspace((0.11 * x, -0.14, 0.11 * z), (0.098 * x, -0.41, 0.098 * z), 3), 0.008, 8)
    chain = tube(np.linspace((0, 0.72, 0), (0, -0.01, 0), 4), 0.008, 8)
    lantern_mesh = g.mesh("lantern", (lantern_top + cage + chain, iron), (lathe([(0.098, -0.148), (0.088, -0.40)], 6, crease=10), glow))

    half = bays * span / 2
    lanterns = []
    for k in range(bays + 1):
        g.node(f"Column {k}", column_mesh, (k * span - half, 0, 0))
        if k < bays:
            x = (k + 0.5) * span - half
            g.node(f"Bay {k}", bay_mesh, (x, 0, 0))
            g.node(f"Keystone {k}", keystone, (x, height + radius + 0.13, 0))
            lanterns.append(g.node(f"Lantern {k}", lantern_mesh, (x, height + radius - 0.72, 0)))
            if k % 2 == 1:
                g.node(f"Door {k}", door_mesh, (x, 0, -3.07))
    g.node("Paving", g.mesh("paving", (panel((-half - 6, 0, 7), (2 * half + 12, 0, 0), (0, 0, -10.2), ((2 * half + 12) / 2.6, 10.2 / 2.6)), paving)))
    g.node("Wall", g.mesh("wall", (panel((-half - 6, 0, -3.2), (2 * half + 12, 0, 0), (0, top + 0.34, 0), ((2 * half + 12) / 3, 1.8)), plaster)))
    g.node("Skirting", g.mesh("skirting", (box((2 * half + 12, 0.5, 0.12), (0, 0.25, -3.16)), stone)))
    g.node("Roof", g.mesh("roof", (box((2 * half + 12, 0.12, 4.0), (0, top + 0.40, -1.6)), stone)))

    # The lanterns swing about x and z, each with its own phase: one period is 2.4 s, a key every tenth of it.
    times = np.arange(11) * 0.24
    clip = {"name": "swing", "samplers": [], "channels": []}
    time_accessor = g.accessor(times, "SCALAR", True)
    for k, node in enumerate(lanterns):
        phase = TAU * (times / 2.4) + 1.7 * k
        keys = np.array([quaternion((5 * math.sin(p), 0, 9 * math.cos(p))) for p in phase])
        clip["samplers"].append({"input": time_accessor, "output": g.accessor(keys, "VEC4"), "interpolation": "LINEAR"})
        clip["channels"].append({"sampler": k, "target": {"node": node, "path": "rotation"}})
    g.part("animations", clip)
    return g.bytes()


def solids():
    """A tetrahedron and a sphere on a ground: what the analytic model is judged by."""
    g = Glb()
    ground = g.material("ground", (0.42, 0.41, 0.38), 0, 0.7)
    red = g.material("vermilion", (0.78, 0.12, 0.06), 0, 0.35)
    metal = g.material("cobalt", (0.12, 0.30, 0.62), 0.3, 0.36)
    corners = np.array([(0, 1.35, 0), (-0.85, 0, 0.55), (0.85, 0, 0.55), (0, 0, -0.95)], float)
    position, normal = [], []
    for a, b, c in ((0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)):
        n = unit(np.cross(corners[b] - corners[a], corners[c] - corners[a]))
        position += [corners[a], corners[b], corners[c]]
        normal += [n] * 3
    tetrahedron = Mesh(position, normal, np.tile([[0.5, 0], [0, 1], [1, 1]], (4, 1)), np.arange(12).reshape(4, 3))
    g.node("Tetrahedron", g.mesh("tetrahedron", (tetrahedron, red)), (-0.95, 0, 0), (0, 24, 0))
    g.node("Sphere", g.mesh("sphere", (sphere(0.62, 128), metal)), (0.85, 0.62, 0.1))
    g.node("Ground", g.mesh("ground", (panel((-8, 0, 8), (16, 0, 0), (0, 0, -16)), ground)))
    return g.bytes()


def furnace():
    """White spheres, metallic × roughness: in a uniform environment they vanish. One grey sphere stays, as a witness."""
    g = Glb()
    ball = None
    columns, rows = 8, 4
    for row in range(rows):
        for column in range(columns):
            metallic, rough = round(row / (rows - 1), 4), round(column / (columns - 1), 4)
            material = g.material(f"white metallic {metallic} roughness {rough}", (1, 1, 1), metallic, rough)
            if ball is None:
                mesh = ball = g.mesh("ball", (sphere(0.42, 48), material))
            else:
                mesh = g.with_material(ball, f"ball {row} {column}", material)
            g.node(f"Ball {row} {column}", mesh, (column - (columns - 1) / 2, (rows - 1) / 2 - row, 0))
    grey = g.with_material(ball, "witness", g.material("grey", (0.5, 0.5, 0.5), 0, 1))
    g.node("Witness", grey, (4.35, -2.0, 0), scale=0.5)
    return g.bytes()


MAKERS = {"robot": robot, "studio": studio, "spheres": spheres, "room": room, "rotor": rotor, "stand": stand, "street": street,
          "solids": solids, "furnace": furnace}


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
