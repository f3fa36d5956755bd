"""Local spin correction: every cell of the grid answers a couple with the inertia of the material in it.

The lumped nodes have more rotational inertia than the material, X in all of a body. Every cell gets a share
of X in proportion to the mass that its nodes hold in common, and adds to the nodes' momenta what its spin
lacks. It depends on its own nodes alone, so that no signal outruns the wave that carries it; all cells
together give a body that turns as a whole the inertia of its material (docs/guide/rotation.md)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.kernels import device, kernel, lanes, scratch
from mpmfw.kernels.arithmetic import add_scaled_row, determinant, invert, set_scaled_row
from mpmfw.kernels.lanes import LANES, WIDTH
from mpmfw.kernels.types import Float, Floats, Ints, Nodes, Points
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body, Grid, Particles

if TYPE_CHECKING:
    from mpmfw.effects.constraint import Constraint

#: Least share of a body's mass that cells count with: a film that barely reaches its outer nodes would have
#: all of X on nodes that weigh nothing.
LEAST_SHARE = 0.1

# Sums are kept in scratch of each function: an array that a caller hands in may stay in memory.


@device
def inertia_of(second_moment: Floats, out: Floats, spacing: tuple[float, ...]) -> None:
    """I = tr(S) 1 − S of the upper half of S = Σ m x xᵀ in 3D; in 2D tr(S) to ``out[0, 0]``."""
    dim = len(spacing)
    trace = 0.0
    for d in range(dim):
        trace += second_moment[d, d]
    for d in range(dim):
        for e in range(dim):
            off = second_moment[min(d, e), max(d, e)] if dim == 3 else 0.0
            out[d, e] = (trace if d == e else 0.0) - off


@device
def moments_of_nodes(
    first_node: int, last_node: int, grid: Nodes, centre: Floats, second: Floats, spacing: tuple[float, ...]
) -> Float:
    """c = Σ m_i x_i / m to ``centre``, of Σ m_i (x_i − c)(x_i − c)ᵀ the elements that :func:`inertia_of`
    reads to ``second``; return m = Σ m_i."""
    dim = len(spacing)
    r, c, sums = scratch.vector(spacing), scratch.vector(spacing), scratch.matrix(spacing, spacing)
    total = 0.0
    for d in range(dim):
        c[d] = 0.0
        for e in range(dim):
            sums[d, e] = 0.0
    for i in range(first_node, last_node):
        total += grid.mass[i]
        for d in range(dim):
            c[d] += grid.mass[i] * grid.position[i, d]
    for d in range(dim):
        c[d] /= total
    for i in range(first_node, last_node):
        for d in range(dim):
            r[d] = grid.position[i, d] - c[d]
        for d in range(dim):
            for e in range(d, dim if dim == 3 else d + 1):
                sums[d, e] += grid.mass[i] * r[d] * r[e]
    for d in range(dim):
        centre[d] = c[d]
        for e in range(dim):
            second[d, e] = sums[d, e]
    return total


@device
def moments_of_domains(
    begin: int, end: int, points: Points, half_edges: Floats, centre: Floats, second: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Σ_p m_p ((x_p − c)(x_p − c)ᵀ + Σ_a r_a r_aᵀ / 3) to ``second``, r_a the half-edge vectors of the
    deformed domain F R_0; the same elements as :func:`moments_of_nodes`."""
    dim = len(spacing)
    masses, each = scratch.vector(LANES), scratch.matrices(LANES, spacing, spacing)
    m, r = lanes.matrix((0.0,), (0.0,)), lanes.matrix((0.0,), spacing)
    f, edges = lanes.matrix(spacing, spacing), lanes.matrix(spacing, spacing)
    deformed, sums = lanes.matrix(spacing, spacing), lanes.matrix(spacing, spacing)
    each[:] = 0.0
    lanes.read(each, (0, 1, 2, 3), sums, spacing)
    for p in range(begin, end, WIDTH):
        for lane in range(WIDTH):
            masses[lane] = points.mass[p + lane] if p + lane < end else 0.0
        lanes.read(masses, (0, 1, 2, 3), m, spacing)
        own = lanes.points_from(p, end)
        lanes.read(points.position, own, r, spacing)
        lanes.read(points.deformation_gradient, own, f, spacing)
        lanes.read(half_edges, own, edges, spacing)
        lanes.multiply(f, edges, deformed, spacing)
        for d in range(dim):
            r[0, d] = r[0, d] - centre[d]
        for d in range(dim):
            for e in range(d, dim if dim == 3 else d + 1):
                moment = 3.0 * r[0, d] * r[0, e]
                for a in range(dim):
                    moment = lanes.multiply_add(deformed[d, a], deformed[e, a], moment)
                sums[d, e] = lanes.multiply_add(m[0, 0], moment, sums[d, e])
    lanes.write(each, (0, 1, 2, 3), sums, spacing)
    for d in range(dim):
        for e in range(dim):
            second[d, e] = (each[0, d, e] + each[1, d, e] + each[2, d, e] + each[3, d, e]) / 3.0


