"""Outputs that are wrong in one place."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from faulty_plugins.sealed import Sealed
from mpmfw.api import Field, FloatArray, OutputSeries, State


class Sound(OutputSeries):
    """Way of every body's centre of mass since the start."""

    name = "sound"

    def series(self) -> list[Field]:
        return [Field("way", ("body", "axis"), "m", "way of the centre of mass")]

    def values(self, state: State, interval: float) -> dict[str, FloatArray]:  # noqa: ARG002
        p = state.particles
        centre = np.array([self.middle(p.position[b.particles], p.mass[b.particles]) for b in state.bodies])
        if not hasattr(self, "start"):
            self.start = centre
        return {"way": centre - self.start}

    def middle(self, position: FloatArray, mass: FloatArray) -> FloatArray:
        """Centre of mass [m]."""
        found: FloatArray = mass @ position / mass.sum()
        return found


class NoUnit(Sound):
    """Says no unit."""

    name = "no-unit"

    def series(self) -> list[Field]:
        return [Field("way", ("body", "axis"), "", "way of the centre of mass")]


class OtherDims(Sound):
    """Declares axis and body, and has body and axis."""

    name = "other-dims"

    def series(self) -> list[Field]:
        return [Field("way", ("axis", "body"), "m", "way of the centre of mass")]

    def values(self, state: State, interval: float) -> dict[str, FloatArray]:
        return {"way": super().values(state, interval)["way"][:, :1]}


class Infinite(Sound):
    """Divides by the interval, which is 0 at the start."""

    name = "infinite"

    def values(self, state: State, interval: float) -> dict[str, FloatArray]:
        with np.errstate(all="ignore"):
            return {"way": (1.0 + super().values(state, interval)["way"]) / np.float64(interval)}


class Brakes(Sound):
    """Slows what it looks at, through another name of the array than the one that is held."""

    name = "brakes"

    def values(self, state: State, interval: float) -> dict[str, FloatArray]:
        for array in (state.particles.velocity,):
            array.setflags(write=True)
            array *= 0.999
        return super().values(state, interval)


class Replaces(Sound):
    """Puts another array in the place of the stresses."""

    name = "replaces"

    def values(self, state: State, interval: float) -> dict[str, FloatArray]:
        state.particles.stress = 0.999 * state.particles.stress
        return super().values(state, interval)


#: Outputs of all objects.
_COUNT = itertools.count()


class CountsElsewhere(Sound):
    """Sums up in the module, not in itself."""

    name = "counts-elsewhere"

    def values(self, state: State, interval: float) -> dict[str, FloatArray]:
        return {"way": super().values(state, interval)["way"] + float(next(_COUNT))}


class FirstBody(Sound):
    """Compares with the first body's."""

    name = "first-body"

    def values(self, state: State, interval: float) -> dict[str, FloatArray]:
        way = super().values(state, interval)["way"]
        return {"way": way - way[0]}


class Squared(Sound):
    """A length, declared as an area."""

    name = "squared"

    def series(self) -> list[Field]:
        return [Field("way", ("body", "axis"), "m2", "way of the centre of mass")]


class Rounded(Sound):
    """Whole micrometres."""

    name = "rounded"

    def values(self, state: State, interval: float) -> dict[str, FloatArray]:
        return {"way": 1e-6 * np.round(1e6 * super().values(state, interval)["way"])}


class NoWord(Sound):
    """A unit that there is not."""

    name = "no-word"

    def series(self) -> list[Field]:
        return [Field("way", ("body", "axis"), "metres per tick", "way of the centre of mass")]


class Summed(Sound):
    """Adds up what it finds at outputs, however far they are apart."""

    name = "summed"

    def values(self, state: State, interval: float) -> dict[str, FloatArray]:
        self.total = getattr(self, "total", 0.0) + super().values(state, interval)["way"]
        return {"way": self.total}


class Closed(Sealed, Sound):
    """Holds a function."""

    name = "closed"


#: The check that is meant for each.
FAULTS: dict[type[Any], str] = {
    NoUnit: "runs",
    OtherDims: "runs",
    Infinite: "runs",
    Brakes: "changes-nothing",
    Replaces: "changes-nothing",
    CountsElsewhere: "saved",
    FirstBody: "order",
    Squared: "unit",
    Rounded: "unit",
    NoWord: "runs",
    Summed: "outputs",
    Closed: "sent",
}
