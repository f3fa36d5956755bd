"""The motion that bodies begin with."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import State, Stencil

if TYPE_CHECKING:
    from mpmfw.scene import Scene


def initial_velocity(scene: Scene, state: State, interpolate: Callable[[], Stencil]) -> None:
    """Set v = v_0 + ω × (x − c), and the affine field that goes with it, on every body.

    ``interpolate`` makes the table φ of the points where they are, if it is needed: a stored moment is B = W D with
    D = Σ φ q qᵀ.
    """
    p = state.particles
    spread = _spread(state, interpolate()) if p.moment is not None else None
    for body in state.bodies:
        model, own = scene.bodies[body.name], body.particles
        if model.velocity is not None:
            p.velocity[own] += np.array(model.velocity)
        if model.angular_velocity is not None:
            spin = _spin_matrix(np.atleast_1d(np.array(model.angular_velocity, dtype=float)), scene.dim)
            centre = p.mass[own] @ p.position[own] / p.mass[own].sum()
            p.velocity[own] += (p.position[own] - centre) @ spin.T
            if p.affine is not None:
                p.affine[own] = spin
            if p.moment is not None and spread is not None:
                p.moment[own] = spin @ spread[own]


def _spread(state: State, phi: Stencil) -> FloatArray:
    """D_p = Σ_i φ_ip q qᵀ with q = x_i − x_p, (n, dim, dim) [m²]."""
    p = state.particles
    point = np.repeat(np.arange(p.count), np.diff(phi.row))
    q = state.grid.position[phi.nodes] - p.position[point]
    spread = np.zeros((p.count, p.dim, p.dim))
    np.add.at(spread, point, phi.weight[:, None, None] * q[:, :, None] * q[:, None, :])
    return spread


def _spin_matrix(omega: FloatArray, dim: int) -> FloatArray:
    """W with W r = ω × r."""
    if dim == 2:
        return np.array([[0.0, -omega[0]], [omega[0], 0.0]])
    x, y, z = omega
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
