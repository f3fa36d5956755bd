"""Where the sides of a body are at the start."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.scene.sides import AXIS, UPPER
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body

if TYPE_CHECKING:
    from mpmfw.runs.build import Build
    from mpmfw.scene.tables import Side

#: Distance within which an outline lies on a side [cells].
FLAT = 1e-6


def sides_of(made: Build, *, loaded: bool) -> list[tuple[Body, Side]]:
    """Bodies and their sides under a load, or those whose motion is prescribed."""
    given = [(body, side) for body in made.state.bodies for side in made.scene.bodies[body.name].sides]
    return [(body, side) for body, side in given if side.is_loaded == loaded]


def face_of(made: Build, body: Body, side: Side) -> tuple[FloatArray, float]:
    """Outward unit normal n of a body's side, and n·x on it [m]; the sides of a turned body are its own."""
    axes = made.scene.bodies[body.name].geometry.axes
    normal = (1.0 if side.side in UPPER else -1.0) * axes[AXIS[side.side]]
    if body.outlines:
        return normal, max(float((loop @ normal).max()) for loop in body.outlines)
    return normal, float(np.maximum(normal * body.lower, normal * body.upper).sum())
