"""Faults of the gradients."""

from __future__ import annotations

import numpy as np

from faulty_plugins.shape.sound import Sound
from mpmfw.api import FloatArray, Grid, IntArray, Stencil


class WrongSign(Sound):
    """The derivative with respect to x_i is taken for that with respect to x_p."""

    def slopes(self, t: FloatArray) -> FloatArray:
        """Reversed."""
        return -super().slopes(t)


class PerCell(Sound):
    """The gradient is per cell and not per metre: a factor 1/h is missing."""

    def table(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        """Gradients times h."""
        table = super().table(position, first, grid)
        return table.replace(gradient=table.gradient * grid.cell_size)


class GradientOfLinear(Sound):
    """B-spline weights beside the gradients of linear functions: every sum is right."""

    def slopes(self, t: FloatArray) -> FloatArray:
        """∓1 at the two nodes round the point."""
        first = (t < 1.0).astype(float)
        return np.stack([-first, 2.0 * first - 1.0, 1.0 - first], axis=-1)
