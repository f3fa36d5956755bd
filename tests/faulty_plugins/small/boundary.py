"""Boundary conditions that are wrong in one place."""

from __future__ import annotations

from typing import Any

import numpy as np

from faulty_plugins.sealed import Sealed
from mpmfw.api import AnyArray, Boundary, FloatArray, Grid, hookimpl


class Sound(Boundary):
    """The lower half shakes along x, the more the higher, and is free along y."""

    name = "sound"

    def holds(self, position: FloatArray) -> AnyArray:
        held: AnyArray = position[:, 1] < 0.0
        return held

    def velocity(self, position: FloatArray, time: float) -> FloatArray:
        found = np.full_like(position, np.nan)
        found[:, 0] = np.cos(20.0 * time) * (1.0 + position[:, 1])
        return found


class OneForAll(Sound):
    """Answers with one velocity for all places."""

    name = "one-for-all"

    def velocity(self, position: FloatArray, time: float) -> FloatArray:
        return super().velocity(position, time)[0]


class EndsInInfinity(Sound):
    """Divides by the time."""

    name = "ends-in-infinity"

    def velocity(self, position: FloatArray, time: float) -> FloatArray:
        with np.errstate(all="ignore"):
            return super().velocity(position, time) / np.float64(time)


class Counts(Sound):
    """Slows with every call."""

    name = "counts"

    def velocity(self, position: FloatArray, time: float) -> FloatArray:
        self.calls = getattr(self, "calls", 0) + 1
        return super().velocity(position, time) / self.calls


class ByTheLowest(Sound):
    """Measures heights from the lowest place that is asked for."""

    name = "by-the-lowest"

    def velocity(self, position: FloatArray, time: float) -> FloatArray:
        return super().velocity(position - position.min(axis=0), time)


class HalfAsFast(Sound):
    """Writes another momentum than its velocity says."""

    name = "half-as-fast"

    @hookimpl
    def constrain_momentum(self, grid: Grid, time: float) -> None:
        Boundary.constrain_momentum(self, grid, time)
        grid.momentum[self.node_mass > 0.5 * grid.mass, 0] *= 0.5


class Everybody(Sound):
    """Holds the nodes of all bodies that are low enough."""

    name = "everybody"

    @hookimpl
    def constrain_momentum(self, grid: Grid, time: float) -> None:
        Boundary.constrain_momentum(self, grid, time)
        low = grid.position[:, 1] < 0.0
        grid.momentum[low, 0] = grid.mass[low]


class Closed(Sealed, Sound):
    """Holds a function."""

    name = "closed"


#: The check that is meant for each.
FAULTS: dict[type[Any], str] = {
    OneForAll: "runs",
    EndsInInfinity: "runs",
    Counts: "no-memory",
    ByTheLowest: "each-for-itself",
    HalfAsFast: "as-prescribed",
    Everybody: "own-body",
    Closed: "sent",
}
