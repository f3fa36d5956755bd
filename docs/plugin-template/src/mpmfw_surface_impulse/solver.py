"""Impulses that leave no penetration, within Coulomb's cone: projected Gauss-Seidel, accelerated."""

from __future__ import annotations

from mpmfw.kernels import device, kernel
from mpmfw.kernels.types import Float, Floats, Ints


@device
def relative_velocity(
    low: int, high: int, n_x: Float, n_y: Float, grid_node: Ints, share: Floats, couple: Floats,
    mass: Floats, momentum: Floats,
) -> tuple[Float, Float]:  # fmt: skip
    """u_n = n·Σ a_i v_i and u_t = t·Σ a_i v_i + n·Σ b_i v_i of one row [m/s]; t is n turned to the left."""
    a_x, a_y, b_n = 0.0, 0.0, 0.0
    for j in range(low, high):
        i = grid_node[j]
        v_x, v_y = momentum[i, 0] / mass[i], momentum[i, 1] / mass[i]
        a_x += share[j] * v_x
        a_y += share[j] * v_y
        b_n += couple[j] * (n_x * v_x + n_y * v_y)
    return n_x * a_x + n_y * a_y, n_x * a_y - n_y * a_x + b_n


@device
def add_impulse(
    low: int, high: int, n_x: Float, n_y: Float, normal: Float, tangential: Float,
    grid_node: Ints, share: Floats, couple: Floats, momentum: Floats,
) -> None:  # fmt: skip
    """(m v)_i += a_i (λ_n n + λ_t t) + b_i λ_t n of one row."""
    for j in range(low, high):
        i, a, b = grid_node[j], share[j], couple[j]
        along = a * normal + b * tangential
        momentum[i, 0] += along * n_x - a * tangential * n_y
        momentum[i, 1] += along * n_y + a * tangential * n_x


@device
def solve_row(
    r: int, low: int, high: int, grid_node: Ints, share: Floats, couple: Floats, normal: Floats,
    compliance_n: Floats, compliance_t: Floats, target: Floats, friction: Floats,
    mass: Floats, momentum: Floats, impulse: Floats,
) -> Float:  # fmt: skip
    """λ_n ← max(λ_n − (u_n + b) / W_n, 0), then λ_t ← clip(λ_t − u_t / W_t, ±μ λ_n); the larger change of u_n, u_t [m/s]."""
    n_x, n_y = normal[r, 0], normal[r, 1]
    u_n, _ = relative_velocity(low, high, n_x, n_y, grid_node, share, couple, mass, momentum)
    old_n, old_t = impulse[r, 0], impulse[r, 1]
    impulse[r, 0] = max(old_n - (u_n + target[r]) / compliance_n[r], 0.0)
    d_n, d_t = impulse[r, 0] - old_n, 0.0
    if d_n != 0.0:
        add_impulse(low, high, n_x, n_y, d_n, 0.0, grid_node, share, couple, momentum)
    if friction[r] > 0.0 and (impulse[r, 0] > 0.0 or old_t != 0.0):
        _, u_t = relative_velocity(low, high, n_x, n_y, grid_node, share, couple, mass, momentum)
        limit = friction[r] * impulse[r, 0]
        impulse[r, 1] = min(max(old_t - u_t / compliance_t[r], -limit), limit)
        d_t = impulse[r, 1] - old_t
        if d_t != 0.0:
            add_impulse(low, high, n_x, n_y, 0.0, d_t, grid_node, share, couple, momentum)
    return max(abs(d_n) * compliance_n[r], abs(d_t) * compliance_t[r])


@device
def to_and_fro(
    segment: Ints, start: Ints, grid_node: Ints, share: Floats, couple: Floats, normal: Floats,
    compliance_n: Floats, compliance_t: Floats, target: Floats, friction: Floats,
    mass: Floats, momentum: Floats, impulse: Floats,
) -> Float:  # fmt: skip
    """Two sweeps over all rows, the second backwards; the largest change of a relative velocity [m/s]."""
    rows, largest = len(segment), 0.0
    for visit in range(2 * rows):
        r = visit if visit < rows else 2 * rows - 1 - visit
        if segment[r] >= 0:
            moved = solve_row(
                r, start[r], start[r + 1], grid_node, share, couple, normal,
                compliance_n, compliance_t, target, friction, mass, momentum, impulse,
            )  # fmt: skip
            largest = max(largest, moved)
    return largest


