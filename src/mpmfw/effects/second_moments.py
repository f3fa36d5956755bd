"""Second moments of mass of a body: of its material's deformed domains, and of the nodal masses that stand
for it.

Sums are kept in scratch of each function's own: what a caller hands in may be indexed at run time elsewhere,
and then stays in memory, where each addition waits for the one before."""

from __future__ import annotations

from mpmfw.kernels import device, scratch
from mpmfw.kernels.types import Float, Floats, Nodes, Points


@device
def inertia_of(second_moment: Floats, out: Floats, spacing: tuple[float, ...]) -> None:
    """I = tr(S) 1 − S of S = Σ m x xᵀ in 3D; in 2D the single number tr(S) in ``out[0, 0]``.

    Read are the upper half of S, in 2D its diagonal.
    """
    dim = len(spacing)
    trace = 0.0
    for d in range(dim):
        trace += second_moment[d, d]
    for d in range(dim):
        for e in range(dim):
            out[d, e] = (trace if d == e else 0.0) - (
                second_moment[min(d, e), max(d, e)] if dim == 3 else 0.0
            )


@device
def moments_of_nodes(
    first_node: int, last_node: int, grid: Nodes, centre: Floats, second: Floats, spacing: tuple[float, ...]
) -> Float:
    """c = Σ m_i x_i / m to ``centre``, Σ m_i (x_i − c)(x_i − c)ᵀ to ``second``; return m = Σ m_i.

    Of the symmetric matrix the upper half is written, in 2D the diagonal: what :func:`inertia_of` reads.
    """
    dim = len(spacing)
    r = scratch.vector(spacing)
    c = scratch.vector(spacing)
    sums = scratch.matrix(spacing, spacing)
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
    r = scratch.vector(spacing)
    c = scratch.vector(spacing)
    own = scratch.matrix(spacing, spacing)
    sums = scratch.matrix(spacing, spacing)
    for d in range(dim):
        c[d] = centre[d]
        for e in range(dim):
            sums[d, e] = 0.0
    for p in range(begin, end):
        for d in range(dim):
            r[d] = points.position[p, d] - c[d]
        for d in range(dim):
            for e in range(d, dim if dim == 3 else d + 1):
                own[d, e] = 3.0 * r[d] * r[e]
        for a in range(dim):
            for d in range(dim):
                r[d] = 0.0
                for e in range(dim):
                    r[d] += points.deformation_gradient[p, d, e] * half_edges[p, e, a]
            for d in range(dim):
                for e in range(d, dim if dim == 3 else d + 1):
                    own[d, e] += r[d] * r[e]
        for d in range(dim):
            for e in range(d, dim if dim == 3 else d + 1):
                sums[d, e] += points.mass[p] * own[d, e]
    for d in range(dim):
        for e in range(dim):
            second[d, e] = sums[d, e] / 3.0
