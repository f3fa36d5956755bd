"""Sums over the material points of every body: mass, momentum, spin, inertia and energies of its motion."""

from __future__ import annotations

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import kernel
from mpmfw.kernels.types import Floats, Ints, Points


@kernel
def sum_motion(
    first: Ints, points: Points, total: Floats, centre: Floats, mean: Floats, spin: Floats, second: Floats,
    kinetic: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Mass, centre, mean velocity, spin, second moment and kinetic energy of every body.

    ``total`` is m = Σ m_p, (B,) [kg/m]; ``centre`` c = Σ m_p x_p / m and ``mean`` v = Σ m_p v_p / m, (B, dim)
    [m, m/s]; ``spin`` Σ m_p r × w with r = x_p − c and w = v_p − v, (B, 1) in 2D and (B, 3) in 3D [kg m/s];
    ``second`` Σ m_p r rᵀ [kg m], (B, dim, dim); ``kinetic`` Σ m_p |v_p|² / 2, (B,) [J/m]. Points
    ``first[b]:first[b + 1]`` belong to body b."""
    dim = len(spacing)
    r, w = scratch.vector(spacing), scratch.vector(spacing)
    c, v = scratch.vector(spacing), scratch.vector(spacing)
    turned, inertia = scratch.vector((0.0, 0.0, 0.0)), scratch.matrix(spacing, spacing)
    axes = 1 if dim == 2 else 3
    for b in range(len(first) - 1):
        body_mass = energy = 0.0
        for d in range(dim):
            c[d] = v[d] = 0.0
            for e in range(dim):
                inertia[d, e] = 0.0
        for a in range(axes):
            turned[a] = 0.0
        for p in range(first[b], first[b + 1]):
            body_mass += points.mass[p]
            for d in range(dim):
                velocity = points.velocity[p, d]
                c[d] += points.mass[p] * points.position[p, d]
                v[d] += points.mass[p] * velocity
                energy += 0.5 * points.mass[p] * velocity * velocity
        for d in range(dim):
            c[d] /= body_mass
            v[d] /= body_mass
        for p in range(first[b], first[b + 1]):
            for d in range(dim):
                r[d] = points.position[p, d] - c[d]
                w[d] = points.velocity[p, d] - v[d]
            if dim == 2:
                turned[0] += points.mass[p] * (r[0] * w[1] - r[1] * w[0])
            else:
                for a in range(axes):
                    d, e = (a + 1) % 3, (a + 2) % 3
                    turned[a] += points.mass[p] * (r[d] * w[e] - r[e] * w[d])
            for d in range(dim):
                for e in range(dim):
                    inertia[d, e] += points.mass[p] * r[d] * r[e]
        total[b], kinetic[b] = body_mass, energy
        for d in range(dim):
            centre[b, d], mean[b, d] = c[d], v[d]
            for e in range(dim):
                second[b, d, e] = inertia[d, e]
        for a in range(axes):
            spin[b, a] = turned[a]


@kernel
def sum_affine_energy(
    first: Ints, points: Points, affine: Floats, energy: Floats, spacing: tuple[float, ...]
) -> None:
    """Σ m_p l² C:C / 24 of every body to ``energy``, (B,) [J/m]: the motion by C in squares of edge
    l = V^(1/dim).
    """
    dim = len(spacing)
    for b in range(len(first) - 1):
        energy[b] = 0.0
        for p in range(first[b], first[b + 1]):
            square = 0.0
            for d in range(dim):
                for e in range(dim):
                    square += affine[p, d, e] * affine[p, d, e]
            volume = points.volume[p]
            edge2 = volume if dim == 2 else volume ** (2.0 / dim)  # a power takes longer than all the rest
            energy[b] += points.mass[p] * edge2 * square / 24.0
