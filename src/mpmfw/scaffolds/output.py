"""Series of its own in the results: replace them by yours."""

from __future__ import annotations

import numpy as np

from mpmfw.api import Field, FloatArray, OutputSeries, State


class Template(OutputSeries):
    """Largest speed of the material points of every body that the scene names."""

    name = "template"

    def series(self) -> list[Field]:
        """Name, dims, unit and meaning of each series; ``missing``: NaN says that there is no value."""
        meaning = "largest speed of the body's material points"
        return [Field("largest_speed", ("body",), "m s-1", meaning, missing=True)]

    def values(self, state: State, interval: float) -> dict[str, FloatArray]:  # noqa: ARG002
        """Values of each series by its name; ``interval`` [s] is the time since the last output."""
        largest = np.full(len(state.bodies), np.nan)
        for body in self.bodies:
            velocity = state.particles.velocity[body.particles]
            largest[body.index] = np.sqrt((velocity**2).sum(axis=1)).max()
        return {"largest_speed": largest}
