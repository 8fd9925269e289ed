"""What bends: an octopus on joints, and a drop of glaze with morph targets."""
from .toolkit import *

ARMS, JOINTS, RINGS, SIDES = 8, 9, 33, 12
SECONDS, KEYS = 2.0, 25


def arm_line(s):
    """Rest pose of an arm in its own plane: how far out and how high at s in [0, 1]; down to the floor, then along it."""
    out = 0.16 + 1.02 * s
    return out, 0.075 + 0.40 * (1 - s) ** 3 * (1 - 0.55 * s) + 0.05 * s ** 6


def arm(angle):
    """Positions [ring][side], and the rings' places along the arm."""
    s, a = np.linspace(0, 1, RINGS), np.linspace(0, TAU, SIDES + 1)
    out, up = arm_line(s)
    direction, side = np.array([math.cos(angle), 0, math.sin(angle)]), np.array([-math.sin(angle), 0, math.cos(angle)])
    centre = out[:, None] * direction + up[:, None] * np.array([0, 1.0, 0])
    along = unit(np.gradient(centre, axis=0))
    lift = np.cross(side, along)
    radius = (0.115 * (1 - s) ** 0.8 + 0.012)[:, None, None]
    ring = np.cos(a)[None, :, None] * side + np.sin(a)[None, :, None] * lift[:, None]
    return centre[:, None] + radius * ring, s


def spline_weights(place):
    """Quadratic B-spline weights of the joints around each place (in joints): three influences that add up to 1."""
    nearest = np.clip(np.floor(place + 0.5), 0, JOINTS - 1).astype(int)
    t = np.clip(place - nearest, -0.5, 0.5)
    weights = np.stack([0.5 * (0.5 - t) ** 2, 0.75 - t ** 2, 0.5 * (0.5 + t) ** 2, np.zeros_like(t)], axis=-1)
    joints = np.stack([nearest - 1, nearest, nearest + 1, np.zeros_like(nearest)], axis=-1)
    return np.clip(joints, 0, JOINTS - 1), weights


def turned(axis, angle):
    """Quaternions x y z w about one axis, [key]."""
    half = np.asarray(angle) / 2
    return np.concatenate([np.sin(half)[:, None] * axis, np.cos(half)[:, None]], axis=-1)


def multiplied(p, q):
    v = p[:, 3:] * q[:, :3] + q[:, 3:] * p[:, :3] + np.cross(p[:, :3], q[:, :3])
    return np.concatenate([v, p[:, 3:] * q[:, 3:] - (p[:, :3] * q[:, :3]).sum(axis=1, keepdims=True)], axis=-1)


def skinned(g, primitive, joints, weights):
    """Adds JOINTS_0 and WEIGHTS_0 to a primitive."""
    view = g.view(np.asarray(joints).astype("<u2").tobytes())
    primitive["attributes"]["JOINTS_0"] = g.part("accessors", {"bufferView": view, "componentType": 5123, "count": len(joints), "type": "VEC4"})
    primitive["attributes"]["WEIGHTS_0"] = g.accessor(np.asarray(weights, float), "VEC4")


