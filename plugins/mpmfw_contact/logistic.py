"""Detection at shared grid nodes with the plane that separates the bodies' points best, by penalised logistic
regression.

Source: J. A. Nairn, C. C. Hammerquist, G. D. Smith (2020), New material point method contact algorithms for
improved accuracy, large-deformation problems, and proper null-space filtering, CMAME 362, 112859. The paper
was not at hand; what follows is that of the public codes of NairnMPM (Nodes/MachineLearning.cpp) and Uintah
(SerialMPM.cc). Points with a weight at the node, all alike, have the class −1 or 1. The squares of the
classes less a logistic function of position are made small by Gauss and Newton, with a penalty of 1e-7 h² on
the slope, until 1 − cos of the normal's turn is below 1e-5 (NairnMPM, 15 iterations) or 1e-7 (Uintah, 50).
The separation is that of the points' outermost reaches along the normal, and bodies touch where it is
negative. (Before, NairnMPM penalised the offset alone, by 5e-4.)

Assumed here. A point reaches as far as the tangent of its ellipse across the normal; in NairnMPM as the
ellipse along it, in Uintah as its corners. Each pair of bodies has planes of its own.
"""

from __future__ import annotations

import math

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from mpmfw.api import ContactRows, Grid, ImpulseContact, Particles, SceneError, Setup, Stencil
from mpmfw.contact.nodes import AtNodes
from mpmfw.contact.shared_nodes import GridNodes, NodePairs, SharedNodes, write_row
from mpmfw.kernels import Struct, device, kernel, scratch
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw_contact.impulse import Impulse

#: Most iterations of a regression; about four are used.
ITERATIONS = 50

#: Pivot of the normal equations, over its diagonal, below which they have no solution.
SINGULAR = 1e-13


class Clouds(Struct):
    """Material points of every node that two bodies share."""

    slot: Ints  #: (n_nodes,) place of the node in ``start``, −1 where it is not shared
    start: Ints  #: (n + 1,) points of slot s are ``point[start[s]:start[s + 1]]``
    point: Ints  #: (m,)


class Domains(Struct):
    """Material points as the regression sees them."""

    position: Floats  #: (n_p, dim) [m]
    deformation: Floats  #: (n_p, dim, dim) F
    half_edges: Floats  #: (n_p, dim, dim) at the start [m], columns r_a


@kernel
def list_points(
    listed: int, shared: SharedNodes, row: Ints, nodes: Indices, weight: Floats, clouds: Clouds
) -> int:
    """Points with a weight at a shared node, node by node; their number, stored or not."""
    slot, start = clouds.slot, clouds.start
    for i in range(len(slot)):
        slot[i] = -1
    n = 0
    for f in range(listed):
        for i in (shared.first[f], shared.second[f]):
            if slot[i] < 0:
                slot[i] = n
                n += 1
    for s in range(n + 1):
        start[s] = 0
    for k in range(row[len(row) - 1]):
        if weight[k] > 0.0 and slot[nodes[k]] >= 0:
            start[slot[nodes[k]] + 1] += 1
    for s in range(n):
        start[s + 1] += start[s]
    total = int(start[n])
    if total > len(clouds.point):
        return total
    for p in range(len(row) - 1):
        for k in range(row[p], row[p + 1]):
            s = slot[nodes[k]]
            if weight[k] > 0.0 and s >= 0:
                clouds.point[start[s]] = p
                start[s] += 1
    for s in range(n, 0, -1):
        start[s] = start[s - 1]
    start[0] = 0
    return total


