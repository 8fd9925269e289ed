"""The asset of `paint`: a vase, two shells and a lamp whose light and glow a clip drives by KHR_animation_pointer."""
import numpy as np

from .toolkit import *  # noqa: F403  (the toolkit is this module's language)


def pointer_channel(g, animation, pointer, times, values, kind):
    sampler = len(animation["samplers"])
    animation["samplers"].append({"input": g.accessor(np.array(times, float), "SCALAR", True), "output": g.accessor(np.array(values, float), kind)})
    animation["channels"].append({"sampler": sampler, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}})


def vases():
    """A lacquered vase between two shells, and a lamp that swells and turns from amber to blue within two seconds."""
    g = Glb()
    lacquer = g.material("Lacquer", (0.55, 0.03, 0.02), 0.0, 0.35)
    brass = g.material("Brass", (0.72, 0.50, 0.22), 1.0, 0.25)
    shell = g.material("Shell", (0.80, 0.78, 0.72), 0.0, 0.3)
    glow = g.material("Glow", (0.02, 0.02, 0.02), 0.0, 0.5, emissive=(1, 1, 1), strength=4.0)
    profile = curve([(0.0, 0.0), (0.26, 0.0), (0.30, 0.05), (0.46, 0.45), (0.44, 0.78), (0.22, 1.12), (0.17, 1.30), (0.24, 1.46)], 7)
    profile[0, 0] = 0
    body = lathe(profile, 56, crease=60)
    g.node("Vase", g.mesh("vase", (body, lacquer), (torus(0.24, 0.022, 56, 14).at((0, 1.46, 0)) + torus(0.29, 0.03, 56, 14).at((0, 0.03, 0)), brass)))
    egg = g.mesh("shell", (sphere(0.36, 40).at(scale=(1, 1.16, 1)), shell))
    for side, name in ((-1, "Left"), (1, "Right")):
        g.node(f"Shell {name}", egg, (side * 1.08, 0.42, 0.15))
    g.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"name": "Lamp", "type": "point", "color": [1, 0.6, 0.25], "intensity": 2.0}]}}
    g.used |= {"KHR_lights_punctual", "KHR_animation_pointer"}
    g.node("Bulb", g.mesh("bulb", (sphere(0.09, 24), glow)), (0.62, 0.1, 0.75))
    g.node("Lamp", None, (0.62, 0.32, 0.75), extensions={"KHR_lights_punctual": {"light": 0}})
    animation = {"name": "Swell", "channels": [], "samplers": []}
    times = [0, 0.5, 1.0, 1.5, 2.0]
    strengths = [0.2, 1.0, 0.5, 1.4, 0.2]
    colors = [(1, 0.6, 0.25), (1, 0.6, 0.25), (0.9, 0.75, 0.7), (0.35, 0.6, 1), (0.35, 0.6, 1)]
    pointer_channel(g, animation, "/extensions/KHR_lights_punctual/lights/0/intensity", times, [3.0 * s for s in strengths], "SCALAR")
    pointer_channel(g, animation, "/extensions/KHR_lights_punctual/lights/0/color", times, colors, "VEC3")
    pointer_channel(g, animation, "/materials/3/emissiveFactor", times, colors, "VEC3")
    pointer_channel(g, animation, "/materials/3/extensions/KHR_materials_emissive_strength/emissiveStrength", times, [12.0 * s for s in strengths], "SCALAR")
    g.part("animations", animation)
    return g.bytes()


MAKERS = {"vases": vases}
