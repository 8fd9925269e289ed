"""The wooden railway of the shot `path`: a track through the points that the shot's `path` has, and a train to run on it."""
from .toolkit import *

# The shot repeats these: [x, y, z] of the track's middle, closed.
POINTS = np.array([[-1.55, 0.0, 0.20], [-1.15, 0.0, -0.75], [-0.10, 0.0, -0.50], [0.75, 0.0, -1.00],
                   [1.60, 0.0, -0.45], [1.30, 0.0, 0.65], [0.30, 0.0, 0.45], [-0.60, 0.0, 1.00]])
GAUGE = 0.075  # half the distance between the rails


def centripetal(points, count):
    """Closed centripetal Catmull-Rom spline, `count` samples a span: the curve that Kadr's paths follow."""
    n, out = len(points), []
    for i in range(n):
        p = [points[(i + k) % n] for k in (-1, 0, 1, 2)]
        d = [math.sqrt(np.linalg.norm(b - a)) for a, b in zip(p, p[1:])]

        def tangent(a, b, c, left, right):
            return (b - a) / left - (c - a) / (left + right) + (c - b) / right
        m0, m1 = d[1] * tangent(p[0], p[1], p[2], d[0], d[1]), d[1] * tangent(p[1], p[2], p[3], d[1], d[2])
        u = np.linspace(0, 1, count, endpoint=False)[:, None]
        out.append(p[1] * (2 * u ** 3 - 3 * u ** 2 + 1) + m0 * (u ** 3 - 2 * u ** 2 + u) + p[2] * (3 * u ** 2 - 2 * u ** 3) + m1 * (u ** 3 - u ** 2))
    return np.concatenate(out)


def railway():
    """Two rails on sleepers, 2.5 cm high."""
    g = Glb()
    wood = g.material("beech", (0.52, 0.31, 0.15), 0, 0.55)
    steel = g.material("rail", (0.62, 0.60, 0.57), 1, 0.28)
    line = centripetal(POINTS, 28)
    ahead = unit(np.roll(line, -1, 0) - np.roll(line, 1, 0))
    side = np.cross(ahead, [0, 1, 0])
    rails = None
    for sign in (-1, 1):
        rail = line + sign * GAUGE * side + [0, 0.028, 0]
        piece = tube(np.concatenate([rail, rail[:2]]), 0.008, 8)
        rails = piece if rails is None else rails + piece
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(np.concatenate([line, line[:1]]), axis=0), axis=1))])
    sleepers = None
    for s in np.arange(0, length[-1] - 0.05, length[-1] / 72):
        k = int(np.searchsorted(length, s, side="right")) - 1
        yaw = math.degrees(math.atan2(ahead[k][0], ahead[k][2]))
        piece = box((0.26, 0.02, 0.055)).at((0, 0, 0), (0, yaw, 0)).at(line[k] + (s - length[k]) * ahead[k] + [0, 0.01, 0])
        sleepers = piece if sleepers is None else sleepers + piece
    g.node("Track", g.mesh("track", (sleepers, wood), (rails, steel)))
    return g.bytes()


def wheels(places, radius):
    """Pairs of wheels on the rails, which are at y = 0.036."""
    disc = lathe(np.array([(0.0, 0.02), (radius * 0.3, 0.02), (radius * 0.35, 0.012), (radius * 0.8, 0.012), (radius * 0.85, 0.02), (radius, 0.016),
                           (radius, -0.016), (0.0, -0.016)]), 28)
    out = None
    for z in places:
        for sign in (-1, 1):
            piece = disc.at((sign * (GAUGE + 0.012), 0.036 + radius, z), (0, 0, -90 * sign))
            out = piece if out is None else out + piece
    return out


def engine():
    """A steam engine: front towards +z, standing on the rails, 42 cm long."""
    g = Glb()
    red = g.material("red lacquer", (0.60, 0.03, 0.02), 0, 0.22)
    black = g.material("black lacquer", (0.025, 0.025, 0.03), 0, 0.30)
    brass = g.material("brass", (0.95, 0.68, 0.35), 1, 0.25)
    beech = g.material("beech", (0.72, 0.50, 0.28), 0, 0.5)
    lamp = g.material("lamp", (0.9, 0.8, 0.6), 0, 0.3, emissive=(1, 0.75, 0.4), strength=3.0)
    frame = rounded_box((0.17, 0.035, 0.42), 0.012, 3).at((0, 0.105, 0))
    boiler = capsule((0, 0.195, -0.04), (0, 0.195, 0.12), 0.072)
    cab = rounded_box((0.17, 0.17, 0.13), 0.014, 3).at((0, 0.205, -0.125))
    roof = rounded_box((0.20, 0.02, 0.17), 0.009, 3).at((0, 0.30, -0.125))
    chimney = lathe(curve([(0.0, 0.115), (0.034, 0.11), (0.036, 0.09), (0.021, 0.05), (0.020, 0.0)], 6), 32, crease=60).at((0, 0.255, 0.12))
    dome = sphere(0.032, 24).at((0, 0.265, 0.02))
    bands = None
    for z in (-0.02, 0.06, 0.135):
        ring = torus(0.0725, 0.0045, 40, 8).at((0, 0.195, z), (90, 0, 0))
        bands = ring if bands is None else bands + ring
    light = sphere(0.02, 20).at((0, 0.195, 0.195))
    g.node("Engine", g.mesh("engine", (cab + boiler, red), (frame + chimney + roof, black), (dome + bands, brass), (wheels((-0.14, 0.0, 0.14), 0.045), beech), (light, lamp)))
    return g.bytes()


def wagon():
    """An open wagon with a load of painted balls, 34 cm long."""
    g = Glb()
    blue = g.material("blue lacquer", (0.03, 0.13, 0.42), 0, 0.25)
    beech = g.material("beech", (0.72, 0.50, 0.28), 0, 0.5)
    yellow = g.material("yellow", (0.90, 0.60, 0.06), 0, 0.3)
    green = g.material("green", (0.10, 0.42, 0.12), 0, 0.3)
    floor = rounded_box((0.17, 0.03, 0.34), 0.012, 3).at((0, 0.105, 0))
    sides = rounded_box((0.012, 0.08, 0.32), 0.005, 2).at((-0.08, 0.15, 0)) + rounded_box((0.012, 0.08, 0.32), 0.005, 2).at((0.08, 0.15, 0)) \
        + rounded_box((0.16, 0.08, 0.012), 0.005, 2).at((0, 0.15, -0.155)) + rounded_box((0.16, 0.08, 0.012), 0.005, 2).at((0, 0.15, 0.155))
    ball = sphere(0.045, 28)
    yellows = ball.at((-0.03, 0.165, 0.09)) + ball.at((0.03, 0.165, 0.0)) + ball.at((-0.02, 0.165, -0.10))
    greens = ball.at((0.035, 0.165, 0.10)) + ball.at((-0.035, 0.17, 0.0)) + ball.at((0.04, 0.165, -0.09))
    g.node("Wagon", g.mesh("wagon", (floor + sides, blue), (wheels((-0.11, 0.11), 0.04), beech), (yellows, yellow), (greens, green)))
    return g.bytes()


MAKERS = {"railway": railway, "engine": engine, "wagon": wagon}
