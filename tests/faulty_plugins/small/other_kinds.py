"""A boundary, an output, a measure and a reference, each sound and with random values."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from mpmfw.api import (
    About,
    AnyArray,
    Boundary,
    Exact,
    Field,
    FloatArray,
    Measure,
    Measured,
    OutputSeries,
    Reference,
    State,
)

RANDOM = np.random.default_rng(4)


class Shaken(Boundary):
    """Shake the lower half along x."""

    name = "shaken"

    def holds(self, position: FloatArray) -> AnyArray:
        held: AnyArray = position[:, 1] < 0.0
        return held

    def velocity(self, position: FloatArray, time: float) -> FloatArray:
        found = np.full_like(position, np.nan)
        found[:, 0] = self.speed(time)
        return found

    def speed(self, time: float) -> float:
        return float(np.cos(20.0 * time))


class RandomlyShaken(Shaken):
    def speed(self, time: float) -> float:
        return float(RANDOM.random()) + time


class Fastest(OutputSeries):
    """Record the largest speed of every body."""

    name = "fastest"
    factor: ClassVar[Any] = staticmethod(lambda: 1.0)

    def series(self) -> list[Field]:
        return [Field("speed", ("body",), "m s-1", "largest speed", missing=True)]

    def values(self, state: State, interval: float) -> dict[str, FloatArray]:  # noqa: ARG002
        speed = np.sqrt((state.particles.velocity**2).sum(axis=1)) * self.factor()
        largest = np.full(len(state.bodies), np.nan)
        for body in self.bodies:
            largest[body.index] = speed[body.particles].max()
        return {"speed": largest}


class RandomlyFast(Fastest):
    factor = RANDOM.random


class TopSpeed(Measure):
    """Largest speed of the first body's centre along x."""

    name = "top-speed"
    unit = "m s-1"
    kind = "number"
    factor: ClassVar[Any] = staticmethod(lambda: 1.0)

    def of(self, run: Any, scene: Any, about: About) -> Measured:
        body = about.body or next(iter(scene.bodies))
        speed = run["series"]["mean_velocity"].sel(body=body, axis="x")
        return Measured(np.array([float(np.abs(speed).max()) + self.factor()]), np.empty(0))


class RandomSpeed(TopSpeed):
    factor = RANDOM.random


class Flight(Reference):
    """A body that flies under gravity."""

    name = "flight"
    example: ClassVar[dict[str, Any]] = {
        "grid": {"cell_size": 0.25, "lower": [-1.5, -1.5], "upper": [1.5, 1.5]},
        "time": {"end": 0.05, "output_interval": 0.005},
        "shape": {"method": "linear"},
        "materials": {
            "soft": {"model": "neo_hookean", "density": 1e3, "bulk_modulus": 5e6, "shear_modulus": 3e6}
        },
        "bodies": {
            "block": {
                "material": "soft",
                "geometry": {"type": "rectangle", "lower": [-0.5, -0.5], "upper": [0.5, 0.5]},
                "particles": {"size": 0.125},
            }
        },
    }
    factor: ClassVar[Any] = staticmethod(lambda: 1.0)

    def exact(self, scene: Any, measure: str, about: About) -> Exact | None:  # noqa: ARG002
        if measure != "displacement":
            return None
        return Exact("closed-form", "rest", lambda t: self.factor() * np.asarray(t))


class RandomFlight(Flight):
    factor = RANDOM.random


KINDS = {
    "boundary": (Shaken, RandomlyShaken),
    "output": (Fastest, RandomlyFast),
    "measure": (TopSpeed, RandomSpeed),
    "reference": (Flight, RandomFlight),
}