@device
def solve_symmetric(a: Floats, b: Floats) -> bool:
    """Replace b by a⁻¹ b, a symmetric and positive, by Cholesky's factors in its lower half; False where it
    is singular."""
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
    i: int, j: int, clouds: Clouds, position: Floats, origin: Floats, h: Float, beta: Floats, penalty: float,
    x: Floats, a: Floats, b: Floats,
) -> None:  # fmt: skip
    """Normal equations of the step that Σ (c_p − f(β·x_p))² + λ |slope|² asks of β, x_p = ((X_p − X_i) / h,
    1).

    c is −1 at the points of node i, the first body's, and 1 at those of node j, the second's;
    f(s) = 2 / (1 + e^(−s)) − 1 = tanh(s / 2).
    """
    wide, dim = len(beta), len(beta) - 1
    for d in range(wide):
        of_slope = penalty if d < dim else 0.0
        b[d] = -of_slope * beta[d]
        for e in range(wide):
            a[d, e] = of_slope if d == e else 0.0
    x[dim] = 1.0
    for side in range(2):
        s = clouds.slot[i if side == 0 else j]
        for q in range(clouds.start[s], clouds.start[s + 1]):
            along = beta[dim]
            for d in range(dim):
                x[d] = (position[clouds.point[q], d] - origin[d]) / h
                along += beta[d] * x[d]
            f = math.tanh(0.5 * along)
            slope = 0.5 * (1.0 - f * f)
            for d in range(wide):
                b[d] += slope * (2.0 * side - 1.0 - f) * x[d]
                for e in range(wide):
                    a[d, e] += slope * slope * x[d] * x[e]


@device
def set_direction(beta: Floats, out: Floats) -> bool:
    """Unit vector of the slope, into ``out`` (dim,); False, and ``out`` as it was, where it has none."""
    square = 0.0
    for d in range(len(out)):
        square += beta[d] * beta[d]
    if not 0.0 < square < math.inf:
        return False
    for d in range(len(out)):
        out[d] = beta[d] / math.sqrt(square)
    return True


@device
def fit_plane(
    i: int, j: int, clouds: Clouds, position: Floats, origin: Floats, penalty: float, tolerance: float,
    normal: Floats,
    spacing: tuple[float, ...], wide: tuple[float, ...],
) -> bool:  # fmt: skip
    """Unit normal of the plane between the points of nodes i and j, out of the first body, into ``normal``;
    whether there is one.

    Gauss & Newton from β = 0, whose first step is twice the linear fit, until the normal turns by less than
    an angle of which 1 − cos is the ``tolerance``. ``wide`` has a number more than ``spacing``.
    """
    x, beta, b = scratch.vector(wide), scratch.vector(wide), scratch.vector(wide)
    a, new = scratch.matrix(wide, wide), scratch.vector(spacing)
    for d in range(len(beta)):
        beta[d] = 0.0
    found = False
    for _ in range(ITERATIONS):
        set_equations(i, j, clouds, position, origin, spacing[0], beta, penalty, x, a, b)
        if not solve_symmetric(a, b):
            break
        for d in range(len(beta)):
            beta[d] += b[d]
        if not set_direction(beta, new):
            break
        turned = 1.0
        for d in range(len(new)):
            turned -= new[d] * normal[d] if found else 0.0
            normal[d] = new[d]
        if found and turned < tolerance:
            break
        found = True
    return found


@device
def outermost(
    s: int, clouds: Clouds, domains: Domains, origin: Floats, direction: Floats, sign: Float
) -> Float:
    """How far slot s's points reach along ``sign`` times the ``direction`` from ``origin`` [m].

    A point reaches as the ellipse within its domain, |(F R)ᵀ n| from its centre.
    """
    dim, farthest = len(direction), -math.inf
    for q in range(clouds.start[s], clouds.start[s + 1]):
        p, along, square = clouds.point[q], 0.0, 0.0
        for d in range(dim):
            along += sign * direction[d] * (domains.position[p, d] - origin[d])
        for edge in range(dim):
            part = 0.0
            for d in range(dim):
                for e in range(dim):
                    part += direction[d] * domains.deformation[p, d, e] * domains.half_edges[p, e, edge]
            square += part * part
        farthest = max(farthest, along + math.sqrt(square))
    return farthest


