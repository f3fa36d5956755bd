"""The checks of a contact law, in the order in which they are run."""

from __future__ import annotations

from mpmfw_testing.contact import conservation, friction, many_bodies, scope, separation, state, symmetry
from mpmfw_testing.contact.state import openings
from mpmfw_testing.generic import no_growth, options, repeatable, runs, saved, sent

#: Those first whose failure makes others fail as well.
CHECKS = (
    runs, conservation.equal_and_opposite, conservation.moment_balance, separation.pushes_apart,
    separation.unequal, separation.no_adhesion, friction.coulomb_cone, friction.slip_on_the_cone,
    friction.sticking, friction.frictionless, conservation.energy, conservation.three_bodies,
    friction.friction_of_pairs, many_bodies.many_contacts, many_bodies.met_again, symmetry.moving_frame,
    many_bodies.refinement, many_bodies.step_length, state.changes_nothing_else, no_growth,
    symmetry.similarity, symmetry.outputs, symmetry.relabelling, symmetry.shift, symmetry.rotation,
    separation.isolation, scope.time_step, options, scope.shapes, scope.three_dimensions, sent, repeatable,
    state.restart, saved, conservation.reports,
)  # fmt: skip

__all__ = ["CHECKS", "openings"]
