"""Laws that know metres and seconds, the first pair alone, or when somebody looks."""

from __future__ import annotations

import numpy as np

from faulty_plugins.contact.plain import PlainContact
from mpmfw.api import hookimpl


class SpeedTolerance(PlainContact):
    """Calls an approach of less than 1 mm/s none."""

    name = "speed-tolerance"

    def acts(self, approach):
        return approach > 1e-3


class LengthTolerance(PlainContact):
    """Gives less where cells are smaller than 0.1 m."""

    name = "length-tolerance"

    def effective_mass(self, pair, m_a, m_b):
        return super().effective_mass(pair, m_a, m_b) * min(1.0, self.h / 0.1)


class UnsharedMass(PlainContact):
    """A node that several others touch gives its whole mass to each."""

    name = "unshared-mass"

    def correct(self, grid):
        for pair, a, b, n in self.shared:
            relative = grid.momentum[a] / grid.mass[a, None] - grid.momentum[b] / grid.mass[b, None]
            acts = self.acts((relative * n).sum(axis=1))
            a, b, n, relative = a[acts], b[acts], n[acts], relative[acts]
            self.pending = getattr(self, "pending", [])
            self.pending.append((pair, a, b, self.exchanged(pair, grid.mass[a], grid.mass[b], relative, n)))
        for pair, a, b, j in self.pending:
            self.apply(grid, pair, a, b, j)
            self.impulse[pair.index] += j.sum(axis=0)
        self.pending = []


class OneFriction(PlainContact):
    """Every pair has the friction of the first."""

    name = "one-friction"

    def friction(self, _mu, normal, sticking):
        return np.minimum(self.pairs[0].friction * normal, sticking)


class SeesOutputs(PlainContact):
    """Gives a tenth less once it was asked for its series."""

    name = "sees-outputs"
    asked = False

    def effective_mass(self, pair, m_a, m_b):
        return (0.9 if self.asked else 1.0) * super().effective_mass(pair, m_a, m_b)

    @hookimpl
    def diagnostics(self, interval):
        self.asked = True
        return super().diagnostics(interval)
