"""The checks of a contact law, in the order in which they are run."""

from __future__ import annotations

from mpmfw_testing.contact import (
    bystanders,
    company,
    conservation,
    energy,
    friction,
    options,
    reports,
    separation,
    shapes,
    similarity,
    space,
    state,
    symmetry,
    writes,
)
from mpmfw_testing.sent import sent

#: Those first whose failure makes others fail as well.
CHECKS = (
    shapes.runs, conservation.equal_and_opposite, conservation.moment_balance, separation.pushes_apart,
    separation.unequal, separation.no_adhesion, friction.coulomb_cone, friction.slip_on_the_cone,
    friction.sticking, friction.frictionless, energy.energy, similarity.three_bodies,
    company.many_contacts, company.met_again, company.moving_frame, company.refinement,
    company.step_length, writes.changes_nothing_else, writes.no_growth, similarity.similarity,
    similarity.outputs, symmetry.relabelling, symmetry.shift, symmetry.rotation, separation.asleep_apart,
    bystanders.one_body, bystanders.bystander, energy.time_step, options.options, shapes.shapes,
    space.three_dimensions, sent, state.used_twice, state.restart, state.saved, reports.reports,
)  # fmt: skip
