"""What springs lose otherwise than by doing work: as they change, are let go, or return to a cone that shrinks."""

from __future__ import annotations

from mpmfw.kernels import device, kernel
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw_contact.penalty.pair_force import length_along, relative_motion, tangential_rows
from mpmfw_contact.penalty.pair_table import pair_index
from mpmfw_contact.penalty.spring import spring_energy
from mpmfw_contact.penalty.stability import motion


@device
def slip_of(
    s: int, m: int, xi: Float, gap: Float, e_x: Float, e_y: Float,
    position: Floats, displacement: Floats, following: Ints, previous: Ints, rows: Floats,
) -> Float:  # fmt: skip
    """C_tᵀ Δu of node s and the point ξ of segment m, on which a tangential force acted over the last step [m]."""
    if length_along(m, e_x, e_y, position, following) <= 0.0:  # the force acted on the vertex's other segment
        m, xi = (previous[m], 1.0) if xi == 0.0 else (following[m], 0.0)
    tangential_rows(e_x, e_y, xi, gap, length_along(m, e_x, e_y, position, following), rows)
    slip: Float = relative_motion(rows, s, m, following[m], displacement)
    return slip


@kernel
def add_losses(
    body: Ints,
    pair_of: Ints,
    position: Floats,
    displacement: Floats,
    following: Ints,
    previous: Ints,
    master: Ints,
    gap: Floats,
    rest: Floats,
    stiffness: Floats,
    tangential: Floats,
    old_master: Ints,
    old_segment: Ints,
    old_coordinate: Floats,
    old_gap: Floats,
    old_normal: Floats,
    old_rest: Floats,
    old_stiffness: Floats,
    old_tangential: Floats,
    tangential_ratio: float,
    linear_to: float,
    rows: Floats,
    work: Floats,
) -> None:
    """Add to every pair's ``work`` [J/m] the energy of the last step's springs, where they are now, less that of today's.

    Where the bodies moved by Δu, a spring's gap became g + Nᵀ Δu; what it is now beyond that is a change of the spring: of its
    share, its rest, its segment, or its end. A tangential spring did the work f_t C_tᵀ Δu meanwhile; ``work`` has to be
    lessened by what friction took of the rest. A new normal spring changes nothing, since its gap was zero.
    """
    for s in range(len(body)):
        for j in range(master.shape[1]):
            if len(tangential) > 0 and master[s, j] >= 0:
                k_t = tangential_ratio * stiffness[s, j]
                if k_t > 0.0:
                    work[pair_index(pair_of, body[s], master[s, j])] -= (
                        0.5 * tangential[s, j] * tangential[s, j] / k_t
                    )
        for i in range(master.shape[1]):
            other = old_master[s, i]
            if other < 0:
                continue
            m, xi, k = old_segment[s, i], old_coordinate[s, i], old_stiffness[s, i]
            e_x, e_y = old_normal[s, i, 0], old_normal[s, i, 1]
            moved = old_gap[s, i] + motion(s, m, xi, e_x, e_y, displacement, following)
            lost = spring_energy(k, max(old_rest[s, i] - moved, 0.0), linear_to)
            for j in range(master.shape[1]):
                if master[s, j] == other:
                    lost -= spring_energy(stiffness[s, j], max(rest[s, j] - gap[s, j], 0.0), linear_to)
            if len(tangential) > 0 and k > 0.0 and old_tangential[s, i] != 0.0:
                f_t = old_tangential[s, i]
                slip = slip_of(
                    s, m, xi, old_gap[s, i], e_x, e_y, position, displacement, following, previous, rows
                )
                lost += 0.5 * f_t * f_t / (tangential_ratio * k) - f_t * slip
            work[pair_index(pair_of, body[s], other)] += lost