@kernel
def write_regressed_rows(
    listed: int, shared: SharedNodes, pairs: NodePairs, grid: GridNodes, clouds: Clouds, domains: Domains,
    node: Floats,
    penalty: float, tolerance: float, cut_off: float, dt: float, rows: Rows,
    spacing: tuple[float, ...], wide: tuple[float, ...],
) -> int:  # fmt: skip
    """A row for each shared node between whose points there is a plane; their number.

    ``node`` is the nodes' position (n_nodes, dim) [m]. The gap is the distance of the points' domains across
    the plane, less the cut-off.
    """
    dim = len(spacing)
    n, origin = scratch.vector(spacing), scratch.vector(spacing)
    c = 0
    for f in range(listed):
        i, j, p = shared.first[f], shared.second[f], shared.pair[f]
        for d in range(dim):
            origin[d] = node[i, d]
        if not fit_plane(i, j, clouds, domains.position, origin, penalty, tolerance, n, spacing, wide):
            continue
        gap = -cut_off
        gap -= outermost(clouds.slot[i], clouds, domains, origin, n, 1.0)
        gap -= outermost(clouds.slot[j], clouds, domains, origin, n, -1.0)
        for d in range(dim):
            n[d] = -n[d]
        write_row(c, i, j, p, gap, n, pairs, grid, dt, rows, spacing)
        c += 1
    rows.start[c] = 2 * c
    return c


class LogisticOptions(BaseModel):
    """Settings of the regression, and where bodies touch."""

    model_config = ConfigDict(extra="forbid", frozen=True)

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
        """Refuse laws of forces.

        Raises
        ------
        SceneError
            The gap jumps as points come and go, and springs would make energy of that.
        """
        if forces:
            raise SceneError(
                "detection 'logistic' is for laws of impulses: its gap jumps as points come and go, and "
                "springs would make "
                "energy of that"
            )

    def prepare(self, setup: Setup, owner: str) -> None:
        """Domains of the material points, and the bodies of the pairs."""
        particles = setup.state.particles
        self.domains = Domains(
            position=particles.position,
            deformation=particles.deformation_gradient,
            half_edges=setup.half_edges,
        )
        self.cut_off, self.wide = self.options.cut_off * setup.cell_size, (1.0,) * (setup.dim + 1)
        self.clouds = Clouds(**{name: np.zeros(0, dtype=np.int64) for name in Clouds.member_names})
        super().prepare(setup, owner)

    def write(self, listed: int, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> int:
        """Rows of the shared nodes between whose points there is a plane."""
        self._list_points(listed, grid, phi)
        if self.domains.position is not particles.position:
            self.domains.set(position=particles.position, deformation=particles.deformation_gradient)
        return write_regressed_rows(
            listed, self.shared, self.pairs, self.nodes_of(grid), self.clouds, self.domains, grid.position,
            self.options.slope_penalty, self.options.turn, self.cut_off, self.state.dt, rows, grid.spacing,
            self.wide,
        )  # fmt: skip

    def _list_points(self, listed: int, grid: Grid, phi: Stencil) -> None:
        if len(self.clouds.slot) != len(grid.mass):
            self.clouds.set(slot=np.zeros(len(grid.mass), dtype=np.int64))
        if len(self.clouds.start) < 2 * listed + 1:
            self.clouds.set(start=np.zeros(4 * listed + 1, dtype=np.int64))
        total = list_points(listed, self.shared, phi.row, phi.nodes, phi.weight, self.clouds)
        if total > len(self.clouds.point):
            self.clouds.set(point=np.zeros(2 * total, dtype=np.int64))
            list_points(listed, self.shared, phi.row, phi.nodes, phi.weight, self.clouds)


class Nairn(ImpulseContact):
    """Momentum exchange at grid nodes whose two bodies approach and overlap across the plane between their
    points.

    Both the projected and the updated momentum are corrected, as published.
    """

    name = "nairn"
    Detection = Logistic
    Law = Impulse
