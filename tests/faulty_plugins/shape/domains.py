"""Faults of deforming domains."""

from __future__ import annotations

import dataclasses

import numpy as np

from mpmfw.api import Grid, Particles, Setup, Stencil, hookimpl
from mpmfw_shape.cpdi import Cpdi
from mpmfw_shape.cpdi2 import Cpdi2
from mpmfw_shape.gimp import WIDTH, Gimp


class FrozenDomains(Cpdi):
    """CPDI whose domains keep their shape at the start."""

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """With F = 1."""
        identity = np.tile(np.eye(particles.dim), (particles.count, 1, 1))
        return super().interpolate(dataclasses.replace(particles, deformation_gradient=identity), grid)


class TransposedDeformation(Cpdi):
    """CPDI with Fᵀ in the place of F: right for stretch, wrong for shear and rotation."""

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """With Fᵀ."""
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
        """As CPDI2; then the points move to the mean of their corners."""
        super().setup(setup)
        particles = setup.state.particles
        particles.position[:] = self.corners.mean(axis=1)


class LeakyFaces(Gimp):
    """GIMP with a wrong slope along x where a domain lies in two cells: every sum of a point is right."""

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """Adds (1, −2, 1) times a tenth of the part that lies in the second cell."""
        table = super().interpolate(particles, grid)
        h, half = grid.cell_size, self.half_length / grid.cell_size
        start = (particles.position[:, 0] - grid.lower[0]) / h - half
        beyond = np.maximum(start - np.floor(start) + 2.0 * half - 1.0, 0.0)
        for p in np.flatnonzero(beyond):
            own = slice(table.row[p], table.row[p + 1])
            along_y = table.weight[own].reshape(WIDTH, -1).sum(axis=0)
            table.gradient[own, 0] += (0.1 * beyond[p] / h * np.outer([1.0, -2.0, 1.0], along_y)).ravel()
        return table
