"""The asset of shots/rolling.yaml."""
from .toolkit import *


def blade(begin, end):
    """The part of a twisted blade along +x between two fractions of its length; a closed loop of points at every radius."""
    s = np.linspace(begin, end, max(3, round(60 * (end - begin))))[:, None]
    around = np.linspace(0, TAU, 25)[None]
    radius = 0.05 + 0.73 * s
    # Chord: a shank, the widest place at a third, a rounded tip.
    chord = 0.055 + 0.085 * np.sin(np.pi * np.clip(1.25 * s, 0, 1)) ** 2 + 0.02 * s
    chord = chord * np.sqrt(np.clip(1 - np.clip((s - 0.9) / 0.1, 0, 1) ** 2, 1e-4, 1))
    pitch = np.radians(62 - 44 * s)
    along, thick = 0.5 * chord * np.cos(around), 0.5 * (0.26 - 0.17 * s) * chord * np.sin(around)
    points = np.stack(np.broadcast_arrays(radius, along * np.cos(pitch) - thick * np.sin(pitch), along * np.sin(pitch) + thick * np.cos(pitch)), -1)
    uv = np.stack(np.broadcast_arrays(around / TAU, s), -1)
    piece = grid(points, uv)
    # Outwards is away from the blade's axis.
    axis = np.concatenate([piece.position[:, :1], np.zeros((len(piece.position), 2))], axis=1)
    inside_out = ((piece.position - axis) * piece.normal).sum() < 0
    return Mesh(piece.position, -piece.normal, piece.uv, piece.index[:, ::-1]) if inside_out else piece


def propeller():
    """A propeller with three blades of dark wood with painted tips, that turns about z; its hub is the origin."""
    g = Glb()
    wood = g.material("lacquer", (0.055, 0.03, 0.022), 0, 0.28)
    white = g.material("white band", (0.85, 0.83, 0.78), 0, 0.4)
    red = g.material("red tip", (0.72, 0.055, 0.03), 0, 0.4)
    metal = g.material("spinner", (0.86, 0.84, 0.80), 1, 0.18)
    parts = []
    for begin, end, material in ((0, 0.7, wood), (0.7, 0.77, white), (0.77, 0.93, red), (0.93, 1, red)):
        whole = None
        for k in range(3):
            piece = blade(begin, end).at((0, 0, 0), (0, 0, 90 + 120 * k))
            whole = piece if whole is None else whole + piece
        parts.append((whole, material))
    hub = lathe(curve([(0.0, 0.17), (0.035, 0.155), (0.075, 0.09), (0.09, 0.0), (0.09, -0.05), (0.0, -0.05)], 10), 64, crease=50).at((0, 0, 0), (90, 0, 0))
    g.node("Propeller", g.mesh("propeller", *parts, (hub, metal)))
    return g.bytes()


MAKERS = {"propeller": propeller}
