"""Shape functions with a fault of weights, gradients, supports, domains, surfaces or tables."""

import dataclasses

import numpy as np

from faulty_plugins.shape.sound import Sound
from mpmfw.api import hookimpl
from mpmfw_shape.cpdi import Cpdi
from mpmfw_shape.cpdi2 import Cpdi2
from mpmfw_shape.gimp import WIDTH, Gimp
from mpmfw_shape.linear import Linear


class UndeclaredSpread(Linear):
    """Linear functions that do not say that Σ φ q qᵀ vanishes on grid lines."""

    singular_spread = False


class ReachAtTheStart(Cpdi):
    """CPDI whose reach is that of the domains at the start."""

    @hookimpl
    def particle_reach(self, particles):  # noqa: ARG002
        return np.abs(self.half_edges).sum(axis=2)


class TransposedDeformation(Cpdi):
    """CPDI with Fᵀ in the place of F: right for stretch, wrong for shear and rotation."""

    @hookimpl
    def interpolate(self, particles, grid):
        turned = np.ascontiguousarray(particles.deformation_gradient.transpose(0, 2, 1))
        return super().interpolate(dataclasses.replace(particles, deformation_gradient=turned), grid)


class CornersLeftBehind(Cpdi2):
    """CPDI2 whose corners forget to move."""

    @hookimpl
    def update_particle_domains(self, particles, grid, dt):
        """Nothing."""


class CornersMean(Cpdi2):
    """CPDI2 whose points are left at the mean of the corners, as in CPDI, which is not the centroid."""

    @hookimpl
    def setup(self, setup):
        super().setup(setup)
        particles = setup.state.particles
        particles.position[:] = self.corners.mean(axis=1)


class LeakyFaces(Gimp):
    """GIMP with a wrong slope along x where a domain lies in two cells: every sum of a point is right."""

    @hookimpl
    def interpolate(self, particles, grid):
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
    def interpolate_surface(self, position, first, grid):
        return Linear().interpolate_surface(position=position, first=first, grid=grid)


class UndeclaredBoundary(Linear):
    """Linear functions that do not say that boundary nodes may be without mass."""

    massless_boundary = False


class Descending(Sound):
    """Rows from their last node to the first, of which it says that they ascend: threads would lose what a
    point adds.
    """

    rows_ascend = True

    @hookimpl
    def interpolate(self, particles, grid):
        table = super().interpolate(particles, grid)
        order = np.concatenate(
            [np.arange(b - 1, a - 1, -1) for a, b in zip(table.row[:-1], table.row[1:], strict=True)]
        )
        return table.replace(
            nodes=table.nodes[order], weight=table.weight[order], gradient=table.gradient[order]
        )


class Flatland(Sound):
    """Says that it works in one dimension, in which there is no grid."""

    dimensions = (1, 2)
