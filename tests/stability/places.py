"""Scenes moved and turned as a whole."""

import math

import numpy as np
from scipy.spatial.transform import Rotation

from mpmfw.geometry.solid import turning

CELL = 0.1  # m

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
