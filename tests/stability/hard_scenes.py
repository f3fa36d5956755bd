"""Scenes of the hard cases: two or three blocks of a few cells.

Lengths are in cells of h = 0.1 m, velocities in wave speeds c of the usual material, times in h / c.
"""

import math
import os

import numpy as np
from scipy.spatial.transform import Rotation

from mpmfw.geometry.solid import turning
from scenes_for_tests import scene_of

CELL = 0.1  # m

#: Whether the long cases run in full: 1e5 steps at rest, 100 cells of sliding.
FULL = bool(os.environ.get("MPMFW_FULL_STABILITY"))

YOUNG, DENSITY, POISSON = 1e6, 1000.0, 0.3  # Pa, kg/m³


def solid(stiffness=1.0, density=1.0, poisson=POISSON):
    """A Neo-Hookean solid, so many times as stiff and as dense as the usual one."""
    young = stiffness * YOUNG
    return {
        "model": "neo_hookean",
        "density": density * DENSITY,
        "bulk_modulus": young / (3.0 * (1.0 - 2.0 * poisson)),
        "shear_modulus": young / (2.0 * (1.0 + poisson)),
    }


def wave_speed(material):
    """c = sqrt((K + 4 G / 3) / ρ) [m/s]."""
    modulus = material["bulk_modulus"] + 4.0 / 3.0 * material["shear_modulus"]
    return math.sqrt(modulus / material["density"])


USUAL = solid()
C = wave_speed(USUAL)
TICK = CELL / C  # s


def block(lower, upper, velocity=None, **keys):
    """A rectangle or a box [cells] with a velocity [c]."""
    kind = "rectangle" if len(lower) == 2 else "box"
    geometry = {"type": kind, "lower": [CELL * x for x in lower], "upper": [CELL * x for x in upper]}
    geometry |= {key: keys.pop(key) for key in ("angle", "angles") if key in keys}
    return _body(geometry, velocity or (0.0,) * len(lower), **keys)


def disc(centre, radius, velocity, **keys):
    """A disc [cells] with a velocity [c]."""
    geometry = {"type": "disc", "centre": [CELL * x for x in centre], "radius": CELL * radius}
    return _body(geometry, velocity, **{"layout": "fitted", **keys})


def _body(geometry, velocity, *, layout="lattice", kind="usual", **keys):
    particles = {"layout": layout, "size": 0.5 * CELL}
    moving = {"velocity": [C * v for v in velocity]}
    return {"material": kind, "geometry": geometry, "particles": particles, **moving, **keys}


def scene(bodies, *, friction=0.3, extent=25.0, materials=None, **keys):
    """A scene of these bodies."""
    dim = 3 if any(body["geometry"]["type"] == "box" for body in bodies.values()) else 2
    corners = [-CELL * extent] * dim, [CELL * extent] * dim
    materials = {"usual": USUAL, **(materials or {})}
    contact = {"method": "penalty", "friction": friction}
    # The end means nothing: steps are counted
    return scene_of(bodies, CELL, *corners, end=1.0, contact=contact, materials=materials, **keys)


def impact(gap=0.1, speed=0.03, other=None, **keys):
    """Two blocks of three cells that approach along x, a little askew; the right one of another material."""
    bodies = {
        "left": block((-3.2, -1.6), (-0.2, 1.4), (0.5 * speed, 0.1 * speed)),
        "right": block(
            (gap - 0.2, -1.4), (gap + 2.8, 1.6), (-0.5 * speed, 0.0), kind="other" if other else "usual"
        ),
    }
    return scene(bodies, materials={"other": other} if other else None, **keys)


def soft_and_stiff(ratio):
    """Blocks that touch; the right one so many times as stiff."""
    return impact(0.0, other=solid(stiffness=ratio))


def corner_on_flat():
    """A square on its corner against a face."""
    bodies = {
        "corner": block((-4.0, -1.3), (-1.0, 1.7), (0.02, 0.0), angle=math.pi / 4),
        "flat": block((-0.3, -2.0), (2.7, 2.0), (-0.02, 0.0)),
    }
    return scene(bodies)


def corner_on_corner():
    """Two squares that meet tip on tip, a tenth of a cell askew."""
    reach = 1.5 * math.sqrt(2.0)
    bodies = {
        "left": block((-1.5 - reach, -1.5), (1.5 - reach, 1.5), (0.02, 0.0), angle=math.pi / 4),
        "right": block((-1.4 + reach, -1.4), (1.6 + reach, 1.6), (-0.02, 0.0), angle=math.pi / 4),
    }
    return scene(bodies)


def thin():
    """A plate half a cell thick that a block hits."""
    bodies = {
        "block": block((-2.4, -1.5), (-0.1, 1.3), (0.02, 0.0)),
        "plate": block((0.1, -2.0), (0.6, 2.0)),
    }
    return scene(bodies)


def three_at_a_node():
    """Three blocks whose corners meet at the origin."""
    bodies = {
        "left": block((-3.05, -2.0), (-0.05, 1.0), (0.02, 0.0)),
        "right": block((0.05, -2.0), (3.05, 1.0), (-0.02, 0.0)),
        "top": block((-1.5, 1.05), (1.5, 4.05), (0.0, -0.02)),
    }
    return scene(bodies)


