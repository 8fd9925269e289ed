"""The assets of the first sample shots."""
import math

import numpy as np

from .toolkit import *  # noqa: F403  (the toolkit is this module's language)


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
