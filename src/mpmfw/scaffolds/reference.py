"""What the motion of a scene is known to be: replace it by your own closed form."""

from __future__ import annotations

import numpy as np

from mpmfw.campaigns.exact import Exact
from mpmfw.campaigns.measures import About
from mpmfw.scene import Scene


def template(scene: Scene, measure: str, about: About) -> Exact | None:
    """A body that falls freely: its displacement along an axis; None of what is not known."""
    if measure != "displacement" or scene.gravity is None:
        return None
    body = about.body or next(iter(scene.bodies))
    axis = "xyz".index(about.axis)
    start = scene.bodies[body].velocity or (0.0,) * scene.dim
    v, g = float(start[axis]), scene.gravity.at(0.0)[axis]
    return Exact("closed-form", "free fall, v t + g t²/2", lambda t: v * t + 0.5 * g * np.asarray(t) ** 2)
