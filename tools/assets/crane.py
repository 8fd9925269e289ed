"""The hero of `mix`: a toy crane of rigid parts that hang from each other, with two clips, "Idle" and "Work"."""
from .toolkit import *


def joined(meshes):
    out = None
    for mesh in meshes:
        out = mesh if out is None else out + mesh
    return out


def rod(a, b, radius=0.011):
    return tube(np.linspace(a, b, 2), radius, 8)


def mast(height, half, bays):
    """Four posts and their braces: a diagonal a bay and side, turning from bay to bay."""
    corners = [(half, half), (-half, half), (-half, -half), (half, -half)]
    rods = [rod((x, 0, z), (x, height, z), 0.014) for x, z in corners]
    for bay in range(bays):
        low, high = height * bay / bays, height * (bay + 1) / bays
        for k, (x, z) in enumerate(corners):
            nx, nz = corners[(k + 1) % 4]
            rods.append(rod((x, high, z), (nx, high, nz), 0.009))
            start, end = ((x, z), (nx, nz)) if (bay + k) % 2 else ((nx, nz), (x, z))
            rods.append(rod((start[0], low, start[1]), (end[0], high, end[1]), 0.008))
    return joined(rods)


def jib(begin, end, half, rise, bays):
    """A lattice girder along x, a triangle in section, that tapers to its tip."""
    steps = np.linspace(begin, end, bays + 1)
    width = lambda x: 1 - 0.45 * max(0, (x - 0.1) / (end - 0.1))
    low = [[(x, 0, side * half) for x in steps] for side in (-1, 1)]
    top = [(x, rise * width(x), 0) for x in steps]
    rods = [tube(line, 0.012, 10) for line in (*low, top)]
    for k in range(bays):
        for side in (0, 1):
            rods.append(rod(low[side][k], top[k + 1] if k % 2 else top[k], 0.007))
            rods.append(rod(low[side][k + 1], top[k + 1] if k % 2 else top[k], 0.007))
        rods.append(rod(low[0][k + 1], low[1][k + 1], 0.007))
    return joined(rods)


def clip(g, name, channels):
    """channels: (node, path, times, values, interpolation); CUBICSPLINE values come as [in tangent, value, out tangent]."""
    item = {"name": name, "samplers": [], "channels": []}
    for node, path, times, values, interpolation in channels:
        kind = "VEC4" if path == "rotation" else "VEC3"
        values = np.asarray(values, float).reshape(-1, 4 if path == "rotation" else 3)
        item["samplers"].append({"input": g.accessor(np.asarray(times, float), "SCALAR", True), "output": g.accessor(values, kind), "interpolation": interpolation})
        item["channels"].append({"sampler": len(item["samplers"]) - 1, "target": {"node": node, "path": path}})
    g.part("animations", item)


def yaw(degrees):
    return quaternion((0, degrees, 0))


def smooth_yaw(times, degrees):
    """Keys of a cubic spline through rotations about y, at rest at both ends: glTF's tangents are slopes of quaternions."""
    times, q = np.asarray(times, float), np.array([yaw(d) for d in degrees])
    slope = np.zeros_like(q)
    slope[1:-1] = (q[2:] - q[:-2]) / (times[2:] - times[:-2])[:, None]
    return np.stack([slope, q, slope], axis=1)


