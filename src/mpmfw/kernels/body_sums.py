"""Sums over the material points of every body: mass, momentum, spin, inertia and energies of its motion."""

from __future__ import annotations

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import kernel
from mpmfw.kernels.types import Floats, Ints


@kernel
def sum_motion(
    first: Ints,
    mass: Floats,
    position: Floats,
    velocity: Floats,
    total: Floats,
    centre: Floats,
    mean: Floats,
    spin: Floats,
    second: Floats,
    kinetic: Floats,
    spacing: tuple[float, ...],
) -> None:
    """Mass, centre, mean velocity, spin, second moment and kinetic energy of every body.

    ``total`` is m = Σ m_p, (B,) [kg/m]; ``centre`` c = Σ m_p x_p / m and ``mean`` v = Σ m_p v_p / m, (B, dim)
    [m, m/s]; ``spin`` Σ m_p r × w with r = x_p − c and w = v_p − v, (B, 1) in 2D and (B, 3) in 3D [kg m/s];
    ``second`` Σ m_p r rᵀ [kg m], (B, dim, dim); ``kinetic`` Σ m_p |v_p|² / 2, (B,) [J/m]. Points
    ``first[b]:first[b + 1]`` belong to body b."""
    dim = len(spacing)
    r = scratch.vector(spacing)
    w = scratch.vector(spacing)
    c = scratch.vector(spacing)
    v = scratch.vector(spacing)
    turned = scratch.vector((0.0, 0.0, 0.0))
    inertia = scratch.matrix(spacing, spacing)
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
            body_mass += mass[p]
            for d in range(dim):
                c[d] += mass[p] * position[p, d]
                v[d] += mass[p] * velocity[p, d]
                energy += 0.5 * mass[p] * velocity[p, d] * velocity[p, d]
        for d in range(dim):
            c[d] /= body_mass
            v[d] /= body_mass
        for p in range(first[b], first[b + 1]):
            for d in range(dim):
                r[d] = position[p, d] - c[d]
                w[d] = velocity[p, d] - v[d]
            if dim == 2:
                turned[0] += mass[p] * (r[0] * w[1] - r[1] * w[0])
            else:
                for a in range(axes):
                    d, e = (a + 1) % 3, (a + 2) % 3
                    turned[a] += mass[p] * (r[d] * w[e] - r[e] * w[d])
            for d in range(dim):
                for e in range(dim):
                    inertia[d, e] += mass[p] * r[d] * r[e]
        total[b], kinetic[b] = body_mass, energy
        for d in range(dim):
            centre[b, d], mean[b, d] = c[d], v[d]
            for e in range(dim):
                second[b, d, e] = inertia[d, e]
        for a in range(axes):
            spin[b, a] = turned[a]


@kernel
def sum_affine_energy(
    first: Ints, mass: Floats, volume: Floats, affine: Floats, energy: Floats, spacing: tuple[float, ...]
) -> None:
    """Σ m_p l² C:C / 24 of every body to ``energy``, (B,) [J/m]: squares of edge l = V^(1/dim) that move
    within themselves by C.

    Points ``first[b]:first[b + 1]`` belong to body b.
    """
    dim = len(spacing)
    for b in range(len(first) - 1):
        energy[b] = 0.0
        for p in range(first[b], first[b + 1]):
            square = 0.0
            for d in range(dim):
                for e in range(dim):
                    square += affine[p, d, e] * affine[p, d, e]
            edge2 = (
                volume[p] if dim == 2 else volume[p] ** (2.0 / dim)
            )  # a power takes longer than all the rest
            energy[b] += mass[p] * edge2 * square / 24.0