@device
def excess_inertia(true: Floats, lumped: Floats, out: Floats, spacing: tuple[float, ...]) -> bool:
    """X = I_grid I⁻¹ I_grid − I_grid of two second moments to ``out`` (3, 3), in 2D to its last element
    alone; whether it is positive definite."""
    dim = len(spacing)
    material, grid = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    inertia_of(true, material, spacing)
    inertia_of(lumped, grid, spacing)
    if dim == 2:
        out[2, 2] = grid[0, 0] * (grid[0, 0] / material[0, 0] - 1.0)
        return bool(out[2, 2] > 0.0)
    inverse = scratch.matrix(spacing, spacing)
    invert(material, inverse, spacing)
    for a in range(3):
        for b in range(3):
            out[a, b] = -grid[a, b]
            for c in range(3):
                for d in range(3):
                    out[a, b] += grid[a, c] * inverse[c, d] * grid[d, b]
    minor = out[0, 0] * out[1, 1] - out[0, 1] * out[1, 0]
    return bool(out[0, 0] > 0.0 and minor > 0.0 and determinant(out, spacing) > 0.0)


@device
def corner_node(first: int, c: int, stride: Ints, spacing: tuple[float, ...]) -> int:
    """Node at corner ``c`` of the cell whose lowest node is ``first``; bit d is the side along axis d."""
    for d in range(len(spacing)):
        first += stride[d] * (c >> d & 1)
    return first


@device
def common_masses(
    start: int, stop: int, shape: Ints, stride: Ints, common: Floats, spacing: tuple[float, ...]
) -> Float:
    """Replace 1/m_i in ``common`` by H_c of the cell whose lowest node is i, and return Σ H_c.

    H_c is the harmonic mean of the masses of the cell's nodes, 0 if one has none. The last nodes along an
    axis have 0, too. A cell's other nodes come later: their 1/m_i is still there."""
    dim = len(spacing)
    index = scratch.integers(spacing)
    for d in range(dim):
        index[d] = 0
    total = 0.0
    for i in range(start, stop):
        inside = common[i] < np.inf
        for d in range(dim):
            inside = inside and index[d] < shape[d] - 1
        inverse = np.inf
        if inside:
            inverse = 0.0
            for c in range(2**dim):
                inverse += common[corner_node(i, c, stride, spacing)]
        common[i] = 2**dim / inverse
        total += common[i]
        d = dim - 1
        index[d] += 1
        while d > 0 and index[d] == shape[d]:
            index[d] = 0
            d -= 1
            index[d] += 1
    return total


@device
def side(c: int, d: int) -> Float:
    """1 if corner ``c`` of a cell is on its upper side along axis ``d``, else −1."""
    return 2.0 * (c >> d & 1) - 1.0


