"""Kernels of the complementarity problem of all rows: projected Gauss-Seidel, without a matrix.

J are impulses on rows, v = v* + M⁻¹ Bᵀ J the nodal velocities, u_c = B_c v those of the rows.
"""

from __future__ import annotations

from mpmfw.kernels import Struct, device, kernel, scratch
from mpmfw.kernels.contact import Rows, acts, add_force, row_velocity, slip_limit
from mpmfw.kernels.types import Float, Floats

#: Changes of a row, over the largest velocity of its nodes, that are rounding.
ROUNDING = 1e-13


class LcpArrays(Struct):
    """The law's own arrays of n rows."""

    #: (n,) w, the largest eigenvalue of B_c M⁻¹ B_cᵀ, or a little more [1/kg]; 0 of a row that takes no part
    compliance: Floats
    allowed: Floats  #: (n,) b: with u·n = −b the row ends the step where it may [m/s]
    velocity: Floats  #: (n, dim) u before any impulse [m/s]
    before: Floats  #: (n, dim) J before a sweep [N s/m]
    direction: Floats  #: (n, dim) in which impulses go on after a sweep [N s/m]


@kernel
def state_problem(
    rows: Rows, count: int, own: LcpArrays, mass: Floats, momentum: Floats, velocity: Floats, per_step: float,
    recovery: float, facing: float, spacing: tuple[float, ...],
) -> float:  # fmt: skip
    """Set velocities of nodes and rows, compliance and b, and let the impulses in ``rows.force`` act; return
    the largest component of the nodes' velocities before [m/s].

    A row that is open by g > 0 has b = g ``per_step``, which is 1 / Δt [1/s]; an overlap ``recovery`` times
    that. Open rows take part if the part ``facing`` of their area lies across the normal.
    """
    dim, fastest = len(spacing), 0.0
    u = scratch.vector(spacing)
    for k in range(rows.start[count]):
        i = rows.dof[k]
        for d in range(dim):
            velocity[i, d] = momentum[i, d] / mass[i] if mass[i] != 0.0 else 0.0
            fastest = max(fastest, abs(velocity[i, d]))
    for c in range(count):
        own.compliance[c] = 0.0
        for k in range(rows.start[c], rows.start[c + 1]):
            i, couple, tilt = rows.dof[k], 0.0, 0.0
            if mass[i] <= 0.0:
                continue
            for d in range(dim):
                couple += rows.couple[k, d] ** 2 if len(rows.couple) > 0 else 0.0
                tilt += rows.tilt[k, d] ** 2 if len(rows.tilt) > 0 else 0.0
            size = abs(rows.weight[k]) + couple**0.5
            own.compliance[c] += size * (size + tilt**0.5) / mass[i]
        gap = rows.gap[c]
        if gap > 0.0 and rows.area[c] < facing * rows.tributary_area[c]:
            own.compliance[c] = 0.0
        own.allowed[c] = (gap if gap > 0.0 else recovery * gap) * per_step
        row_velocity(c, rows, velocity, u, spacing)
        for d in range(dim):
            own.velocity[c, d] = u[d]
    for c in range(count):
        for d in range(dim):
            rows.force[c, d] = rows.force[c, d] if own.compliance[c] > 0.0 else 0.0
            u[d] = rows.force[c, d]
        add_force(c, u, rows, mass, velocity, spacing)
    return fastest


@device
def meet_row(
    c: int, rows: Rows, own: LcpArrays, mass: Floats, velocity: Floats, touching: Float, u: Floats,
    change: Floats, spacing: tuple[float, ...],
) -> Float:  # fmt: skip
    """Replace J_c by an impulse that meets the conditions as the others stand; return w |ΔJ_c| [m/s].

    J_n ← max(0, J_n − (u_n + b) / w), and J_t ← J_t − u_t / w shortened to μ J_n + a (Alart & Curnier
    1991); a acts where the row ends the step closed, u_n + b ≤ ``touching`` [m/s]. A fixed point has 0 ≤
    u_n + b ⊥ J_n ≥ 0 and |J_t| ≤ μ J_n + a with slip against J_t, whatever w > 0.
    """
    dim, w = len(spacing), own.compliance[c]
    if w <= 0.0:
        return 0.0
    row_velocity(c, rows, velocity, u, spacing)
    along, old = 0.0, 0.0
    for d in range(dim):
        along += u[d] * rows.normal[c, d]
        old += rows.force[c, d] * rows.normal[c, d]
    new = max(0.0, old - (along + own.allowed[c]) / w)
    square = 0.0
    for d in range(dim):
        tangential = rows.force[c, d] - old * rows.normal[c, d] - (u[d] - along * rows.normal[c, d]) / w
        change[d] = tangential
        square += tangential * tangential
    closed = new > 0.0 or along + own.allowed[c] <= touching
    size, limit = square**0.5, slip_limit(rows, c, new) if closed else 0.0
    kept = limit / size if size > limit else 1.0
    square = 0.0
    for d in range(dim):
        impulse = new * rows.normal[c, d] + kept * change[d]
        change[d] = impulse - rows.force[c, d]
        rows.force[c, d] = impulse
        square += change[d] * change[d]
    if square > 0.0:
        add_force(c, change, rows, mass, velocity, spacing)
    return w * square**0.5


