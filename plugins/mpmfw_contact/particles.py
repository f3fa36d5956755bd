"""Contact of material points that pushes overlapping spheres apart within a step (de Vaucorbeil & Nguyen
2021).

Source: A. de Vaucorbeil, V. P. Nguyen (2021), Modelling contacts with a total Lagrangian material point
method, CMAME 373, 113503; known here by its author's public code (Karamelo, fix_contact_min_penetration.cpp).
A point is a sphere with half the edge of a cube of its volume as radius R. Two points of different bodies
whose spheres overlap push each other along the line of their centres by

    f_n = m_p m_q / ((m_p + m_q) Δt²) (R_p + R_q − |x_p − x_q|),

which takes two free points to the distance at which they touch. Friction is μ f_n against the tangential
velocity of the moment, also where it turns the slip round. The law has no stiffness, step limit or energy.

Assumed here. The tangential velocity is that of the points' place on the grid after the step's other forces.
"""

from __future__ import annotations

from mpmfw.api import ContactRows, FloatArray, Grid, ImpulseLaw
from mpmfw.kernels import Struct, kernel, scratch
from mpmfw.kernels.contact import Rows, slip_limit
from mpmfw.kernels.types import Floats
from mpmfw_contact.points import PointSpheres


class ParticleArrays(Struct):
    """The law's own arrays of n rows."""

    velocity: Floats  #: (n, dim) B v [m/s]


@kernel
def push_apart(
    rows: Rows, count: int, own: ParticleArrays, mass: Floats, dt: float, work: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """J_n = m_p m_q / (m_p + m_q) overlap / Δt, and J_t = μ J_n against the slip, whose product with J_t
    is added to ``work``. ``mass`` (n_p,) [kg/m] is that of the points."""
    dim, points = len(spacing), len(mass)
    slip = scratch.vector(spacing)
    for c in range(count):
        q, p = rows.identity[c] % points, (rows.identity[c] // points) % points
        normal_impulse = mass[p] * mass[q] / (mass[p] + mass[q]) * max(-rows.gap[c], 0.0) / dt
        along, square = 0.0, 0.0
        for d in range(dim):
            along += own.velocity[c, d] * rows.normal[c, d]
        for d in range(dim):
            slip[d] = own.velocity[c, d] - along * rows.normal[c, d]
            square += slip[d] * slip[d]
        speed = square**0.5
        tangential = slip_limit(rows, c, normal_impulse) if rows.gap[c] < 0.0 and speed > 0.0 else 0.0
        for d in range(dim):
            direction = slip[d] / speed if speed > 0.0 else 0.0
            rows.force[c, d] = normal_impulse * rows.normal[c, d] - tangential * direction
        work[rows.pair[c]] += tangential * speed


class PointCentres(PointSpheres):
    """Points as spheres, on whose centres the forces act."""

    at_centres = True


class ParticleContact(ImpulseLaw):
    """Points of different bodies push each other apart by their overlap in each step, with friction of the
    moment; springs between the same points are ``points+penalty``."""

    name = "particles"
    Detection = PointCentres
    uses_friction = True
    needs = frozenset({"gap"})

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:  # noqa: ARG002
        return {"velocity": 1}

    def impulses(self, rows: ContactRows, grid: Grid, work: FloatArray | None, *, projected: bool) -> None:
        """Push once in a step, beside its other forces."""
        if projected or work is None:
            rows.force[: rows.count] = 0.0
            return
        rows.momentary_velocity(grid, rows.own.velocity)
        push_apart(rows, rows.count, rows.own, self.state.particles.mass, self.dt, work, grid.spacing)
