"""Change of volume and pressure averaged over each cell, against locking of bodies that keep their volume.

Every point of a nearly incompressible body constrains its volume. The motion of the nodes cannot meet so
many constraints, and the body is too stiff. Here there is one constraint for each cell,

    j̄_c = Σ_p V_p j_p / Σ_p V_p,    1 + Δt L̄ = (j̄ / j)^(1/dim) (1 + Δt L),

with the change of volume in the step, j = det(1 + Δt L), and the sums over a body's points in the cell c. L̄
replaces L, so that F, the stress, the energy and the ledger are of one deformation: F-bar (de Souza Neto et
al. 1996), by increments, so that nothing jumps where a point enters another cell. The pressure is averaged
alike: Σ V p̄ tr L = Σ V p tr L̄, so that the internal forces do the work that the points store. A mean raises
no frequency.

Where flow changes the volume, points that shear more dilate more than their cell. Their pressures would drift
apart, and with them the strength of soils. So tr L̄ gets (p̄ − p) / (M Δt) more, which is zero in a mean."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mpmfw.kernels import device, kernel, lanes, scratch
from mpmfw.kernels.arithmetic import determinant, set_to_motion
from mpmfw.kernels.stencil import read_window
from mpmfw.kernels.types import Float, Floats, Ints, Nodes, Points
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import Field, FloatArray
from mpmfw.state.structs import Body, Grid, Particles

#: Halley's steps from 1 + (x − 1)/n towards the root of x: exact to 1e-15 for x between 0.7 and 1.4.
ROOT_STEPS = 2

EXCESS = Field("excess", ("particle",), "1", "change of volume by which a point's pressure becomes the mean")


@device
def unsigned(first: int, last: int) -> range:
    """Return a range of indices that are never counted from the end, which halves the time of short loops."""
    return range(np.uint64(first), np.uint64(last))


@device
def sum_volumes(
    first: int, last: int, points: Points, volume: Floats, grid: Nodes, field: int, dt: float, cell: Ints,
    change: Floats, before: Floats, after: Floats, spacing: tuple[float, ...], tensor: tuple[float, ...],
) -> None:  # fmt: skip
    """Note the ``cell`` of each of a body's points, by its lowest node, and the ``change`` of its volume, j.

    ``before`` and ``after`` (N,) [m^dim] become the volumes of its points in each cell. A point that has left
    the window counts to the last cell. L has the dimensions of ``tensor``.
    """
    dim, inverse_h = len(spacing), 1.0 / spacing[0]
    origin, shape = scratch.vector(spacing), scratch.integers(spacing)
    read_window(grid, field, origin, shape, spacing)
    for i in unsigned(grid.offset[field], grid.offset[field + 1]):
        before[i] = after[i] = 0.0
    l, motion, j = lanes.matrix(tensor, tensor), lanes.matrix(tensor, tensor), lanes.matrix((0.0,), (0.0,))
    for p in range(first, last, lanes.WIDTH):
        own = lanes.points_from(p, last)
        lanes.read(points.velocity_gradient, own, l, tensor)
        set_to_motion(motion, dt, l, tensor)
        j[0, 0] = determinant(motion, tensor)
        lanes.write(change, own, j, tensor)
    for p in unsigned(first, last):
        c = 0
        for d in range(dim):  # of NaN the maximum is 0
            x = max(0.0, (points.position[p, d] - origin[d]) * inverse_h)
            c = c * shape[d] + int(min(x, shape[d] - 1.0))
        c += grid.offset[field]
        cell[p], change[p] = c, max(0.0, change[p])  # one that turns inside out: its L̄ is NaN
        before[np.uint64(c)] += volume[p]
        after[np.uint64(c)] += volume[p] * change[p]


@kernel
def average_volume(
    first: int, last: int, points: Points, volume: Floats, grid: Nodes, field: int, dt: float, cell: Ints,
    change: Floats, before: Floats, after: Floats, spacing: tuple[float, ...], tensor: tuple[float, ...],
) -> None:  # fmt: skip
    """Replace L by L̄ of a body's points; all else as in :func:`sum_volumes`, but ``after`` becomes j̄."""
    sum_volumes(
        first, last, points, volume, grid, field, dt, cell, change, before, after, spacing, tensor
    )  # fmt: skip
    n, inverse_dt = len(tensor), 1.0 / dt
    for i in unsigned(grid.offset[field], grid.offset[field + 1]):
        after[i] /= before[i]
    l, one = lanes.matrix(tensor, tensor), lanes.matrix((0.0,), (0.0,))
    for p in range(first, last, lanes.WIDTH):
        a, b, c, d = own = lanes.points_from(p, last)
        lanes.read(after, (cell[a], cell[b], cell[c], cell[d]), one, tensor)
        ratio = one[0, 0]
        lanes.read(change, own, one, tensor)
        ratio = ratio / one[0, 0]
        lanes.read(points.velocity_gradient, own, l, tensor)
        factor = (ratio + (n - 1.0)) * (1.0 / n)
        for _ in range(ROOT_STEPS):
            power = factor
            for _ in range(1, n):
                power = power * factor
            below = (n + 1.0) * power + (n - 1.0) * ratio
            factor = factor * ((n - 1.0) * power + (n + 1.0) * ratio) / below
        for k in range(n):
            for m in range(n):
                l[k, m] = l[k, m] * factor
            l[k, k] = l[k, k] + (factor - 1.0) * inverse_dt
        lanes.write(points.velocity_gradient, own, l, tensor)


