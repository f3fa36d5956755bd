"""Degenerate domains of CPDI and CPDI2, as plastic flow makes them, are replaced by rectangles of bounded
edges.

The mean gradient over a parallelogram R ξ is R^−T times differences of N_i along its edges. Where these are
long and nearly parallel, the kinks of N_i along them are divided by the width: the gradient exceeds 1/h
without a bound. A domain that is very thin has, where it is alone, a node with nearly no mass but a force, as
a point of linear shape functions has. In both cases steps that are stable for the bulk diverge, and points
invert.

The rectangle has the directions of the principal axes of the ellipse R Rᵀ, and the centre and the volume that
the point has: sums of φ, ∇φ and x φ are exact for any domain. Homel, Brannon & Guilkey (2016,
doi:10.1002/nme.5151) bound the diagonals' lengths alone.
"""

from __future__ import annotations

import math

from mpmfw.kernels import device
from mpmfw.kernels.arithmetic import determinant
from mpmfw.kernels.types import Float, Floats

#: An edge that is longer or shorter than at the start by more than this factor makes a domain degenerate.
STRETCH = 4.0

#: Least |det R| over the product of the edges' lengths of a domain that is not degenerate: edges at 30° in
#: 2D.
SQUARENESS = 0.5

#: Largest factor between half an edge of the rectangle and |det R_0|^(1/dim).
KEPT_STRETCH = 2.0

#: Sweeps of Jacobi rotations: the first is exact in 2D, the last changes nothing in 3D.
SWEEPS = 6


@device
def edge_square(r: Floats, e: int, spacing: tuple[float, ...]) -> Float:
    """Return |r_e|² of the half-edge vector r_e, a column of R [m^2]."""
    square = 0.0
    for d in range(len(spacing)):
        square += r[d, e] * r[d, e]
    return square


@device
def is_degenerate(r: Floats, start: Floats, spacing: tuple[float, ...]) -> bool:
    """Return whether the half-edges ``r`` (dim, dim), R, are sheared or stretched too far from ``start``, R_0
    [m]."""
    box = 1.0
    stretched = False
    for e in range(len(spacing)):
        square, before = edge_square(r, e, spacing), edge_square(start, e, spacing)
        box *= square
        stretched = stretched or square > STRETCH**2 * before or before > STRETCH**2 * square
    return stretched or determinant(r, spacing) ** 2 < SQUARENESS**2 * box


@device
def make_rectangle(r: Floats, start: Floats, spacing: tuple[float, ...]) -> None:
    """Write the edges of the rectangle that replaces a degenerate domain to ``r``; ``start`` is R_0 [m].

    One-sided Jacobi rotations (Hestenes 1958) make the columns orthogonal: R J with an orthogonal J.
    """
    dim = len(spacing)
    for _ in range(SWEEPS):
        for a in range(dim - 1):
            for b in range(a + 1, dim):
                product = 0.0
                for d in range(dim):
                    product += r[d, a] * r[d, b]
                if product != 0.0:
                    ratio = (edge_square(r, b, spacing) - edge_square(r, a, spacing)) / (2.0 * product)
                    tangent = math.copysign(1.0, ratio) / (abs(ratio) + math.sqrt(1.0 + ratio * ratio))
                    cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
                    for d in range(dim):
                        first, second = r[d, a], r[d, b]
                        r[d, a] = cosine * (first - tangent * second)
                        r[d, b] = cosine * (tangent * first + second)
    size = abs(determinant(start, spacing)) ** (1.0 / dim)
    for e in range(dim):
        length = math.sqrt(edge_square(r, e, spacing))
        kept = min(max(length, size / KEPT_STRETCH), size * KEPT_STRETCH)
        for d in range(dim):
            r[d, e] *= kept / length
