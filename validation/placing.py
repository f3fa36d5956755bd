"""A scene at another place of the grid: shifted, turned, and with other cells."""

import itertools
import math
from typing import Any

import numpy as np

from mpmfw.units import to_si


def placed(
    scene: dict[str, Any], shift: tuple[float, float] = (0.0, 0.0), turn: float = 0.0, coarser: float = 1.0
) -> dict[str, Any]:
    """The scene with cells ``coarser`` times as large, turned about the origin by ``turn`` [°], then shifted
    by so many cells.

    Bodies, velocities, gravity and body forces turn, the grid does not; it grows round them. A polygon that
    is fixed below goes on to a level side there."""
    cell = coarser * float(scene["grid"]["cell_size"])
    angle = math.radians(turn)
    turning, offset = rotation(angle), cell * np.array(shift)
    made = {**scene, "grid": _grid(scene["grid"], coarser, turning, offset), "bodies": {}}
    for name, body in scene["bodies"].items():
        changed = {**body, "geometry": _moved(body, turning, offset, angle)}
        if "velocity" in body:
            changed["velocity"] = (turning @ body["velocity"]).tolist()
        made["bodies"][name] = changed
    if "gravity" in scene:
        made["gravity"] = {key: _turned(given, turning) for key, given in scene["gravity"].items()}
    for name, load in scene.get("loads", {}).items():
        made["loads"] = {**made["loads"], name: {**load, "force": _turned(load["force"], turning)}}
    return made


def rotation(angle: float) -> np.ndarray:
    """Return the rotation by ``angle`` [rad]; its columns are the turned axes."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def _grid(grid: dict[str, Any], coarser: float, turning: np.ndarray, offset: np.ndarray) -> dict[str, Any]:
    """A grid in whose cells the origin lies as in the scene's."""
    low, high = np.array(grid["lower"], float), np.array(grid["upper"], float)
    corners = np.array(list(itertools.product(*zip(low, high, strict=True)))) @ turning.T + offset
    cell, low = coarser * float(grid["cell_size"]), coarser * low
    lower = low - np.ceil((low - corners.min(0)) / cell) * cell
    return {**grid, "cell_size": cell, "lower": lower.tolist(), "upper": corners.max(0).tolist()}


def _turned(given: Any, turning: np.ndarray) -> Any:
    """A vector, or rows of time and vector."""
    rows = np.array(given, float)
    if rows.ndim == 1:
        return (turning @ rows).tolist()
    return np.column_stack([rows[:, 0], rows[:, 1:] @ turning.T]).tolist()


def _moved(body: dict[str, Any], turning: np.ndarray, offset: np.ndarray, angle: float) -> dict[str, Any]:
    shape = body["geometry"]
    if "centre" in shape:
        return {**shape, "centre": (turning @ shape["centre"] + offset).tolist()}
    if shape["type"] == "polygon":
        points = np.array(shape["points"], float)
        moved = points @ turning.T + offset
        if any("fixed" in side for side in body.get("sides", ())) and angle:
            moved = _to_level(points, moved)
        return {**shape, "points": moved.tolist()}
    lower, upper = np.array(shape["lower"], float), np.array(shape["upper"], float)
    centre, half = turning @ (0.5 * (lower + upper)) + offset, 0.5 * (upper - lower)
    own = float(to_si(shape.get("angle", 0.0), "rad"))
    return {
        **shape,
        "lower": (centre - half).tolist(),
        "upper": (centre + half).tolist(),
        "angle": own + angle,
    }


def _to_level(points: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Return the turned polygon, its lower side drawn down to a level one below its lowest corner."""
    low = points[:, 1].min()
    k = next(k for k in range(len(points)) if points[k, 1] == low and points[(k + 1) % len(points), 1] == low)
    ends = moved[[k, (k + 1) % len(points)]]
    level = moved[:, 1].min() - 0.1 * np.ptp(moved[:, 1])
    feet = [[x, level] for x in ends[:, 0]]
    return np.insert(moved, k + 1, feet, axis=0)
