"""What the sample assets are made with: images, patterns, meshes and a writer of .glb files.

Everything is deterministic: noise comes from an integer hash, never from a random number generator.
"""
import json
import math
import struct
import zlib

import numpy as np

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
