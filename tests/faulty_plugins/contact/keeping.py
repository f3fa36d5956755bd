"""Laws whose fault is more than a change of text: of options, time step, state, areas and records."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, field_validator

from faulty_plugins.contact.plain import PlainContact
from faulty_plugins.sealed import Sealed
from mpmfw.api import hookimpl
from mpmfw_contact.bardenhagen import Bardenhagen
from mpmfw_contact.penalty import Penalty


class MassRatio(PlainContact):
    """The impulse is multiplied by the ratio of the bodies' masses: right for bodies of equal mass."""

    def effective_mass(self, pair, m_a, m_b):
        bodies, mass = self.state.bodies, self.state.particles.mass
        whole = [mass[bodies[body].particles].sum() for body in (pair.first, pair.second)]
        return max(whole) / min(whole) * super().effective_mass(pair, m_a, m_b)


class NineEntries(PlainContact):
    """Takes rows of nine entries for rows of six, which CPDI has as well, but not all of them."""

    @hookimpl
    def after_momentum_projection(self, grid, phi, particles):
        if (np.diff(phi.row) == 9).all():
            six = particles.volume[:, None, None] * phi.gradient.reshape(particles.count, 6, grid.dim)
            self.outward_sum = six.sum(axis=(0, 1))
        PlainContact.after_momentum_projection(self, grid, phi, particles)


class OneTouch(PlainContact):
    """Bodies that have met and parted are not asked again."""

    def correct(self, grid):
        if not hasattr(self, "met"):
            self.met = np.zeros(len(self.pairs))
        for pair, a, _b, _n in self.shared:
            touches = len(a) > 0
            if touches and self.met[pair.index] == 0.0:
                self.met[pair.index] = 1.0
            elif not touches and self.met[pair.index] == 1.0:
                self.met[pair.index] = 2.0
        self.shared = [each for each in self.shared if self.met[each[0].index] < 2.0]
        super().correct(grid)


class Softness(BaseModel):
    """An option that a reader of the manual would set."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    softness: float = Field(1.0, gt=0, description="said to soften the contact")


class IgnoredOption(PlainContact):
    """Accepts an option and drops it."""

    Options = Softness


class Grade(BaseModel):
    """An option of which nobody can guess a value."""

    grade: str = "S235"

    @field_validator("grade")
    @classmethod
    def known(cls, value: str) -> str:
        """Only grades that are listed."""
        if value not in {"S235", "S355"}:
            raise ValueError("expected S235 or S355")
        return value


class IgnoredBehindRefusals(PlainContact):
    """Drops an option, and refuses every value that the kit makes up."""

    Options = Grade


class TooLongStep(Penalty):
    """Stiff springs, and a stable time step that is stated ten times too long."""

    name = "too-long-step"

    def __init__(self, **options: Any) -> None:
        super().__init__(**{"kappa": 10.0, **options})

    @hookimpl
    def stable_timestep(self):
        limit = Penalty.stable_timestep(self)
        return None if limit is None else (10.0 * limit[0], limit[1])


class WearsOut(PlainContact):
    """Friction falls with all that the object ever did: the next run inherits the last one's wear."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.steps = 0

    def friction(self, mu, normal, sticking):
        self.steps += 1
        return super().friction(mu / (1.0 + 1e-3 * self.steps), normal, sticking)


#: Contacts of whichever object was set up last.
_CONTACTS = [0]


class CountsElsewhere(PlainContact):
    """Friction falls with the contacts of the run, which the module counts: a run that is loaded begins
    anew.
    """

    @hookimpl
    def setup(self, setup):
        PlainContact.setup(self, setup)
        _CONTACTS[0] = 0

    def friction(self, mu, normal, sticking):
        _CONTACTS[0] += 1
        return super().friction(mu / (1.0 + 1e-3 * _CONTACTS[0]), normal, sticking)


class RemembersWork(Bardenhagen):
    """At time zero the work of settling is still on the books."""

    name = "remembers-work"

    def restart(self) -> None:
        pass


class Closed(Sealed, PlainContact):
    """Holds a function."""


class PerPoint(Penalty):
    """Every point has half a cell of the surface, however many points there are."""

    name = "per-point"

    def stiffness(self, rows, old):
        super().stiffness(rows, old)
        n = rows.count
        for k in (rows.own.k, rows.own.limit_k):
            k[:n] *= 0.5 * self.cell_size / rows.tributary_area[:n]
        return rows.own.limit_k