def octopus():
    """A head and eight arms of nine joints each, that curl and sway in a wave around the body; two seconds, seamless."""
    g = Glb()
    skin = g.material("skin", (0.62, 0.10, 0.055), 0, 0.32)
    pale = g.material("eye", (0.86, 0.72, 0.42), 0, 0.1)
    dark = g.material("pupil", (0.012, 0.010, 0.012), 0, 0.08)
    body = Mesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 2)), np.zeros((0, 3), int))
    joints, weights = [], []
    places = [np.array([0, 0.42, 0.0])]                 # joint 0 carries the head
    for k in range(ARMS):
        angle = TAU * (k + 0.5) / ARMS
        points, s = arm(angle)
        body = body + grid(points, wrap_columns=True)
        nearby, shares = spline_weights(s * (JOINTS - 1))
        joints.append(np.repeat(1 + k * JOINTS + nearby, SIDES + 1, axis=0))
        weights.append(np.repeat(shares, SIDES + 1, axis=0))
        for j in range(JOINTS):
            out, up = arm_line(j / (JOINTS - 1))
            places.append(np.array([out * math.cos(angle), up, out * math.sin(angle)]))
    mantle = lathe(curve([(0.0, 1.36), (0.20, 1.32), (0.36, 1.16), (0.40, 0.95), (0.33, 0.72), (0.24, 0.55), (0.26, 0.42), (0.20, 0.33), (0.0, 0.30)], 5), 40, crease=180)
    mantle = mantle.at((0, 0, -0.06), (-12, 0, 0))
    head = [(mantle, skin)]
    for side in (-1, 1):
        head.append((sphere(0.085, 24).at((0.185 * side, 0.66, 0.235)), pale))
        head.append((sphere(0.05, 16).at((0.205 * side, 0.665, 0.285), scale=(1.2, 0.55, 1)), dark))
    mesh = g.mesh("octopus", (body, skin), *head)
    primitives = g.json["meshes"][mesh]["primitives"]
    skinned(g, primitives[0], np.concatenate(joints), np.concatenate(weights))
    for primitive, (part, _) in zip(primitives[1:], head):
        count = len(part.position)
        skinned(g, primitive, np.zeros((count, 4), int), np.tile([1.0, 0, 0, 0], (count, 1)))

    root = g.node("Octopus")
    first = g.node("Head", None, places[0], parent=root)
    nodes = [first]
    for k in range(ARMS):
        for j in range(JOINTS):
            at = places[1 + k * JOINTS + j]
            parent, before = (first, places[0]) if j == 0 else (nodes[-1], places[k * JOINTS + j])
            nodes.append(g.node(f"Arm {k} {j}", None, at - before, parent=parent))
    bind = np.tile(np.eye(4), (len(places), 1, 1))
    bind[:, 3, :3] = -np.array(places)                  # columns first, as glTF stores matrices
    matrices = g.accessor(bind.reshape(-1, 16), "MAT4")
    g.part("skins", {"name": "octopus", "joints": nodes, "inverseBindMatrices": matrices})
    g.node("Body", mesh, parent=root, skin=0)

    time = np.linspace(0, SECONDS, KEYS)
    phase = TAU * time / SECONDS
    clip = {"name": "Wave", "samplers": [], "channels": []}
    times = g.accessor(time, "SCALAR", True)

    def channel(node, path, values, kind):
        clip["samplers"].append({"input": times, "output": g.accessor(values, kind), "interpolation": "LINEAR"})
        clip["channels"].append({"sampler": len(clip["samplers"]) - 1, "target": {"node": node, "path": path}})
    channel(first, "translation", places[0] + np.stack([0.03 * np.sin(phase), 0.055 * np.sin(2 * phase), 0 * phase], axis=-1), "VEC3")
    channel(first, "rotation", turned([0, 0, 1.0], 0.07 * np.sin(phase)), "VEC4")
    for k in range(ARMS):
        angle = TAU * (k + 0.5) / ARMS
        sideways = np.array([-math.sin(angle), 0, math.cos(angle)])
        for j in range(JOINTS):
            reach = j / (JOINTS - 1)
            wave = phase - TAU * k * 3 / ARMS - 2.6 * reach
            raised = 1.0 if k % 2 == 0 else 0.45
            curl = raised * (0.05 + 0.34 * reach) * (0.55 + np.sin(wave)) - 0.06 * np.sin(2 * phase) * (j == 0)
            sway = 0.22 * reach * np.cos(wave) + 0.05 * np.sin(phase + k)
            channel(nodes[1 + k * JOINTS + j], "rotation", multiplied(turned(np.array([0, 1.0, 0]), sway), turned(sideways, curl)), "VEC4")
    g.part("animations", clip)
    return g.bytes()


# ---------------------------------------------------------------------------------------------- drop

def drop_shape(radius_of):
    """A surface around the origin: radius_of(latitude from the top, longitude)."""
    theta, phi = np.linspace(1e-3, math.pi - 1e-3, 57)[:, None], np.linspace(0, -TAU, 81)[None]
    r = radius_of(theta, phi)
    return grid(np.stack(np.broadcast_arrays(r * np.sin(theta) * np.cos(phi), r * np.cos(theta), r * np.sin(theta) * np.sin(phi)), -1), wrap_columns=True)


def drop():
    """A ball with four morph targets and a clip that passes from one to the next: tall, flower, dented, twisted ribs."""
    g = Glb()
    glaze = g.material("glaze", (0.02, 0.30, 0.34), 0, 0.14)
    around = lambda k, turn: np.sin(k * turn)
    shapes = [drop_shape(lambda t, p: 0.62 + 0 * t * p),
              drop_shape(lambda t, p: 0.52 + 0.36 * np.exp(-(t / 0.42) ** 2) - 0.10 * np.exp(-((t - 1.0) / 0.5) ** 2) + 0 * p),
              drop_shape(lambda t, p: 0.60 + 0.24 * np.sin(t) ** 2 * np.cos(5 * p)),
              drop_shape(lambda t, p: 0.70 - 0.34 * np.exp(-(t / 0.55) ** 2) - 0.16 * np.exp(-((math.pi - t) / 0.5) ** 2) + 0 * p),
              drop_shape(lambda t, p: 0.60 + 0.07 * np.sin(t) ** 2 * around(9, p + 1.3 * t))]
    rest = shapes[0]
    mesh = g.mesh("drop", (rest, glaze))
    g.json["meshes"][mesh]["primitives"][0]["targets"] = [
        {"POSITION": g.accessor(s.position - rest.position, "VEC3", True), "NORMAL": g.accessor(s.normal - rest.normal, "VEC3")} for s in shapes[1:]]
    g.json["meshes"][mesh]["extras"] = {"targetNames": ["tall", "flower", "dented", "ribs"]}
    node = g.node("Drop", mesh)
    time = np.array([0, 0.5, 1.0, 1.5, 2.0])
    values = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0.25, 1, 0], [0, 0, 0.3, 1], [1, 0, 0, 0]], float)
    slope = np.zeros_like(values)
    cubic = np.stack([slope, values, slope], axis=1).reshape(-1)
    g.part("animations", {"name": "Morph", "samplers": [{"input": g.accessor(time, "SCALAR", True), "output": g.accessor(cubic, "SCALAR"), "interpolation": "CUBICSPLINE"}],
                          "channels": [{"sampler": 0, "target": {"node": node, "path": "weights"}}]})
    return g.bytes()


MAKERS = {"octopus": octopus, "drop": drop}