@device
def extrapolate(
    beta: Float, start: Ints, grid_node: Ints, share: Floats, couple: Floats, normal: Floats,
    change: Floats, direction: Floats, momentum: Floats, impulse: Floats,
) -> None:  # fmt: skip
    """λ += β p and p ← β p + Δλ, Δλ being the ``change`` by the last sweeps and p the ``direction``."""
    for r in range(len(impulse)):
        n, t = beta * direction[r, 0], beta * direction[r, 1]
        if n != 0.0 or t != 0.0:
            add_impulse(
                start[r], start[r + 1], normal[r, 0], normal[r, 1], n, t, grid_node, share, couple, momentum
            )
            impulse[r, 0] += n
            impulse[r, 1] += t
        direction[r, 0], direction[r, 1] = n + change[r, 0], t + change[r, 1]


@kernel
def solve(
    segment: Ints,
    start: Ints,
    grid_node: Ints,
    share: Floats,
    couple: Floats,
    normal: Floats,
    compliance_n: Floats,
    compliance_t: Floats,
    target: Floats,
    friction: Floats,
    mass: Floats,
    momentum: Floats,
    trial: Floats,
    impulse: Floats,
    change: Floats,
    direction: Floats,
    tolerance: float,
    sweeps: int,
) -> tuple[int, float]:
    """Solve 0 ≤ λ_n ⟂ u_n + b ≥ 0 and |λ_t| ≤ μ λ_n, sticking where possible, for all rows at once.

    Sweeps go to and fro over the rows, each of which is solved in turn, until none changes a relative velocity by more than
    ``tolerance`` [m/s]. What two sweeps change is taken for the gradient of a nonlinear conjugate gradient method, which
    starts anew where it grows (Silcowitz, Niebe & Erleben 2010).

    ``momentum`` (n_nodes, 2) holds that without contact and gets the solution's impulses alone, so that a guess that is taken
    back leaves no rounding. ``impulse`` (n_rows, 2) holds a first guess, often that of the last step, and gets the solution.
    ``trial`` (n_nodes, 2), ``change`` and ``direction`` (n_rows, 2) are scratch. Returns the number of sweeps, and the largest
    change in the last two [m/s].
    """
    rows = len(segment)
    trial[:] = momentum
    direction[:] = 0.0
    for r in range(rows):
        if segment[r] < 0:
            impulse[r, 0], impulse[r, 1] = 0.0, 0.0
        add_impulse(
            start[r], start[r + 1], normal[r, 0], normal[r, 1], impulse[r, 0], impulse[r, 1],
            grid_node, share, couple, trial,
        )  # fmt: skip
    largest, taken, last = 0.0, 0, 0.0
    while taken < sweeps:
        change[:] = impulse
        largest = to_and_fro(
            segment, start, grid_node, share, couple, normal,
            compliance_n, compliance_t, target, friction, mass, trial, impulse,
        )  # fmt: skip
        taken += 2
        if largest <= tolerance or taken >= sweeps:
            break
        square = 0.0
        for r in range(rows):
            for d in range(2):
                change[r, d] = impulse[r, d] - change[r, d]
            square += compliance_n[r] * change[r, 0] ** 2 + compliance_t[r] * change[r, 1] ** 2
        beta = square / last if last > 0.0 and square < last else 0.0
        last = square
        extrapolate(beta, start, grid_node, share, couple, normal, change, direction, trial, impulse)
    for r in range(rows):
        if impulse[r, 0] > 0.0:
            add_impulse(
                start[r], start[r + 1], normal[r, 0], normal[r, 1], impulse[r, 0], impulse[r, 1],
                grid_node, share, couple, momentum,
            )  # fmt: skip
    return taken, largest
