"""The law of the penalty contact: [H17] in the form that measurements led to."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw_contact.penalty.options import PenaltyOptions
from mpmfw_contact.penalty.pair_force import contact_forces
from mpmfw_contact.penalty.strategy import SurfaceSprings


class Penalty(SurfaceSprings):
    """Every node against the closest segment of each other body, both bodies slaves, friction with a history.

    At corners springs bear by the part of their length that lies across the normal. What departs from [H17] and why is
    said in ``docs/guide/methods.md``; its own form is :class:`mpmfw_contact.hamad2017.Hamad2017`.
    """

    name = "penalty"
    Options = PenaltyOptions
    options: PenaltyOptions
    shares = True

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.one_pass = self.options.passes == "one"
        self.damping = self.options.damping
        self.scratch = np.zeros((2, 4, 3, 2))

    def _forces(self, dt: float) -> None:
        """Closest segment by closest segment, f_t returned to Coulomb's cone."""
        c, s, r = self.candidates, self.surface, self.records
        self.force.fill(0.0)
        contact_forces(
            c.slots,
            c.master,
            c.segment,
            c.coordinate,
            c.gap,
            c.rest,
            c.normal,
            c.old_master,
            c.tangential,
            c.old_tangential,
            s.body,
            self.laws.pair_of,
            self.laws.first,
            s.position,
            s.displacement,
            s.next,
            s.previous,
            c.stiffness,
            c.damping,
            self.laws.friction,
            self.options.tangential_ratio,
            self.options.normal_variation == "hamad2017",
            self.linear_to,
            dt,
            self.scratch,
            self.force,
            r.impulse,
            r.frictional_work,
            r.damping_work,
            r.energy,
            r.count,
        )
