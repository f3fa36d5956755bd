"""Scenes moved and turned as a whole, and a design that covers all pairs of choices."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

CELL = 0.1  # m

#: Shifts of the whole scene [cells], and turns [°].
SHIFTS = ((0.0, 0.0), (0.31, 0.17), (0.5, 0.77))
TURNS = (0, 30)


def placed(mapping: dict[str, Any], shift: tuple[float, float], turn: float) -> dict[str, Any]:
    """The scene turned about the origin by ``turn`` [°] counter-clockwise, then shifted by cells.

    Geometry, velocities and gravity turn; the grid does not. A ground, which is fixed below, keeps a level bottom.
    """
    angle = math.radians(turn)
    rotation = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    offset = CELL * np.array(shift)
    bodies = {}
    for name, body in mapping["bodies"].items():
        made = {
            **body,
            "geometry": _moved(body["geometry"], rotation, offset, angle, bool(body.get("sides"))),
        }
        if "velocity" in body:
            made["velocity"] = (rotation @ body["velocity"]).tolist()
        bodies[name] = made
    changed = {**mapping, "bodies": bodies}
    if "gravity" in mapping:
        changed["gravity"] = {"vector": (rotation @ mapping["gravity"]["vector"]).tolist()}
    return changed


def _moved(g: dict[str, Any], rotation: Any, offset: Any, angle: float, ground: bool) -> dict[str, Any]:
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


def covering(*factors: Sequence[Any]) -> list[tuple[Any, ...]]:
    """Rows in which every two choices of different factors meet, greedily few, and always the same."""
    pairs = list(itertools.combinations(range(len(factors)), 2))
    open_ = {
        ((i, a), (j, b)): None
        for i, j in pairs
        for a in range(len(factors[i]))
        for b in range(len(factors[j]))
    }
    rows = []
    while open_:
        row = dict(next(iter(open_)))
        for k in range(len(factors)):
            if k not in row:
                gains = [
                    sum(tuple(sorted([(k, v), other])) in open_ for other in row.items())
                    for v in range(len(factors[k]))
                ]
                row[k] = gains.index(max(gains))
        for i, j in pairs:
            open_.pop(((i, row[i]), (j, row[j])), None)
        rows.append(tuple(factors[k][row[k]] for k in range(len(factors))))
    return rows
