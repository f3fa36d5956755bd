"""Shape functions with a fault of weights, gradients, supports, domains, surfaces or tables."""

from __future__ import annotations

import dataclasses
from typing import Literal

import numpy as np
from pydantic import BaseModel

from faulty_plugins.sealed import Sealed
from faulty_plugins.shape.sound import Sound
from mpmfw.api import FloatArray, Grid, IntArray, Particles, Setup, Stencil, hookimpl
from mpmfw_shape.cpdi import Cpdi
from mpmfw_shape.cpdi2 import Cpdi2
from mpmfw_shape.gimp import WIDTH, Gimp
from mpmfw_shape.linear import Linear


class NotNormalisedIn3D(Sound):
    """As if a loop over two axes had been left in the kernel for three: right in 2D, wrong in 3D."""

    def table(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        table = super().table(position, first, grid)
        return table.replace(weight=table.weight * 1.01) if grid.dim == 3 else table


class HalfCellOff(Sound):
    """Nodes are taken for the middles of cells: all is shifted by half a cell."""

    def base(self, xi: FloatArray) -> FloatArray:
        return super().base(xi - 0.5)

    def weights(self, t: FloatArray) -> FloatArray:
        return super().weights(t - 0.5)

    def slopes(self, t: FloatArray) -> FloatArray:
        return super().slopes(t - 0.5)


class Interpolating(Sound):
    """Lagrange's parabola through three nodes: sums and gradients are right, outer weights are negative."""

    def weights(self, t: FloatArray) -> FloatArray:
        return np.stack([0.5 * (t - 1.0) * (t - 2.0), t * (2.0 - t), 0.5 * t * (t - 1.0)], axis=-1)

    def slopes(self, t: FloatArray) -> FloatArray:
        return np.stack([t - 1.5, 2.0 - 2.0 * t, t - 0.5], axis=-1)


class WrongPiece(Sound):
    """The support is chosen by the cell, and not by the nearest node: sums still hold, the weights jump."""

    def base(self, xi: FloatArray) -> FloatArray:
        return np.floor(xi) - 1.0


class UndeclaredSpread(Linear):
    """Linear functions that do not say that Σ φ q qᵀ vanishes on grid lines."""

    singular_spread = False


class WrongSign(Sound):
    """The derivative with respect to x_i is taken for that with respect to x_p."""

    def slopes(self, t: FloatArray) -> FloatArray:
        return -super().slopes(t)


class GradientOfLinear(Sound):
    """B-spline weights beside the gradients of linear functions: every sum is right."""

    def slopes(self, t: FloatArray) -> FloatArray:
        first = (t < 1.0).astype(float)
        return np.stack([-first, 2.0 * first - 1.0, 1.0 - first], axis=-1)


class NeverOutside(Sound):
    """Nothing is checked: at the window's end entries run over into the next row of nodes."""

    def inside(self, base: FloatArray, shape: IntArray) -> FloatArray:  # noqa: ARG002
        return np.ones(len(base), dtype=bool)


class WrongIndex(Sound):
    """``OutsideGrid`` names the first point, whichever left."""

    def reported(self, index: int) -> int:
        return 0 * index


class SurfaceNeverOutside(Sound):
    """Material points are checked, surface points are not."""

    @hookimpl
    def interpolate_surface(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        table = NeverOutside().table(position, first, grid)
        return table.replace(gradient=np.zeros((0, grid.dim)))


class OneField(Sound):
    """Every point writes into the first body's velocity field."""

    def offset(self, grid: Grid, field: IntArray) -> IntArray:
        return grid.offset[np.zeros_like(field)]


class ReachAtTheStart(Cpdi):
    """CPDI whose reach is that of the domains at the start."""

    @hookimpl
    def particle_reach(self, particles: Particles) -> FloatArray:  # noqa: ARG002
        return np.abs(self.half_edges).sum(axis=2)


class TransposedDeformation(Cpdi):
    """CPDI with Fᵀ in the place of F: right for stretch, wrong for shear and rotation."""

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        turned = np.ascontiguousarray(particles.deformation_gradient.transpose(0, 2, 1))
        return super().interpolate(dataclasses.replace(particles, deformation_gradient=turned), grid)


class CornersLeftBehind(Cpdi2):
    """CPDI2 whose corners forget to move."""

    @hookimpl
    def update_particle_domains(self, particles: Particles, grid: Grid, dt: float) -> None:
        """Nothing."""


class CornersMean(Cpdi2):
    """CPDI2 whose points are left at the mean of the corners, as in CPDI, which is not the centroid."""

    @hookimpl
    def setup(self, setup: Setup) -> None:
        super().setup(setup)
        particles = setup.state.particles
        particles.position[:] = self.corners.mean(axis=1)


class LeakyFaces(Gimp):
    """GIMP with a wrong slope along x where a domain lies in two cells: every sum of a point is right."""

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        table = super().interpolate(particles, grid)
        h, half = grid.cell_size, self.half_length / grid.cell_size
        start = (particles.position[:, 0] - grid.lower[0]) / h - half
        beyond = np.maximum(start - np.floor(start) + 2.0 * half - 1.0, 0.0)
        for p in np.flatnonzero(beyond):
            own = slice(table.row[p], table.row[p + 1])
            along_y = table.weight[own].reshape(WIDTH, -1).sum(axis=0)
            table.gradient[own, 0] += (0.1 * beyond[p] / h * np.outer([1.0, -2.0, 1.0], along_y)).ravel()
        return table


class LinearSurface(Sound):
    """B-splines whose surfaces are mapped with linear functions: forces add up, boundary stress is wrong."""

    @hookimpl
    def interpolate_surface(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        return Linear().interpolate_surface(position=position, first=first, grid=grid)


class SurfaceNotNormalised(Sound):
    """The weights of surface points add up to 0.99: a part of the contact force is lost."""

    @hookimpl
    def interpolate_surface(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        table = super().interpolate_surface(position=position, first=first, grid=grid)
        return table.replace(weight=0.99 * table.weight)


class UndeclaredBoundary(Linear):
    """Linear functions that do not say that boundary nodes may be without mass."""

    massless_boundary = False


class Descending(Sound):
    """Rows from their last node to the first, of which it says that they ascend: threads would lose what a
    point adds.
    """

    rows_ascend = True

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        table = super().interpolate(particles, grid)
        order = np.concatenate(
            [np.arange(b - 1, a - 1, -1) for a, b in zip(table.row[:-1], table.row[1:], strict=True)]
        )
        return table.replace(
            nodes=table.nodes[order], weight=table.weight[order], gradient=table.gradient[order]
        )


class Remembering(Sound):
    """Weights are mixed with those of the step before."""

    before = None

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        table = super().interpolate(particles, grid)
        mixed = table.weight if self.before is None else 0.5 * (table.weight + self.before)
        self.before = table.weight * (1.0 + 1e-15)
        return table.replace(weight=mixed)


#: Steps of whichever object was set up last.
_STEPS = [0]


class KeepsElsewhere(Sound):
    """Weights fade with the steps, which the module counts."""

    @hookimpl
    def setup(self) -> None:
        _STEPS[0] = 0

    @hookimpl
    def update_particle_domains(self) -> None:
        _STEPS[0] += 1

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        table = super().interpolate(particles, grid)
        return table.replace(weight=table.weight * (1.0 - 1e-9 * _STEPS[0]))


class Clamping(Sound):
    """Points that are near the window's end are put back, quietly."""

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        particles.position[:] = np.round(particles.position, 6)
        return super().interpolate(particles, grid)


class Hoarding(Sound):
    """Every table is kept."""

    def __init__(self, **options: object) -> None:
        super().__init__(**options)
        self.kept: list[Stencil] = []

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        self.kept.append(super().interpolate(particles, grid))
        return self.kept[-1]


class DeafOptions(BaseModel):
    """An option that nobody reads."""

    boundary: Literal["plain", "modified"] = "plain"


class Deaf(Sound):
    """An option is accepted and ignored."""

    Options = DeafOptions


class Flatland(Sound):
    """Says that it works in one dimension, in which there is no grid."""

    dimensions = (1, 2)


class Closed(Sealed, Sound):
    """Holds a function."""

    name = "closed"
