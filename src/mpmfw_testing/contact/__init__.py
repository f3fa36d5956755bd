"""The checks of a contact law, in the order in which they are run."""

from __future__ import annotations

from mpmfw_testing.check import Check
from mpmfw_testing.contact.bystanders import bystander, one_body
from mpmfw_testing.contact.company import many_contacts, met_again, moving_frame, refinement, step_length
from mpmfw_testing.contact.conservation import equal_and_opposite, moment_balance
from mpmfw_testing.contact.energy import energy_kept, own_time_step
from mpmfw_testing.contact.friction import coulomb_cone, frictionless, slip_on_the_cone, sticking
from mpmfw_testing.contact.options import options_act
from mpmfw_testing.contact.reports import reported_force
from mpmfw_testing.contact.separation import asleep_apart, no_adhesion, pushes_apart, unequal
from mpmfw_testing.contact.shapes import every_shape, runs
from mpmfw_testing.contact.similarity import outputs_change_nothing, similarity, three_bodies
from mpmfw_testing.contact.space import three_dimensions
from mpmfw_testing.contact.state import restart, saved, used_twice
from mpmfw_testing.contact.symmetry import relabelling, rotation, shift
from mpmfw_testing.contact.writes import changes_nothing_else, no_growth
from mpmfw_testing.sent import SENT

_CHECKS = (
    Check("runs", "A scene of two bodies that meet runs to its end.", runs),
    Check("equal-and-opposite", "What one body gets the other loses, in every step.", equal_and_opposite),
    Check("moment-balance", "The impulses on two bodies have one line of action.", moment_balance),
    Check(
        "pushes-apart", "Bodies that meet are pushed apart until they stop, and never pulled.", pushes_apart
    ),
    Check("unequal", "A light body is stopped by a heavy one, and the reverse.", unequal),
    Check("no-adhesion", "Bodies that touch and part do not feel each other.", no_adhesion),
    Check(
        "coulomb-cone", "Friction is at most the friction coefficient times the normal impulse.", coulomb_cone
    ),
    Check(
        "slip-on-the-cone", "Bodies that slip feel the full friction, against their slip.", slip_on_the_cone
    ),
    Check("sticking", "Where less friction is enough to stick, no more acts.", sticking),
    Check("frictionless", "Without friction, contact leaves the tangential velocity alone.", frictionless),
    Check("energy", "Contact gives the bodies no energy.", energy_kept),
    Check("three-bodies", "Three bodies get no energy, and each pair has its own friction.", three_bodies),
    Check("many-contacts", "Of many bodies that touch each gets its share.", many_contacts),
    Check("met-again", "Bodies that met and parted are stopped when they meet again.", met_again),
    Check("moving-frame", "A velocity that all bodies share does not matter.", moving_frame),
    Check("refinement", "How many points a surface has does not matter.", refinement),
    Check("step-length", "How long a step is does not matter.", step_length),
    Check("changes-nothing-else", "It changes forces and momentum of the grid alone.", changes_nothing_else),
    Check("no-growth", "What is kept for the next step does not grow.", no_growth),
    Check("similarity", "The scene in other units moves alike.", similarity),
    Check("outputs", "How often outputs are asked for does not matter, to the bit.", outputs_change_nothing),
    Check("relabelling", "The order in which the scene names the bodies does not matter.", relabelling),
    Check("shift", "Where the scene lies on the grid does not matter.", shift),
    Check("rotation", "Which way the scene is turned does not matter.", rotation),
    Check(
        "asleep-apart", "Bodies that are apart move as if there were no contact, to the bit.", asleep_apart
    ),
    Check("one-body", "A body alone moves as if no contact were named, to the bit.", one_body),
    Check("bystander", "A body far from those that meet is left alone, to the bit.", bystander),
    Check("time-step", "The law is stable at the time step that it states as its limit.", own_time_step),
    Check("options", "Every option changes something or is refused.", options_act),
    Check("shapes", "The law works with every bundled shape function, or refuses it.", every_shape),
    Check("three-dimensions", "In three dimensions too, impulses balance and bodies stop.", three_dimensions),
    SENT,
    Check("used-twice", "A strategy object carries nothing from one run to the next.", used_twice),
    Check("restart", "restart() forgets work and impulse and keeps the state of contact.", restart),
    Check("saved", "A run that is saved in the middle and loaded goes on to the same bits.", saved),
    Check("reports", "The reported contact force is the momentum exchanged.", reported_force),
)


def contact_checks() -> tuple[Check, ...]:
    """All checks of a contact law; the properties and bounds are told by ``Check.run``'s docstrings."""
    return _CHECKS