def oblique():
    """0.2 c along the normal and 0.224 c across it: 0.3 c in all."""
    bodies = {
        "left": block((-3.2, -2.6), (-0.2, 0.4), (0.1, 0.112)),
        "right": block((0.2, -0.4), (3.2, 2.6), (-0.1, -0.112)),
    }
    return scene(bodies)


def spin():
    """A disc with a rim speed of 0.1 c that is driven onto a block."""
    bodies = {
        "disc": disc((0.0, 2.2), 2.0, (0.0, -0.03), angular_velocity=0.1 * C / (2.0 * CELL)),
        "block": block((-3.0, -2.9), (3.0, 0.1)),
    }
    return scene(bodies, friction=0.5)


def parting():
    """Blocks that touch and move apart."""
    bodies = {
        "left": block((-3.2, -1.5), (-0.2, 1.5), (-0.01, 0.0)),
        "right": block((-0.2, -1.5), (2.8, 1.5), (0.01, 0.0)),
    }
    return scene(bodies)


def rest(bodies, half_width=4.0, **keys):
    """Bodies that have settled on a ground under gravity; the ground's face is y = 0, in the plane and in
    space.
    """
    dim = len(next(iter(bodies.values()))["velocity"])
    lower, upper = (-half_width, -2.0, -half_width)[:dim], (half_width, 0.0, half_width)[:dim]
    ground = block(lower, upper, kind="ground", sides=[{"side": "bottom", "fixed": True}])
    del ground["velocity"]
    return scene(
        {**bodies, "ground": ground},
        materials={"ground": solid(4.0)},
        gravity={"vector": [0.0, -10.0, 0.0][:dim]},
        settle={"tolerance": 1e-3},
        **keys,
    )


def stack():
    """Five blocks at rest."""
    blocks = {f"block{k}": block((-1.0, 2.0 * k), (1.0, 2.0 * k + 2.0)) for k in range(5)}
    return rest(blocks)


def long_rest():
    """A block at rest."""
    return rest({"block": block((-1.5, 0.0), (1.5, 3.0))})


def long_sliding():
    """A block that slides across 100 cells in full and 10 else."""
    length = 100.0 if FULL else 10.0
    slider = block((0.5 - length / 2, 0.0), (3.5 - length / 2, 3.0), (0.04, 0.0))
    return rest({"block": slider}, length / 2 + 5.0, friction=0.01, extent=length / 2 + 20.0)


def slow():
    """Blocks that touch and hardly move."""
    return impact(0.0, 0.005)


# -- scenes moved and turned as a whole
#: Shifts of the whole scene [cells] and turns [°]; in space about x, then y, then z.
PLACES = [(shift, turn) for turn in (0, 30) for shift in ((0.0, 0.0), (0.31, 0.17), (0.5, 0.77))]
PLACES_IN_SPACE = [
    (shift, turn) for turn in ((0, 0, 0), (20, 35, 50)) for shift in ((0.0, 0.0, 0.0), (0.31, 0.17, 0.77))
]


def rotation_of(turn):
    """Matrix of a turn [°]: counter-clockwise in the plane; in space three, about x, then y, then z."""
    if isinstance(turn, tuple):
        return turning(tuple(np.radians(turn)))
    angle = math.radians(turn)
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def placed(mapping, shift, turn):
    """Return the scene turned about the origin by ``turn`` [°], then shifted by cells.

    Geometry, velocities and gravity turn; the grid does not. In the plane a ground, which is fixed below,
    keeps a level bottom."""
    rotation, offset = rotation_of(turn), CELL * np.array(shift)
    bodies = {}
    for name, body in mapping["bodies"].items():
        made = {
            **body,
            "geometry": _moved(body["geometry"], rotation, offset, turn, bool(body.get("sides"))),
        }
        if "velocity" in body:
            made["velocity"] = (rotation @ body["velocity"]).tolist()
        bodies[name] = made
    changed = {**mapping, "bodies": bodies}
    if "gravity" in mapping:
        changed["gravity"] = {"vector": (rotation @ mapping["gravity"]["vector"]).tolist()}
    return changed


def _moved(g, rotation, offset, turn, ground):
    if g["type"] == "box":
        lower, upper = np.array(g["lower"]), np.array(g["upper"])
        by = rotation @ (0.5 * (lower + upper)) + offset - 0.5 * (lower + upper)
        both = Rotation.from_matrix(rotation @ turning(g.get("angles", (0.0, 0.0, 0.0))))
        angles = both.as_euler("xyz").tolist()
        return {**g, "lower": (lower + by).tolist(), "upper": (upper + by).tolist(), "angles": angles}
    angle = math.radians(turn)
    if g["type"] == "disc":
        return {**g, "centre": (rotation @ g["centre"] + offset).tolist()}
    if g["type"] == "polygon":
        return {**g, "points": (np.array(g["points"]) @ rotation.T + offset).tolist()}
    lower, upper = np.array(g["lower"]), np.array(g["upper"])
    if ground and angle:
        left, right = rotation @ [lower[0], upper[1]], rotation @ upper
        bottom = min(left[1], right[1]) - (upper - lower)[1]
        points = np.array([left, [left[0], bottom], [right[0], bottom], right]) + offset
        return {"type": "polygon", "points": points.tolist()}
    centre, half = rotation @ (0.5 * (lower + upper)) + offset, 0.5 * (upper - lower)
    turned = {"lower": (centre - half).tolist(), "upper": (centre + half).tolist()}
    return {"type": "rectangle", **turned, "angle": g.get("angle", 0.0) + angle}
