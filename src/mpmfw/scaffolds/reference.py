"""What the motion of a scene is known to be: replace it by your own closed form."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from mpmfw.api import About, Exact, Reference

if TYPE_CHECKING:
    from mpmfw.scene import Scene


class Template(Reference):
    """A body that falls freely."""

    name = "template"
    example: ClassVar[Mapping[str, Any]] = {
        "grid": {"cell_size": 0.25, "lower": [-1.5, -1.5], "upper": [1.5, 1.5]},
        "time": {"end": 0.05, "output_interval": 0.005},
        "shape": {"method": "cpdi"},
        "materials": {
            "soft": {"model": "neo_hookean", "density": 1000.0, "bulk_modulus": 5e6, "shear_modulus": 3e6}
        },
        "bodies": {
            "block": {
                "material": "soft",
                "geometry": {"type": "rectangle", "lower": [-0.5, -0.5], "upper": [0.5, 0.5]},
                "particles": {"size": 0.125},
                "velocity": [1.0, 0.5],
            }
        },
        "gravity": {"vector": [0.0, -10.0]},
    }

    def exact(self, scene: Scene, measure: str, about: About) -> Exact | None:
        """The displacement of a body along an axis; None of what is not known."""
        if measure != "displacement" or scene.gravity is None or len(scene.bodies) > 1:
            return None
        body = about.body or next(iter(scene.bodies))
        axis = "xyz".index(about.axis)
        start = scene.bodies[body].velocity or (0.0,) * scene.dim
        v, g = float(start[axis]), scene.gravity.at(0.0)[axis]
        says = "free fall, v t + g t²/2"
        return Exact("closed-form", says, lambda t: v * t + 0.5 * g * np.asarray(t) ** 2)