@device
def turn_cell(
    i: int, share: float, excess: Floats, stride: Ints, change: Floats, node_momentum: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """(m v)_j += share (X w) × s_j on the nodes j of the cell whose lowest node is ``i``, w = Σ_j s_j × Δv_j,
    and s_j = (±1, …) the side of the cell that node j is on; in 2D about z alone, a = 2."""
    dim = len(spacing)
    n, first = 2**dim, 2 if dim == 2 else 0
    spin, couple = scratch.vector((0.0, 0.0, 0.0)), scratch.vector((0.0, 0.0, 0.0))
    v = scratch.matrix((0.0,), spacing)
    for a in range(first, 3):
        spin[a] = couple[a] = 0.0
    for c in range(n):
        set_scaled_row(v, 0, 1.0, change, corner_node(i, c, stride, spacing), spacing)
        for a in range(first, 3):
            d, e = (a + 1) % 3, (a + 2) % 3
            spin[a] += side(c, d) * v[0, e] - side(c, e) * v[0, d]
    for a in range(first, 3):
        for b in range(first, 3):
            couple[a] += share * excess[a, b] * spin[b]
    for c in range(n):
        for d in range(dim):
            v[0, d] = 0.0
        for a in range(first, 3):
            d, e = (a + 1) % 3, (a + 2) % 3
            v[0, d] -= couple[a] * side(c, e)
            v[0, e] += couple[a] * side(c, d)
        add_scaled_row(node_momentum, corner_node(i, c, stride, spacing), 1.0, v, 0, spacing)


@kernel
def find_excess(
    begin: int, end: int, points: Points, half_edges: Floats, first_node: int, last_node: int, grid: Nodes,
    excess: Floats, spacing: tuple[float, ...],
) -> float:  # fmt: skip
    """Set a body's X, (3, 3); return its mass [kg/m], 0 if X is not positive."""
    centre = scratch.vector(spacing)
    lumped, true = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    total = moments_of_nodes(first_node, last_node, grid, centre, lumped, spacing)
    moments_of_domains(begin, end, points, half_edges, centre, true, spacing)
    return total if excess_inertia(true, lumped, excess, spacing) else 0.0


@kernel
def correct_spin(
    first_node: int, last_node: int, shape: Ints, total: float, excess: Floats, grid: Nodes,
    held_momentum: Floats, change: Floats, common: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """(m v)_i += Σ_c (H_c / H) (X w_c) × q_i / (n A), over the cells c of node i.

    q_i is the place of a node about the middle of the cell, n = 2^dim, A = h²/2, and w_c = Σ_i q_i × Δv_i /
    (n A) the spin that the step has given to the cell. H_c is the harmonic mean of the masses of its nodes
    and H the sum of all H_c, at least :data:`LEAST_SHARE` of the body's mass ``total``. Δv_i is that of
    ``held_momentum``, in which boundary conditions are met."""
    dim = len(spacing)
    extent, stride, step = scratch.integers(spacing), scratch.integers(spacing), 1
    for back in range(dim):
        d = dim - 1 - back
        extent[d], stride[d] = shape[d], step
        step *= shape[d]
    for i in range(first_node, last_node):
        common[i] = 1.0 / grid.mass[i] if grid.mass[i] > 0.0 else np.inf
        if grid.mass[i] > 0.0:
            for d in range(dim):
                change[i, d] = common[i] * held_momentum[i, d] - grid.start_velocity[i, d]
    held = common_masses(first_node, last_node, extent, stride, common, spacing)
    # q_i = h/2 times the sides that ``turn_cell`` takes, which both factors of q_i / (n A) have.
    scale = 1.0 / (2**dim * spacing[0]) ** 2 / max(held, LEAST_SHARE * total)
    for i in range(first_node, last_node):
        if common[i] > 0.0:
            turn_cell(i, scale * common[i], excess, stride, change, grid.momentum, spacing)


class LocalSpin:
    """The correction for every body with ``rotation = "spin"``, which needs a separate velocity field.

    ``half_edges`` are those of the points' domains at the start. ``constraint`` are boundary conditions of
    these bodies: a prescribed side gains no spin."""

    name = "local_spin"
    ledger_term = ("inertia", "local spin")

    def __init__(
        self, bodies: tuple[Body, ...], half_edges: FloatArray, constraint: Constraint | None
    ) -> None:
        self.bodies, self.half_edges, self.constraint = bodies, half_edges, constraint
        self.excess = np.zeros((len(bodies), 3, 3))  #: X of every body, between its two kernels
        self.frame = -1

    @hookimpl
    def correct_inertia(self, grid: Grid, particles: Particles) -> None:
        if self.frame != grid.frame:  # the windows were laid anew
            self.frame = grid.frame
            self.change: FloatArray = np.zeros_like(grid.momentum)  #: of velocity over the step [m/s]
            self.common: FloatArray = np.zeros_like(grid.mass)  #: H_c of the cell with this lowest node
        held = grid.momentum
        if self.constraint is not None:
            held = self.constraint.held_momentum(grid)
        threads = particles.threads
        if threads is None or len(self.bodies) == 1:
            self._correct(slice(None), grid, particles, held)
        else:
            threads.each(lambda t: self._correct(slice(t, None, threads.count), grid, particles, held))

    def _correct(self, some: slice, grid: Grid, particles: Particles, held: FloatArray) -> None:
        for body, excess in zip(self.bodies[some], self.excess[some], strict=True):
            points, (first, last) = body.particles, grid.offset[body.field : body.field + 2].tolist()
            total = find_excess(
                points.start, points.stop, particles, self.half_edges, first, last, grid, excess,
                grid.spacing,
            )  # fmt: skip
            if total > 0.0:
                correct_spin(
                    first, last, grid.window_shape[body.field], total, excess, grid, held,
                    self.change, self.common, grid.spacing,
                )  # fmt: skip
