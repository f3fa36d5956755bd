"""Where the sides of a body are at the start."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.scene.sides import AXIS, UPPER
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body

if TYPE_CHECKING:
    from mpmfw.plugin.setup import Setup
    from mpmfw.scene.tables import Side

#: Distance within which an outline lies on a side [cells].
FLAT = 1e-6


def face_of(setup: Setup, body: Body, side: Side) -> tuple[FloatArray, float]:
    """Outward unit normal n of a body's side, and n·x on it [m]; the sides of a turned body are its own."""
    axes = setup.scene.bodies[body.name].geometry.axes
    normal = (1.0 if side.side in UPPER else -1.0) * axes[AXIS[side.side]]
    if body.outlines:
        return normal, max(float((loop @ normal).max()) for loop in body.outlines)
    return normal, float(np.maximum(normal * body.lower, normal * body.upper).sum())
