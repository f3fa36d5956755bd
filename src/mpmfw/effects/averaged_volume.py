"""Change of volume and pressure averaged over each cell, against locking of bodies that keep their volume.

Every point of a nearly incompressible body constrains its volume. The motion of the nodes cannot meet so
many constraints, and the body is too stiff. Here there is one constraint for each cell,

    j̄_c = Σ_p V_p j_p / Σ_p V_p,    1 + Δt L̄ = (j̄ / j)^(1/dim) (1 + Δt L),

with the change of volume in the step, j = det(1 + Δt L), and the sums over a body's points in the cell c. L̄
replaces L, so that F, the stress, the energy and the ledger are of one deformation: F-bar (de Souza Neto et
al. 1996), by increments, so that nothing jumps where a point enters another cell. The pressure is averaged
alike: Σ V p̄ tr L = Σ V p tr L̄, so that the internal forces do the work that the points store. A mean raises
no frequency."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.arithmetic import determinant
from mpmfw.kernels.stencil import read_window
from mpmfw.kernels.types import Float, Floats, Ints, Nodes, Points
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body, Grid, Particles


@device
def change_of_volume(p: int, points: Points, dt: float, tensor: tuple[float, ...]) -> Float:
    """Return det(1 + Δt L) of a point."""
    motion = scratch.matrix(tensor, tensor)
    for d in range(len(tensor)):
        for e in range(len(tensor)):
            motion[d, e] = dt * points.velocity_gradient[p, d, e] + (1.0 if d == e else 0.0)
    return determinant(motion, tensor)


@kernel
def average_volume(
    first: int, last: int, points: Points, volume: Floats, grid: Nodes, field: int, dt: float, cell: Ints,
    change: Floats, before: Floats, after: Floats, spacing: tuple[float, ...], tensor: tuple[float, ...],
) -> None:  # fmt: skip
    """Replace L by L̄ of a body's points; note the ``cell`` of each, by its lowest node, and the ``change`` j.

    ``before`` and ``after`` (N,) [m^dim] become the volumes of its points in each cell. A point that has left
    the window counts to the last cell. L has the dimensions of ``tensor``.
    """
    dim, inverse_h = len(spacing), 1.0 / spacing[0]
    origin, shape = scratch.vector(spacing), scratch.integers(spacing)
    read_window(grid, field, origin, shape, spacing)
    for i in range(grid.offset[field], grid.offset[field + 1]):
        before[i] = after[i] = 0.0
    for p in range(first, last):
        c = 0
        for d in range(dim):
            c = c * shape[d] + min(max(int((points.position[p, d] - origin[d]) * inverse_h), 0), shape[d] - 1)
        c += grid.offset[field]
        cell[p], change[p] = c, change_of_volume(p, points, dt, tensor)
        before[c] += volume[p]
        after[c] += volume[p] * change[p]
    for p in range(first, last):
        ratio = after[cell[p]] / (before[cell[p]] * change[p])
        factor = math.sqrt(ratio) if len(tensor) == 2 else ratio ** (1.0 / 3.0)
        for d in range(len(tensor)):
            for e in range(len(tensor)):
                points.velocity_gradient[p, d, e] *= factor
            points.velocity_gradient[p, d, d] += (factor - 1.0) / dt


@kernel
def average_pressure(
    first: int, last: int, points: Points, volume: Floats, first_node: int, last_node: int, cell: Ints,
    sums: Floats, total: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """σ += (p̄ − p) 1 of a body's points, p = tr σ / dim.

    ``sums`` and ``total`` (N,) become the volume of its points in each cell, and Σ V tr σ.
    """
    dim = len(spacing)
    for i in range(first_node, last_node):
        sums[i] = total[i] = 0.0
    for p in range(first, last):
        trace = 0.0
        for d in range(dim):
            trace += points.stress[p, d, d]
        sums[cell[p]] += volume[p]
        total[cell[p]] += volume[p] * trace
    for p in range(first, last):
        excess = total[cell[p]] / sums[cell[p]]
        for d in range(dim):
            excess -= points.stress[p, d, d]
        for d in range(dim):
            points.stress[p, d, d] += excess / dim


def _volumes(particles: Particles, grid: Grid) -> FloatArray:
    """Return the volumes (n,) in means; thicknesses of bodies of revolution alone differ between points."""
    return particles.times_thickness(particles.volume) if grid.axisymmetric else particles.volume


class AveragedVolume:
    """The means of every body in ``bodies``; ``apart``: each has separate nodes."""

    name = "averaged_volume"

    def __init__(self, bodies: list[Body], *, apart: bool) -> None:
        self.bodies, self.apart = bodies, apart
        self.frame = -1

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        """Return the means of bodies that may lock, or whose scene requests them."""
        averaged = setup.averaged_bodies
        return Acts(", ".join(body.name for body in averaged), [cls(averaged, apart=setup.field_per_body)])

    @hookimpl
    def after_velocity_gradient(self, particles: Particles, grid: Grid, dt: float) -> None:
        if self.frame != grid.frame:  # the windows were laid anew
            self.frame, self.grid = grid.frame, grid
            self.cell, self.change = np.zeros(particles.count, dtype=np.int64), np.zeros(particles.count)
            self.before, self.after = np.zeros((2, len(grid.mass)))
        volume = _volumes(particles, grid)
        self._each(
            particles,
            lambda body: average_volume(
                body.particles.start, body.particles.stop, particles, volume, grid, body.field, dt, self.cell,
                self.change, self.before, self.after, grid.spacing, grid.tensor_spacing,
            ),
        )  # fmt: skip

    @hookimpl
    def update_stress(self, particles: Particles) -> None:
        """Average the pressure, that of damping included."""
        grid = self.grid
        volume = _volumes(particles, grid)
        self._each(
            particles,
            lambda body: average_pressure(
                body.particles.start, body.particles.stop, particles, volume, grid.offset[body.field],
                grid.offset[body.field + 1], self.cell, self.after, self.before, grid.tensor_spacing,
            ),
        )  # fmt: skip

    def _each(self, particles: Particles, average: Callable[[Body], None]) -> None:
        """Average body by body; threads share bodies that have separate nodes."""
        threads = particles.threads
        count = 1 if threads is None or not self.apart else threads.count

        def some(t: int) -> None:
            for body in self.bodies[t::count]:
                average(body)

        if count == 1:
            some(0)
        else:
            threads.each(some)