@device
def go_on(
    count: int, share: Float, rows: Rows, own: LcpArrays, mass: Floats, velocity: Floats, change: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Add ``share`` of the direction p to the impulses that act; p ← share p + ΔJ of the sweep."""
    dim = len(spacing)
    for c in range(count):
        bears = acts(c, rows)
        for d in range(dim):
            change[d] = share * own.direction[c, d] if bears else 0.0
            own.direction[c, d] = change[d] + rows.force[c, d] - own.before[c, d] if bears else 0.0
            rows.force[c, d] += change[d]
        if bears and share > 0.0:
            add_force(c, change, rows, mass, velocity, spacing)


@kernel
def solve(
    rows: Rows, count: int, own: LcpArrays, mass: Floats, velocity: Floats, fastest: float, tolerance: float,
    sweeps: int, spacing: tuple[float, ...],
) -> tuple[int, float]:  # fmt: skip
    """Sweep to and fro until no row changes by more than ``tolerance`` of the largest velocity w |J| or w
    |ΔJ| of all, or than rounding of the ``fastest`` velocity [m/s].

    After each sweep the impulses go on as by conjugate gradients, with |ΔJ|² over the last sweep's as share,
    unless that is more than 1 (Silcowitz-Hansen, Niebe & Erleben 2010): sweeps alone need thousands. The
    second half are sweeps alone, which end within the cone. Rows without an impulse wait for the others.

    Return the number of sweeps, one more than ``sweeps`` if these were not enough, and the last change over
    the largest velocity, 0 if it is rounding.
    """
    u, change = scratch.vector(spacing), scratch.vector(spacing)
    largest, last, last_square, every = 0.0, 0.0, 0.0, True
    for c in range(count):
        square = 0.0
        for d in range(len(spacing)):
            own.direction[c, d] = 0.0
            square += rows.force[c, d] ** 2
        largest = max(largest, own.compliance[c] * square**0.5)
    for s in range(sweeps):
        last = 0.0
        for c in range(count):
            for d in range(len(spacing)):
                own.before[c, d] = rows.force[c, d]
        for e in range(2 * count):
            c = e if e < count else 2 * count - 1 - e
            if every or acts(c, rows):
                took = meet_row(c, rows, own, mass, velocity, tolerance * fastest, u, change, spacing)
                last = max(last, took)
        largest = max(largest, last)
        agreed = last <= max(tolerance * largest, ROUNDING * fastest)
        if agreed and every:
            return s + 1, last / largest if last > ROUNDING * fastest else 0.0
        every = agreed
        square = 0.0
        for c in range(count):
            for d in range(len(spacing)):
                square += own.compliance[c] * (rows.force[c, d] - own.before[c, d]) ** 2
        share = square / last_square if last_square > square else 0.0
        if 2 * s < sweeps:
            go_on(count, share, rows, own, mass, velocity, change, spacing)
        last_square = square
    return sweeps + 1, last / largest


@kernel
def add_friction_work(
    rows: Rows, count: int, own: LcpArrays, velocity: Floats, projected: bool, work: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Add −J_t·u_t to the ``work`` of every pair [J/m]: of the mean of before and after where the momentum is
    as ``projected``, else of the step's end. Negative work of rows that stick does not count."""
    dim = len(spacing)
    u = scratch.vector(spacing)
    for c in range(count):
        along, total = 0.0, 0.0
        for d in range(dim):
            along += rows.force[c, d] * rows.normal[c, d]
        if along == 0.0:
            continue
        row_velocity(c, rows, velocity, u, spacing)
        for d in range(dim):
            slip = 0.5 * (u[d] + own.velocity[c, d]) if projected else u[d]
            total -= (rows.force[c, d] - along * rows.normal[c, d]) * slip
        work[rows.pair[c]] += max(total, 0.0)
