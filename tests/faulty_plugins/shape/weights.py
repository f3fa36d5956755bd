"""Faults of the weights."""

from __future__ import annotations

import numpy as np

from faulty_plugins.shape.sound import Sound
from mpmfw.api import FloatArray, Grid, IntArray, Stencil
from mpmfw_shape.linear import Linear


class NotNormalised(Sound):
    """The middle spline is cut short: the weights add up to less than 1."""

    def weights(self, t: FloatArray) -> FloatArray:
        """0.7499 in the place of 0.75."""
        return super().weights(t) - np.array([0.0, 1e-4, 0.0])


class NotNormalisedIn3D(Sound):
    """As if a loop over two axes had been left in the kernel for three: right in 2D, wrong in 3D."""

    def table(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        """In 3D the weights are scaled as those of the square."""
        table = super().table(position, first, grid)
        return table.replace(weight=table.weight * 1.01) if grid.dim == 3 else table


class HalfCellOff(Sound):
    """Nodes are taken for the middles of cells: all is shifted by half a cell."""

    def base(self, xi: FloatArray) -> FloatArray:
        """As of a grid whose nodes lie half a cell further on."""
        return super().base(xi - 0.5)

    def weights(self, t: FloatArray) -> FloatArray:
        """The right splines at the wrong place."""
        return super().weights(t - 0.5)

    def slopes(self, t: FloatArray) -> FloatArray:
        """Their derivatives."""
        return super().slopes(t - 0.5)


class Interpolating(Sound):
    """Lagrange's parabola through three nodes: sums and gradients are right, outer weights are negative."""

    def weights(self, t: FloatArray) -> FloatArray:
        """The three parabolas."""
        return np.stack([0.5 * (t - 1.0) * (t - 2.0), t * (2.0 - t), 0.5 * t * (t - 1.0)], axis=-1)

    def slopes(self, t: FloatArray) -> FloatArray:
        """Their derivatives."""
        return np.stack([t - 1.5, 2.0 - 2.0 * t, t - 0.5], axis=-1)


class WrongPiece(Sound):
    """The support is chosen by the cell, and not by the nearest node: sums still hold, the weights jump."""

    def base(self, xi: FloatArray) -> FloatArray:
        """floor(ξ) − 1 in the place of floor(ξ − 1/2)."""
        return np.floor(xi) - 1.0


class AlternatingCells(Sound):
    """Wider functions in every other cell of the background grid: sums hold, but a shift by a cell is
    felt.
    """

    def table(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        """Mixes in (1, −2, 1), which no sum notices, in odd cells; zero at their faces."""
        table = super().table(position, first, grid)
        xi = (position[:, 0] - grid.lower[0]) / grid.cell_size
        share = 0.02 * np.maximum(np.sin(np.pi * xi), 0.0)
        ripple = np.array([1.0, -2.0, 1.0])
        for _ in range(grid.dim - 1):
            ripple = np.multiply.outer(ripple, np.array([1.0, -2.0, 1.0]))
        return table.replace(weight=table.weight + np.outer(share, ripple.ravel()).ravel())


class UndeclaredSpread(Linear):
    """Linear functions that do not say that Σ φ q qᵀ vanishes on grid lines."""

    singular_spread = False
