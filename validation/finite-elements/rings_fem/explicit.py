"""Central differences in time with a lumped mass (Belytschko, Liu, Moran & Elkhodary 2014, section 6.2)."""

from typing import NamedTuple

from rings_fem.contact import Outline, add_contact_force
from rings_fem.element import Solid, add_internal_force
from rings_fem.mesh import Floats

#: Columns of the history.
FORCE, KINETIC, STRAIN, SPRINGS, MOMENTUM_LEFT, MOMENTUM_RIGHT = range(6)


class Pair(NamedTuple):
    """Two outlines that may meet, and the first node of the right body; those of the left come before it."""

    left: Outline
    right: Outline
    split: int


class Motion(NamedTuple):
    """State at one time, changed in place; all (n_nodes, 2)."""

    points: Floats  #: [m]
    velocity: Floats  #: [m/s]
    force: Floats  #: [N/m]


def advance(motion: Motion, solid: Solid, pair: Pair, step: float, history: Floats) -> None:
    """Take ``len(history)`` time steps of ``step`` [s], each of which

    1. accelerates the nodes for half of the step,
    2. moves them,
    3. finds the forces at the new positions,
    4. accelerates them for the other half,
    5. records (6,) contact force on the right body [N/m], kinetic, strain and spring energy [J/m], x-momentum
       of the left and of the right body [N s/m].

    Steps 4 and 1 join to the central difference; stopping between them gives the velocity of the step's own
    time."""
    for record in history:
        kick(motion, solid, 0.5 * step)
        motion.points[:] += step * motion.velocity
        update_forces(motion, solid, pair, record)
        kick(motion, solid, 0.5 * step)
        measure(motion, solid, pair, record)


def kick(motion: Motion, solid: Solid, interval: float) -> None:
    """Accelerate the nodes by their present forces for ``interval`` [s]."""
    motion.velocity[:] += interval * motion.force / solid.mass[:, None]


def update_forces(motion: Motion, solid: Solid, pair: Pair, record: Floats) -> None:
    """Find the forces at the present positions; contact force and potential energies go to ``record``."""
    motion.force[:] = 0.0
    record[SPRINGS] = add_contact_force(motion.points, pair.left, pair.right, motion.force)
    record[FORCE] = motion.force[pair.split :, 0].sum()
    record[STRAIN] = add_internal_force(motion.points, solid, motion.force)


def measure(motion: Motion, solid: Solid, pair: Pair, record: Floats) -> None:
    """Kinetic energy and both bodies' x-momentum go to ``record``."""
    momentum = solid.mass[:, None] * motion.velocity
    record[KINETIC] = 0.5 * (momentum * motion.velocity).sum()
    record[MOMENTUM_LEFT] = momentum[: pair.split, 0].sum()
    record[MOMENTUM_RIGHT] = momentum[pair.split :, 0].sum()
