"""Faults of the support: windows, fields, reach."""

from __future__ import annotations

import numpy as np

from faulty_plugins.shape.sound import Sound
from mpmfw.api import FloatArray, Grid, IntArray, Particles, Stencil, hookimpl
from mpmfw_shape.cpdi import Cpdi


class NeverOutside(Sound):
    """Nothing is checked: at the window's end entries run over into the next row of nodes."""

    def inside(self, base: FloatArray, shape: IntArray) -> FloatArray:  # noqa: ARG002
        """Always."""
        return np.ones(len(base), dtype=bool)


class OffByOneAtTheEnd(Sound):
    """The window's last node is forgotten to be a node: the check is one node too generous."""

    def inside(self, base: FloatArray, shape: IntArray) -> FloatArray:
        """One node too many fits."""
        return super().inside(base, shape + 1)


class WrongIndex(Sound):
    """``OutsideGrid`` names the first point, whichever left."""

    def reported(self, index: int) -> int:
        """Zero."""
        return 0 * index


class SurfaceNeverOutside(Sound):
    """Material points are checked, surface points are not."""

    @hookimpl
    def interpolate_surface(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        """Without the check."""
        table = NeverOutside().table(position, first, grid)
        return table.replace(gradient=np.zeros((0, grid.dim)))


class OneField(Sound):
    """Every point writes into the first body's velocity field."""

    def offset(self, grid: Grid, field: IntArray) -> IntArray:
        """That of the first field."""
        return grid.offset[np.zeros_like(field)]


class ReachAtTheStart(Cpdi):
    """CPDI whose reach is that of the domains at the start."""

    @hookimpl
    def particle_reach(self, particles: Particles) -> FloatArray:  # noqa: ARG002
        """Without F."""
        return np.abs(self.half_edges).sum(axis=2)


class TabulatedInCompany(Sound):
    """Weights are looked up to a tenth of a cell as soon as there are several points."""

    def weights(self, t: FloatArray) -> FloatArray:
        """Rounded positions, unless a point is alone."""
        return super().weights(t if len(t) == 1 else np.round(t, 1))
