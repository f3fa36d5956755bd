"""Faults of surface points."""

from __future__ import annotations

import numpy as np

from faulty_plugins.shape.sound import Sound
from mpmfw.api import FloatArray, Grid, IntArray, Stencil, hookimpl
from mpmfw_shape.linear import Linear


class LinearSurface(Sound):
    """B-splines whose surfaces are mapped with linear functions: forces add up, boundary stress is wrong."""

    @hookimpl
    def interpolate_surface(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        """Linear functions."""
        return Linear().interpolate_surface(position=position, first=first, grid=grid)


class SurfaceNotNormalised(Sound):
    """The weights of surface points add up to 0.99: a part of the contact force is lost."""

    @hookimpl
    def interpolate_surface(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        """A hundredth short."""
        table = super().interpolate_surface(position=position, first=first, grid=grid)
        return table.replace(weight=0.99 * table.weight)


class UndeclaredBoundary(Linear):
    """Linear functions that do not say that boundary nodes may be without mass."""

    massless_boundary = False


class SurfaceWithGradients(Sound):
    """A surface table with gradients, which nobody reads and every step pays for."""

    @hookimpl
    def interpolate_surface(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        """As for material points."""
        return self.table(np.ascontiguousarray(position), first, grid)