def crane():
    g = Glb()
    walnut = g.material("walnut", (0.17, 0.075, 0.032), 0, 0.33)
    yellow = g.material("yellow enamel", (0.80, 0.36, 0.018), 0, 0.16)
    red = g.material("red enamel", (0.62, 0.035, 0.02), 0, 0.12)
    steel = g.material("steel", (0.60, 0.61, 0.63), 1, 0.24)
    iron = g.material("cast iron", (0.045, 0.047, 0.052), 0.2, 0.42)
    glass = g.material("dark glass", (0.02, 0.03, 0.035), 0, 0.05)
    lamp = g.material("lamp", (0.9, 0.3, 0.05), 0, 0.1, emissive=(1, 0.32, 0.04), strength=14)

    profile = [(0, 0.13), (0.43, 0.13), (0.452, 0.122), (0.46, 0.105), (0.46, 0.028), (0.47, 0.012), (0.472, 0)]
    mast_top = 0.98
    plinth = g.node("Base", g.mesh("base", (lathe(profile, 80), walnut),
                                   (torus(0.461, 0.009, 80, 12).at((0, 0.068, 0)) + lathe([(0, 0.165), (0.125, 0.165), (0.14, 0.155), (0.15, 0.13)], 48), steel),
                                   (mast(mast_top - 0.16, 0.062, 6).at((0, 0.16, 0)), yellow)))

    slew_ring = lathe([(0, 0.05), (0.085, 0.05), (0.1, 0.042), (0.105, 0.02), (0.1, 0.0), (0, 0.0)], 48)
    cab = rounded_box((0.19, 0.17, 0.16), 0.035, 4).at((0.02, 0.135, 0.105))
    window = rounded_box((0.06, 0.085, 0.13), 0.018, 3).at((0.092, 0.155, 0.112)) + rounded_box((0.11, 0.085, 0.04), 0.016, 3).at((0.03, 0.155, 0.17))
    girder = jib(-0.34, 0.86, 0.045, 0.10, 12).at((0, 0.075, 0))
    weight = rounded_box((0.11, 0.17, 0.15), 0.02, 3).at((-0.29, 0.035, 0))
    stay = rod((0, 0.31, 0), (0.62, 0.135, 0), 0.006) + rod((0, 0.31, 0), (-0.30, 0.17, 0), 0.006) + rod((-0.02, 0.05, 0), (0, 0.32, 0), 0.014) \
        + rod((0.03, 0.05, 0), (0, 0.32, 0), 0.014)
    slew = g.node("Slew", g.mesh("slew", (slew_ring + stay, steel), (cab, red), (window, glass), (girder, yellow), (weight, iron)), (0, mast_top, 0),
                  rotate=(0, -28, 0), parent=plinth)

    # The beacon: a dark cap whose lamp looks to one side, so that a turn shows.
    cap = lathe([(0, 0.05), (0.022, 0.047), (0.036, 0.032), (0.04, 0.0)], 40)
    beacon = g.node("Beacon", g.mesh("beacon", (cap, iron), (sphere(0.026, 24).at((0.024, 0.026, 0)), lamp)), (-0.02, 0.217, 0.105), parent=slew)

    wheels = joined([torus(0.017, 0.007, 20, 8).at((x, 0.018, z), (90, 0, 0)) for x in (-0.04, 0.04) for z in (-0.045, 0.045)])
    trolley = g.node("Trolley", g.mesh("trolley", (rounded_box((0.13, 0.03, 0.11), 0.01, 2), iron), (wheels, steel)), (0.52, 0.05, 0), parent=slew)
    hang = g.node("Hang", translate=(0, -0.01, 0), parent=trolley)
    rest_length = 0.34
    cable = g.node("Cable", g.mesh("cable", (rod((0.012, 0, 0), (0.012, -1, 0), 0.004) + rod((-0.012, 0, 0), (-0.012, -1, 0), 0.004), steel)), scale=(1, rest_length, 1), parent=hang)
    bend = curve([(0, 0.0, 0), (0, -0.035, 0), (0.03, -0.06, 0), (0.026, -0.092, 0), (-0.008, -0.10, 0), (-0.028, -0.078, 0)], 8)
    block = rounded_box((0.07, 0.055, 0.04), 0.015, 3)
    hook = g.node("Hook", g.mesh("hook", (tube(bend, np.linspace(0.011, 0.006, len(bend)), 10), steel), (block.at((0, 0.012, 0)), yellow)), (0, -rest_length, 0), parent=hang)
    slings = joined([rod((0, -0.098, 0), (x, -0.21, z), 0.005) for x in (-0.085, 0.085) for z in (-0.085, 0.085)])
    crate = g.node("Crate", g.mesh("crate", (rounded_box((0.21, 0.17, 0.21), 0.014, 3).at((0, -0.29, 0)), walnut),
                                   (slings + joined([rounded_box((0.222, 0.022, 0.222), 0.006, 2).at((0, y, 0)) for y in (-0.235, -0.345)]), steel)), parent=hook)

    t = np.linspace(0, 2, 9)  # Idle: two seconds that close
    sway = np.sin(t * math.pi)
    clip(g, "Idle", [
        (slew, "rotation", t, [yaw(-28 + 3 * s) for s in sway], "LINEAR"),
        (hang, "rotation", t, [quaternion((2.5 * math.cos(x * math.pi), 0, 3.5 * s)) for x, s in zip(t, sway)], "LINEAR"),
        (crate, "rotation", t, [yaw(12 * s) for s in sway], "LINEAR")])
    w = np.linspace(0, 2, 9)  # Work: swings to the other side, in and down
    u = w / 2
    ease = u * u * (3 - 2 * u)
    length = 0.26 + 0.19 * ease
    rate = 6 * u * (1 - u)
    clip(g, "Work", [
        (slew, "rotation", [0, 0.7, 1.3, 2], smooth_yaw([0, 0.7, 1.3, 2], [-20, -58, -104, -140]), "CUBICSPLINE"),
        (trolley, "translation", w, [(0.74 - 0.34 * e, 0.05, 0) for e in ease], "LINEAR"),
        (hang, "rotation", w, [quaternion((9 * r, 0, -4 * r)) for r in rate], "LINEAR"),
        (cable, "scale", w, [(1, x, 1) for x in length], "LINEAR"),
        (hook, "translation", w, [(0, -x, 0) for x in length], "LINEAR"),
        (crate, "rotation", w, [yaw(50 * e) for e in ease], "LINEAR"),
        (beacon, "rotation", [0, 2], [yaw(0), yaw(90)], "LINEAR")])
    return g.bytes()


MAKERS = {"crane": crane}
