"""Rotational inertia correction: a free body turns with the inertia of its material, not of its lumped nodes.

Lumping the mass at the nodes gives the grid body an inertia I_grid = Σ m_i |x_i − c|² that exceeds the true
one, I, by m (h² + l_p²)/3 under CPDI: at R/h = 4 a rolling disc is 5 % too slow in its spin. Each body's
acceleration is given the missing part, a_i += (1/I − 1/I_grid) τ × (x_i − c), τ being the torque of the
step's whole momentum change about c. That is the inverse of a symmetric positive-definite rank-one change of
the lumped mass matrix; it holds linear momentum exactly since Σ m_i (x_i − c) = 0.

In 3D a body whose inertia differs from axis to axis changes its spin without a torque, I ω' = τ − ω × I ω,
and the lumped one with I_grid instead of I. The difference of both is added. Without it the body
would keep I_grid ω instead of I ω."""

from __future__ import annotations

from mpmfw.effects.local_spin import inertia_of, moments_of_domains, moments_of_nodes
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.arithmetic import invert
from mpmfw.kernels.types import Floats, Nodes, Points
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body, Grid, Particles


@device
def moment_of(arms: Floats, out: Floats) -> None:
    """Σ r × f, into ``out`` (3,), of ``arms`` = Σ r ⊗ f (3, 3)."""
    for i in range(3):
        k, m = (i + 1) % 3, (i + 2) % 3
        out[i] = arms[k, m] - arms[m, k]


@device
def answer_of(
    inertia: Floats, inverse: Floats, impulse: Floats, spin: Floats, dt: float, out: Floats,
    spacing: tuple[float, ...]
) -> None:  # fmt: skip
    """Δω = I⁻¹ (τ Δt − Δt ω × I ω) to ``out`` (3,), of the spin ω and the ``impulse`` τ Δt."""
    momentum, left = scratch.vector(spacing), scratch.vector(spacing)
    for i in range(3):
        momentum[i] = 0.0
        for j in range(3):
            momentum[i] += inertia[i, j] * spin[j]
    for i in range(3):
        k, m = (i + 1) % 3, (i + 2) % 3
        left[i] = impulse[i] - dt * (spin[k] * momentum[m] - spin[m] * momentum[k])
    for i in range(3):
        out[i] = 0.0
        for j in range(3):
            out[i] += inverse[i, j] * left[j]


@device
def spin_change(
    true: Floats, lumped: Floats, torque: Floats, momentum: Floats, dt: float, spin: Floats,
    spacing: tuple[float, ...]
) -> None:  # fmt: skip
    """Antisymmetric W = Δω×: the material's change of spin under the step's torque less that of the nodes.

    ``torque`` is Σ r ⊗ Δp and ``momentum`` Σ r ⊗ m v⁰, whose antisymmetric parts are τ Δt and L. In 2D Δω is
    (1/I − 1/I_grid) τ Δt. In 3D both bodies have a gyroscopic couple as well (:func:`answer_of`), at the spin
    after half a step."""
    a, b = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    inertia_of(true, a, spacing)
    inertia_of(lumped, b, spacing)
    if len(spacing) == 2:
        alpha = (torque[0, 1] - torque[1, 0]) * (1.0 / a[0, 0] - 1.0 / b[0, 0])
        spin[0, 0], spin[0, 1], spin[1, 0], spin[1, 1] = 0.0, -alpha, alpha, 0.0
    else:
        c, d = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
        invert(a, c, spacing)
        invert(b, d, spacing)
        impulse, whole = scratch.vector(spacing), scratch.vector(spacing)
        start, omega = scratch.vector(spacing), scratch.vector(spacing)
        answer, of_nodes = scratch.vector(spacing), scratch.vector(spacing)
        moment_of(torque, impulse)
        moment_of(momentum, whole)
        answer_of(b, d, whole, whole, 0.0, start, spacing)  # without a step: I_grid⁻¹ L
        for i in range(3):
            omega[i] = start[i]
        for _ in range(2):
            answer_of(a, c, impulse, omega, dt, answer, spacing)
            answer_of(b, d, impulse, omega, dt, of_nodes, spacing)
            for i in range(3):
                omega[i] = start[i] + 0.5 * answer[i]
        for i in range(3):
            k, m = (i + 1) % 3, (i + 2) % 3
            alpha = answer[i] - of_nodes[i]
            spin[i, i], spin[m, k], spin[k, m] = 0.0, alpha, -alpha


@kernel
def correct_rotation(
    begin: int, end: int, points: Points, half_edges: Floats, first_node: int, last_node: int, grid: Nodes,
    dt: float, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """(m v)_i += m_i W (x_i − c), W from the torque of this step's momentum change (times Δt) about the
    centre c, and in 3D from the spin.

    True second moment: Σ m ((x_p − c)(x_p − c)ᵀ + Σ_a r_a r_aᵀ / 3), r_a the half-edge vectors of the
    deformed domain.
    """
    dim = len(spacing)
    centre = scratch.vector(spacing)
    true, lumped = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    torque, momentum = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    spin = scratch.matrix(spacing, spacing)
    moments_of_nodes(first_node, last_node, grid, centre, lumped, spacing)
    moments_of_domains(begin, end, points, half_edges, centre, true, spacing)
    for d in range(dim):
        for e in range(dim):
            torque[d, e] = momentum[d, e] = 0.0
    for i in range(first_node, last_node):
        for d in range(dim):
            arm = grid.position[i, d] - centre[d]
            for e in range(dim):
                before = grid.mass[i] * grid.start_velocity[i, e]
                torque[d, e] += arm * (grid.momentum[i, e] - before)
                if dim == 3:
                    momentum[d, e] += arm * before
    spin_change(true, lumped, torque, momentum, dt, spin, spacing)
    for i in range(first_node, last_node):
        for d in range(dim):
            for e in range(dim):
                grid.momentum[i, d] += grid.mass[i] * spin[d, e] * (grid.position[i, e] - centre[e])


class ExactRotation:
    """The correction for every body that has it."""

    name = "rotation"
    ledger_term = ("inertia", "exact rotation")

    def __init__(self, bodies: tuple[Body, ...], half_edges: FloatArray) -> None:
        self.bodies, self.half_edges = bodies, half_edges  #: of the points' domains at the start

    @hookimpl
    def correct_inertia(self, grid: Grid, particles: Particles, dt: float) -> None:
        for body in self.bodies:
            own, nodes = body.particles, grid.field_nodes(body.field)
            correct_rotation(
                own.start, own.stop, particles, self.half_edges, nodes.start, nodes.stop, grid, dt,
                grid.spacing,
            )  # fmt: skip
