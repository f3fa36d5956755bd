"""Turns and spins of rigid bodies, and what their tables say of them.

Matrices W have W r = ω × r."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw.units import TimeTable

if TYPE_CHECKING:
    from mpmfw.scene.bodies import RigidBody


def simplex(dim: int) -> FloatArray:
    """Corners u of a regular simplex (dim + 1, dim): Σ u = 0, and Σ u uᵀ is dim + 1 times the unit matrix."""
    if dim == 3:
        return np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])
    angle = np.pi * np.array([1.0 / 2.0, 7.0 / 6.0, 11.0 / 6.0])
    return np.asarray(np.sqrt(2.0) * np.stack([np.cos(angle), np.sin(angle)], axis=1))


def matrix_of(omega: Any, dim: int) -> FloatArray:
    """Return W of ω, (1,) in the plane and (3,) in space."""
    x, y, z = (0.0, 0.0, omega[0]) if dim == 2 else omega
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])[:dim, :dim]


def vector_of(matrix: FloatArray) -> FloatArray:
    """Return ω (n, 1) or (n, 3) of W (n, dim, dim); of L the angular momentum."""
    entries = ((1, 0),) if matrix.shape[1] == 2 else ((2, 1), (0, 2), (1, 0))
    return np.stack([matrix[:, d, e] for d, e in entries], axis=1)


def rotations(angles: FloatArray) -> FloatArray:
    """exp(A) = 1 + sin θ / θ A + (1 − cos θ) / θ² A² of A = Δt W, (n, dim, dim)."""
    theta = np.sqrt(0.5 * np.einsum("nde,nde->n", angles, angles))[:, None, None] / np.pi
    square = np.einsum("nda,nae->nde", angles, angles)
    turned = np.eye(angles.shape[1]) + np.sinc(theta) * angles
    return np.asarray(turned + 0.5 * np.sinc(0.5 * theta) ** 2 * square)


def in_axes(matrix: FloatArray, turn: FloatArray) -> FloatArray:
    """R A Rᵀ of every body (n, dim, dim); with Rᵀ as ``turn`` Rᵀ A R."""
    return np.asarray(np.einsum("nda,nab,neb->nde", turn, matrix, turn))


def mass_of(
    model: RigidBody, volume: float, second: FloatArray, thickness: float
) -> tuple[float, FloatArray]:
    """Return mass and second moment of a free body by its table, from those of its region."""
    rigid: Any = model.rigid
    if rigid.density is not None:
        density = rigid.density * thickness
        return density * volume, density * second
    if rigid.inertia is None:  # of a body of revolution, which does not turn
        return rigid.mass, second * rigid.mass / volume
    if len(second) == 2:
        return rigid.mass, second * rigid.inertia / np.trace(second)
    principal = np.array(rigid.inertia)
    return rigid.mass, np.diag(0.5 * principal.sum() - principal)


def tables_of(model: RigidBody, dim: int) -> tuple[TimeTable, TimeTable, TimeTable]:
    """Return v, ω and the surface's velocity over time, prescribed or those of the start; 0 without any."""
    motion = None if isinstance(model.rigid, bool) else model.rigid.motion
    given = [
        getattr(motion or model, key, None) for key in ("velocity", "angular_velocity", "surface_velocity")
    ]
    lengths = (dim, 1 if dim == 2 else 3, dim)
    v, omega, surface = (
        TimeTable.of((0.0,) * length if each is None else each)
        for each, length in zip(given, lengths, strict=True)
    )
    return v, omega, surface
