"""The assets of `instances`: a hill, a pinwheel on a stick and a tuft of grass, small enough to be copied by the thousand."""
import math

import numpy as np

from .toolkit import *  # noqa: F403  (the toolkit is this module's language)


def swing(g, name, node, seconds, tilts):
    """A clip that turns a node through [(about x, about z), …] in degrees, evenly over the time and back to the first."""
    times = np.linspace(0, seconds, len(tilts) + 1)
    return turns(g, name, node, times, [quaternion((x, 0, z)) for x, z in [*tilts, tilts[0]]])


def turns(g, name, node, times, rotations):
    return {"name": name, "samplers": [{"input": g.accessor(np.asarray(times, float), "SCALAR", True), "output": g.accessor(np.array(rotations), "VEC4"),
                                        "interpolation": "LINEAR"}],
            "channels": [{"sampler": 0, "target": {"node": node, "path": "rotation"}}]}


def joined(name, *clips):
    """One clip of several nodes."""
    out = {"name": name, "samplers": [], "channels": []}
    for clip in clips:
        out["channels"].append({**clip["channels"][0], "sampler": len(out["samplers"])})
        out["samplers"] += clip["samplers"]
    return out


def hill():
    """Rolling ground, 36 m on a side, highest near the middle of its far half; the origin lies on it. Up to z = 6 m it is
    the node `Hill`, beyond that, around the camera, `Near`."""
    g = Glb()
    u, v = square(192)
    moss = fbm(u, v, 9, 9, 5, 31)
    color = mix([0.022, 0.050, 0.008], [0.085, 0.13, 0.022], np.clip(1.6 * moss - 0.3, 0, 1))
    soil = g.material("grass", (1, 1, 1), 0, 0.95, base=g.texture(color_png(color)))
    s = np.linspace(-18, 18, 73)
    x, z = np.meshgrid(s, s)
    rise = 1.9 * np.exp(-((x - 3) ** 2 / 70 + (z + 8) ** 2 / 40)) + 0.9 * np.exp(-((x + 8) ** 2 / 30 + (z + 5) ** 2 / 45))
    bumps = 0.5 * (fbm((x + 18) / 36, (z + 18) / 36, 5, 5, 3, 7) - 0.5)
    y = rise + bumps
    y -= y[36, 36]
    place, uv = np.stack([x, y, z], -1), np.stack([(x + 18) / 6, (z + 18) / 6], -1)
    for name, rows in (("Hill", slice(0, 49)), ("Near", slice(48, 73))):
        g.node(name, g.mesh(name.lower(), (grid(place[rows][::-1], uv[rows][::-1]), soil)))
    return g.bytes()


def pinwheel():
    """A pinwheel on a stick, 0.75 m high, facing +z. Its wheel turns once in two seconds; the stick bows in the wind."""
    g = Glb()
    paper = g.material("paper", (0.70, 0.035, 0.02), 0, 0.5, two_sided=True)
    back = g.material("lining", (0.80, 0.72, 0.55), 0, 0.5, two_sided=True)
    wood = g.material("stick", (0.42, 0.26, 0.13), 0, 0.6)
    stick = tube(np.array([(0, 0, -0.015), (0, 0.38, -0.015), (0, 0.73, -0.015)]), [0.009, 0.008, 0.007], 8)
    s, t = np.linspace(0.06, 1, 7)[:, None], np.linspace(0, 1, 6)[None]
    fronts = linings = None
    for k in range(6):
        # A vane leaves the hub, widens, and curls forward along its leading edge.
        angle = TAU * k / 6 + (t - 0.1) * (TAU / 6) * (1.1 - 0.3 * s ** 2) + 0.3 * s
        radius = 0.21 * s * (1 - 0.2 * (2 * t - 1) ** 2 * s)
        lift = 0.065 * s ** 1.3 * (1 - t) ** 2 + 0.012
        vane = grid(np.stack(np.broadcast_arrays(radius * np.cos(angle), radius * np.sin(angle), lift), -1))
        if k % 2:
            linings = vane if linings is None else linings + vane
        else:
            fronts = vane if fronts is None else fronts + vane
    hub = sphere(0.02, 10).at((0, 0, 0.025))
    pole = g.node("Stick", g.mesh("stick", (stick, wood)))
    wheel = g.node("Wheel", g.mesh("wheel", (fronts, paper), (linings + hub, back)), (0, 0.7, 0.01), parent=pole)
    spin = turns(g, "spin", wheel, np.linspace(0, 4, 25), [[0, 0, math.sin(math.pi * k / 12), math.cos(math.pi * k / 12)] for k in range(25)])
    bow = swing(g, "bow", pole, 4, [(3, 2), (5, -1), (1, -3), (4, 0), (2, 3)])
    g.part("animations", joined("wind", spin, bow))
    return g.bytes()


def tuft():
    """A tuft of thirteen blades of grass, 0.3 m high, that sways."""
    g = Glb()
    blade_green = g.material("blade", (0.085, 0.20, 0.018), 0, 0.6, two_sided=True)
    blades = None
    for k in range(13):
        turn = k * 2.399963  # the golden angle
        out = np.array([math.cos(turn), 0, math.sin(turn)])
        across = np.array([-out[2], 0, out[0]])
        height, lean = 0.30 - 0.011 * k, 0.03 + 0.013 * k
        t = np.linspace(0, 1, 5)[:, None, None]
        spine = out * (0.02 + 0.004 * k) + out * lean * t ** 2 + np.array([0, height, 0]) * t * (1 - 0.12 * t)
        side = np.array([-1, 1])[None, :, None] * across * 0.007 * (1.02 - t)
        blade = grid(spine + side)
        blades = blade if blades is None else blades + blade
    node = g.node("Tuft", g.mesh("tuft", (blades, blade_green)))
    g.part("animations", swing(g, "sway", node, 4, [(2, -6), (7, -11), (3, -4), (8, -9), (4, -12)]))
    return g.bytes()


MAKERS = {"hill": hill, "pinwheel": pinwheel, "tuft": tuft}
