"""Detection at shared grid nodes with the plane that separates the bodies' points best, by penalised logistic
regression.

Source: J. A. Nairn, C. C. Hammerquist, G. D. Smith (2020), New material point method contact algorithms for
improved accuracy, large-deformation problems, and proper null-space filtering, CMAME 362, 112859 (not at
hand), as in the public codes of NairnMPM (Nodes/MachineLearning.cpp) and Uintah (SerialMPM.cc). Points with a
weight at the node have the class −1 or 1. Gauss and Newton fit a logistic function of position, with a
penalty of 1e-7 h² on the slope, until 1 − cos of the normal's turn is below 1e-5 (NairnMPM, 15 iterations) or
1e-7 (Uintah, 50). The separation is that of the points' outermost reaches along the normal.

Assumed here. A point reaches as far as the tangent of its ellipse across the normal; in NairnMPM as the
ellipse along it, in Uintah as its corners. Each pair of bodies has its own planes.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pydantic import Field

from mpmfw.api import ContactRows, Grid, OptionsModel, Particles, SceneError, Setup, Stencil
from mpmfw.contact.nodes import AtNodes
from mpmfw.contact.shared_nodes import GridNodes, NodePairs, SharedNodes, collect_sides, write_row
from mpmfw.kernels import Struct, device, kernel, scratch
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.facets import dot, read_point
from mpmfw.kernels.types import Flags, Float, Floats, Ints, Points, Table
from mpmfw_contact.impulse import Impulse

#: Most iterations of a regression; about four are used.
ITERATIONS = 50

#: Pivot of the normal equations, over its diagonal, below which they have no solution.
SINGULAR = 1e-13


class Clouds(Struct):
    """Material points of the nodes that two bodies share, as entries of the table of interpolation."""

    head: Ints  #: (n_nodes,) first entry of a node, −1 where it is not shared
    after: Ints  #: (m,) next entry of the same node, −1 behind the last
    point: Ints  #: (m,) point of an entry


@kernel
def list_points(table: Table, shared: Flags, clouds: Clouds) -> None:
    """List the points with a weight at each ``shared`` node, in their order."""
    clouds.head[:] = -1
    for p in range(len(table.row) - 2, -1, -1):
        for k in range(table.row[p], table.row[p + 1]):
            i = table.nodes[k]
            if shared[i] and table.weight[k] > 0.0:
                clouds.after[k], clouds.head[i], clouds.point[k] = clouds.head[i], k, p


@device
def solve_symmetric(a: Floats, b: Floats) -> bool:
    """Replace b by a⁻¹ b, a symmetric and positive, by Cholesky's factors; False where a is singular."""
    n = len(b)
    for i in range(n):
        diagonal = a[i, i]
        for j in range(i + 1):
            total = a[i, j]
            for k in range(j):
                total -= a[i, k] * a[j, k]
            if i > j:
                a[i, j] = total / a[j, j]
            elif total > SINGULAR * diagonal:
                a[i, i] = math.sqrt(total)
            else:
                return False
        for k in range(i):
            b[i] -= a[i, k] * b[k]
        b[i] /= a[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            b[i] -= a[k, i] * b[k]
        b[i] /= a[i, i]
    return True


@device
def set_equations(
    nodes: Ints, of_first: int, count: int, clouds: Clouds, position: Floats, origin: Floats, h: Float,
    beta: Floats, penalty: float, x: Floats, a: Floats, b: Floats,
) -> None:  # fmt: skip
    """Normal equations of the step of β for Σ (c_p − f(β·x_p))² + λ |slope|², x_p = ((X_p − X_i) / h, 1).

    c is −1 at the points of the first side's nodes and 1 at those of the others;
    f(s) = 2 / (1 + e^(−s)) − 1 = tanh(s / 2).
    """
    wide, dim = len(beta), len(beta) - 1
    for d in range(wide):
        of_slope = penalty if d < dim else 0.0
        b[d] = -of_slope * beta[d]
        for e in range(wide):
            a[d, e] = of_slope if d == e else 0.0
    x[dim] = 1.0
    for n in range(count):
        k, side = clouds.head[nodes[n]], -1.0 if n < of_first else 1.0
        while k >= 0:
            along = beta[dim]
            for d in range(dim):
                x[d] = (position[clouds.point[k], d] - origin[d]) / h
                along += beta[d] * x[d]
            f = math.tanh(0.5 * along)
            slope = 0.5 * (1.0 - f * f)
            for d in range(wide):
                b[d] += slope * (side - f) * x[d]
                for e in range(wide):
                    a[d, e] += slope * slope * x[d] * x[e]
            k = clouds.after[k]


@device
def fit_plane(
    nodes: Ints, of_first: int, count: int, clouds: Clouds, position: Floats, origin: Floats, penalty: float,
    tolerance: float, normal: Floats, spacing: tuple[float, ...], wide: tuple[float, ...],
) -> bool:  # fmt: skip
    """Unit normal of the plane between the points of ``count`` nodes, the first ``of_first`` of which are of
    the first side, out of that side, into ``normal``; False without one.

    Gauss & Newton from β = 0 until 1 − cos of the normal's turn is below the ``tolerance``. ``wide`` is one
    longer than ``spacing``.
    """
    x, beta, b = scratch.vector(wide), scratch.vector(wide), scratch.vector(wide)
    a, found = scratch.matrix(wide, wide), False
    for d in range(len(wide)):
        beta[d] = 0.0
    for _ in range(ITERATIONS):
        set_equations(nodes, of_first, count, clouds, position, origin, spacing[0], beta, penalty, x, a, b)
        if not solve_symmetric(a, b):
            break
        for d in range(len(wide)):
            beta[d] += b[d]
        square, turned = dot(beta, beta, spacing), 1.0
        if not 0.0 < square < math.inf:
            break
        for d in range(len(spacing)):
            component = beta[d] / math.sqrt(square)
            turned -= component * normal[d] if found else 0.0
            normal[d] = component
        if found and turned < tolerance:
            break
        found = True
    return found


@device
def outermost(
    i: int, clouds: Clouds, points: Points, half_edges: Floats, origin: Floats, direction: Floats, sign: Float
) -> Float:
    """Return the reach of node i's points along ``sign`` times the ``direction`` from ``origin`` [m], each
    with the ellipse within its domain, |(F R)ᵀ n|."""
    dim, farthest, k = len(direction), -math.inf, clouds.head[i]
    while k >= 0:
        p, along, square = clouds.point[k], 0.0, 0.0
        for d in range(dim):
            along += sign * direction[d] * (points.position[p, d] - origin[d])
        for edge in range(dim):
            part = 0.0
            for d in range(dim):
                for e in range(dim):
                    part += direction[d] * points.deformation_gradient[p, d, e] * half_edges[p, e, edge]
            square += part * part
        farthest = max(farthest, along + math.sqrt(square))
        k = clouds.after[k]
    return farthest


@kernel
def write_regressed_rows(
    listed: int, shared: SharedNodes, pairs: NodePairs, grid: GridNodes, node: Floats, clouds: Clouds,
    points: Points, half_edges: Floats, penalty: float, tolerance: float, cut_off: float, dt: float,
    rows: Rows, spacing: tuple[float, ...], wide: tuple[float, ...],
) -> int:  # fmt: skip
    """A row for each shared node between whose points there is a plane; their number.

    ``node`` is the nodes' position (n_nodes, dim), ``half_edges`` the points' at the start, columns r_a
    (n_p, dim, dim) [m]. The gap is the distance of the points' domains across the plane, less the cut-off.
    """
    c, n, origin = 0, scratch.vector(spacing), scratch.vector(spacing)
    for f in range(listed):
        i, j, p = shared.first[f], shared.second[f], shared.pair[f]
        read_point(i, node, origin, spacing)
        of_first, count = collect_sides(f, shared, grid, spacing)
        found = fit_plane(
            shared.side, of_first, count, clouds, points.position, origin, penalty, tolerance, n, spacing,
            wide,
        )  # fmt: skip
        if not found:
            continue
        gap = -cut_off
        gap -= outermost(i, clouds, points, half_edges, origin, n, 1.0)
        gap -= outermost(j, clouds, points, half_edges, origin, n, -1.0)
        for d in range(len(spacing)):
            n[d] = -n[d]
        write_row(c, i, j, p, gap, n, pairs, grid, dt, rows, spacing)
        c += 1
    rows.start[c] = 2 * c
    return c


@kernel
def take_reach(
    rows: Rows, begin: int, count: int, clouds: Clouds, points: Points, half_edges: Floats, node: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Take from the gaps of the rows from ``begin`` on, those of a ``node`` from a rigid surface, how far its
    points' domains reach beyond it."""
    n, origin = scratch.vector(spacing), scratch.vector(spacing)
    for c in range(begin, count):
        i = rows.dof[rows.start[c]]
        read_point(i, node, origin, spacing)
        read_point(c, rows.normal, n, spacing)
        rows.gap[c] -= outermost(i, clouds, points, half_edges, origin, n, -1.0)


class LogisticOptions(OptionsModel):
    slope_penalty: float = Field(
        1e-7, gt=0, description="penalty on the slope of the logistic function, with a cell as unit"
    )
    turn: float = Field(
        1e-5, gt=0, lt=1, description="1 - cos of the turn of a normal that ends the regression"
    )
    cut_off: float = Field(0.0, ge=0, description="separation in cells below which bodies touch")


class Logistic(AtNodes):
    """Normal and gap of shared nodes by logistic regression of the points' bodies against their position."""

    name = "logistic"
    Options = LogisticOptions
    options: LogisticOptions

    def configure(self, needs: frozenset[str], *, forces: bool) -> None:  # noqa: ARG002
        if forces:
            raise SceneError(
                "detection 'logistic' is for laws of impulses: its gap jumps as points come and go, and "
                "springs would make energy of that"
            )

    def prepare(self, setup: Setup, owner: str) -> None:
        self.half_edges, self.wide = setup.half_edges, (1.0,) * (setup.dim + 1)
        self.cut_off = self.options.cut_off * setup.cell_size
        self.clouds = Clouds(**{name: np.zeros(0, dtype=np.int64) for name in Clouds.member_names})
        super().prepare(setup, owner)

    def write(self, listed: int, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> int:
        clouds, nodes, entries = self.clouds, self.nodes_of(grid), phi.room
        if (len(clouds.head), len(clouds.after)) != (len(grid.mass), entries):
            sizes = {"head": len(grid.mass), "after": entries, "point": entries}
            clouds.set(**{name: np.zeros(size, dtype=np.int64) for name, size in sizes.items()})
        list_points(phi, nodes.shared, clouds)
        return write_regressed_rows(
            listed, self.shared, self.pairs, nodes, grid.position, clouds, particles, self.half_edges,
            self.options.slope_penalty, self.options.turn, self.cut_off, self.state.dt, rows, grid.spacing,
            self.wide,
        )  # fmt: skip

    def write_rigid(self, near: Any, grid: Grid, particles: Particles, rows: ContactRows) -> None:
        """Append rows of nodes near a rigid body; the gap is that of the points' domains."""
        begin = rows.count
        self.rigid.write(near, grid, rows, grid.position, self.cut_off, self.area_across)
        take_reach(
            rows, begin, rows.count, self.clouds, particles, self.half_edges, grid.position, grid.spacing
        )


class Nairn(Impulse):
    """Momentum exchange at grid nodes whose bodies approach, and overlap across a plane between points."""

    name = "nairn"
    Detection = Logistic
