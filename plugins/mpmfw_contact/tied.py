"""Bodies that are tied at the grid nodes that they share: no slip, no separation.

It is the material point method's own contact, that of ``none``, between single pairs: bodies are tied where
they are within a support of each other, from the first step or when they come near. Every body keeps a
velocity field, and the force of the tie is recorded.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import LinearOperator, cg

from mpmfw.api import ContactRows, FloatArray, Grid, ImpulseLaw, SimulationError
from mpmfw.contact.nodes import AtNodes
from mpmfw.kernels.contact import add_row_forces, relative_motion


class EveryNode(AtNodes):
    """A row for every node that two bodies share, with the averaged normal."""

    name = "every_node"


class Tied(ImpulseLaw):
    """J of B M⁻¹ Bᵀ J = −B v in all rows, by conjugate gradients: one iteration where no two rows share a
    body's node; three bodies at a node and free rigid bodies take more."""

    name = "tied"
    Detection = EveryNode
    waits_for_forces = True

    def impulses(self, rows: ContactRows, grid: Grid, work: FloatArray | None, *, projected: bool) -> None:  # noqa: ARG002
        n, velocity, spacing = rows.count, np.zeros_like(grid.momentum), grid.spacing
        motion, size = np.zeros((n, grid.dim)), n * grid.dim

        def respond(impulse: FloatArray) -> FloatArray:
            rows.force[:n] = impulse.reshape(n, -1)
            velocity.fill(0.0)
            add_row_forces(rows, n, grid.mass, velocity, spacing)
            relative_motion(rows, n, velocity, 1.0, motion, spacing)
            return motion.ravel().copy()

        diagonal = np.zeros(n)
        rows.couplings(np.ones(n), grid, diagonal)
        rows.momentary_velocity(grid, motion)
        scaled = LinearOperator((size, size), lambda u: u / np.repeat(diagonal, grid.dim), dtype=float)
        operator = LinearOperator((size, size), respond, dtype=float)
        impulse, left = cg(operator, -motion.ravel(), rtol=1e-13, M=scaled)
        if left:
            raise SimulationError(
                "the impulses of ties do not converge", advice="smaller cells or other pairs"
            )
        rows.force[:n] = impulse.reshape(n, -1)
