"""A boundary condition and an output, since no bundled plug-in is one."""

import numpy as np

from mpmfw.api import AnyArray, Boundary, Field, OutputSeries


class Shaken(Boundary):
    """The lower three eighths of a square of 1 m about the origin move along x with 10 t, and are free
    along y: of nodes at y = −1/4 seven eighths, at 0 one.
    """

    name = "shaken"

    def holds(self, position):
        held: AnyArray = position[:, 1] < -0.1
        return held

    def velocity(self, position, time):
        found = np.full_like(position, np.nan)
        found[:, 0] = 10.0 * time
        return found


class Fastest(OutputSeries):
    """Record the largest speed of every body."""

    name = "fastest"

    def series(self):
        return [Field("speed", ("body",), "m s-1", "largest speed", missing=True)]

    def values(self, state, interval):  # noqa: ARG002
        speed = np.sqrt((state.particles.velocity**2).sum(axis=1))
        largest = np.full(len(state.bodies), np.nan)
        for body in self.bodies:
            largest[body.index] = speed[body.particles].max()
        return {"speed": largest}
