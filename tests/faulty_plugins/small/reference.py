"""References that are wrong in one place: of a body that flies under gravity."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from faulty_plugins.sealed import Sealed
from mpmfw.api import About, Exact, FloatArray, Reference

SCENE = {
    "grid": {"cell_size": 0.25, "lower": [-1.5, -1.5], "upper": [1.5, 1.5]},
    "time": {"end": 0.05, "output_interval": 0.005},
    "shape": {"method": "linear"},
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
    "gravity": {"vector": [0.0, -40.0]},
}


class Sound(Reference):
    """A body that flies under gravity."""

    name = "sound"
    example = SCENE

    def exact(self, scene: Any, measure: str, about: About) -> Exact | None:
        if measure != "displacement" or scene.gravity is None or len(scene.bodies) > 1:
            return None
        axis = "xyz".index(about.axis)
        start, pull = float(scene.bodies["block"].velocity[axis]), float(scene.gravity.at(0.0)[axis])
        return self.said(start, pull)

    def said(self, start: float, pull: float) -> Exact | None:
        """Of a velocity at the start and an acceleration."""
        return Exact("closed-form", "v t + g t²/2", lambda t: self.way(start, pull, np.asarray(t)))

    def way(self, start: float, pull: float, time: FloatArray) -> FloatArray:
        return start * time + 0.5 * pull * time**2


class NoExample(Sound):
    """Says no example."""

    name = "no-example"
    example: ClassVar[dict[str, Any]] = {}


class Nothing(Sound):
    """Knows nothing."""

    name = "nothing"

    def exact(self, scene: Any, measure: str, about: About) -> Exact | None:
        return super().exact(scene, measure.upper(), about)


class OneValue(Sound):
    """The value at the last time alone."""

    name = "one-value"

    def way(self, start: float, pull: float, time: FloatArray) -> FloatArray:
        return super().way(start, pull, time)[-1:]


class WithoutHalf(Sound):
    """v t + g t²."""

    name = "without-half"

    def way(self, start: float, pull: float, time: FloatArray) -> FloatArray:
        return super().way(start, 2.0 * pull, time)


class OneAxis(Sound):
    """What is known along y is said of x as well."""

    name = "one-axis"

    def exact(self, scene: Any, measure: str, about: About) -> Exact | None:
        return super().exact(scene, measure, About(about.body, about.pair, "y"))


class Everything(Sound):
    """Knows every scene."""

    name = "everything"

    def exact(self, scene: Any, measure: str, about: About) -> Exact | None:
        return super().exact(scene, measure, about) or (
            self.said(0.0, 0.0) if measure == "displacement" else None
        )


class Grows(Sound):
    """The acceleration is another one each time."""

    name = "grows"
    asked = 0

    def way(self, start: float, pull: float, time: FloatArray) -> FloatArray:
        self.asked += 1
        return super().way(start, pull * (1.0 + 1e-4 * self.asked), time)


class Closed(Sealed, Sound):
    """Holds a function."""

    name = "closed"


FAULTS: dict[Any, str] = {
    NoExample: "runs", Nothing: "runs", OneValue: "runs", WithoutHalf: "agrees", OneAxis: "agrees", Everything: "others",
    Grows: "repeatable", Closed: "sent",
}  # fmt: skip
