"""The plane between the points of two nodes, by penalised logistic regression."""

from __future__ import annotations

import math

from mpmfw.kernels import Struct, device, kernel, scratch
from mpmfw.kernels.facets import dot
from mpmfw.kernels.types import Flags, Float, Floats, Ints, Table

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