@kernel
def average_pressure(
    first: int, last: int, points: Points, volume: Floats, first_node: int, last_node: int, cell: Ints,
    sums: Floats, total: Floats, spacing: tuple[float, ...], excess: Floats, softness: float,
) -> None:  # fmt: skip
    """σ += (p̄ − p) 1 of a body's points, p = tr σ / dim.

    ``sums`` and ``total`` (N,) become the volume of its points in each cell, and the mean of tr σ; ``excess``
    (n,), unless it is empty, p̄ − p times a ``softness`` [1/Pa].
    """
    dim, stress = len(spacing), points.stress
    for i in unsigned(first_node, last_node):
        sums[i] = total[i] = 0.0
    for p in unsigned(first, last):
        sums[np.uint64(cell[p])] += volume[p]
        total[np.uint64(cell[p])] += volume[p] * trace(stress, p, spacing)
    for i in unsigned(first_node, last_node):
        total[i] /= sums[i]
    for p in unsigned(first, last):
        more = (total[np.uint64(cell[p])] - trace(stress, p, spacing)) * (1.0 / dim)
        for d in range(dim):
            stress[p, d, d] += more
        if len(excess) > 0:
            excess[p] = softness * more


@device
def trace(stress: Floats, p: int, spacing: tuple[float, ...]) -> Float:
    """Return tr σ of a point."""
    total = stress[p, 0, 0]
    for d in range(1, len(spacing)):
        total += stress[p, d, d]
    return total


def _volumes(particles: Particles, grid: Grid) -> FloatArray:
    """Return the volumes (n,) in means; thicknesses of bodies of revolution alone differ between points."""
    return particles.times_thickness(particles.volume) if grid.axisymmetric else particles.volume


class AveragedVolume:
    """The means of every body; ``apart``: each has separate nodes."""

    name = "averaged_volume"

    def __init__(self, setup: Setup, *, apart: bool) -> None:
        self.bodies, self.apart = setup.averaged_bodies, apart
        self.frame, self.none = -1, np.empty(0)
        self.materials = {body.index: setup.material_of(body) for body in self.bodies}
        damping = {name: table.damping for name, table in setup.scene.materials.items()}
        self.delay = {
            body.index: max(each.times) if (each := damping[setup.scene.bodies[body.name].material]) else 0.0
            for body in self.bodies
        }  #: of the viscous stress [s]
        self.dilating = [body for body in self.bodies if self.materials[body.index].dilates]
        self.excess = setup.allocate(self.name, EXCESS) if self.dilating else self.none

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        """Return the means of bodies that may lock, or whose scene requests them."""
        names = ", ".join(body.name for body in setup.averaged_bodies)
        return Acts(names, [cls(setup, apart=setup.field_per_body)] if names else [])

    @hookimpl
    def after_velocity_gradient(self, particles: Particles, grid: Grid, dt: float) -> None:
        if self.frame != grid.frame:  # the windows were laid anew
            self.frame, self.grid = grid.frame, grid
            self.cell, self.change = np.zeros(particles.count, dtype=np.int64), np.zeros(particles.count)
            self.before, self.after = np.zeros((2, len(grid.mass)))
        volume, self.dt = _volumes(particles, grid), dt
        self._each(
            particles,
            lambda body: average_volume(
                body.particles.start, body.particles.stop, particles, volume, grid, body.field, dt, self.cell,
                self.change, self.before, self.after, grid.spacing, grid.tensor_spacing,
            ),
        )  # fmt: skip
        for body in self.dilating:
            own, dim = body.particles, len(grid.tensor_spacing)
            more = (self.excess[own] / (dt * dim))[:, None, None]
            particles.velocity_gradient[own] += more * np.eye(dim)

    @hookimpl
    def update_stress(self, particles: Particles) -> None:
        """Average the pressure, that of damping included."""
        grid = self.grid
        volume = _volumes(particles, grid)

        def average(body: Body) -> None:
            material = self.materials[body.index]
            modulus = material.stiffest() * (1.0 + self.delay[body.index] / self.dt)
            average_pressure(
                body.particles.start, body.particles.stop, particles, volume, grid.offset[body.field],
                grid.offset[body.field + 1], self.cell, self.after, self.before, grid.tensor_spacing,
                self.excess if material.dilates else self.none, 1.0 / modulus,
            )  # fmt: skip

        self._each(particles, average)

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
