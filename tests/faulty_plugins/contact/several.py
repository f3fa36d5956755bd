"""Laws of momentum exchange that hold in the simplest scene alone: two equal bodies, face to face, slow,
once.
"""

from __future__ import annotations

import numpy as np

from faulty_plugins.contact.plain import PlainContact
from mpmfw.api import hookimpl


class FirstBodysFriction(PlainContact):
    """A pair has the friction of the first pair that its first body is in."""

    def exchanged(self, pair, m_a, m_b, relative, n):
        self.mu = next(other.friction for other in self.pairs if pair.first in (other.first, other.second))
        return super().exchanged(pair, m_a, m_b, relative, n)

    def friction(self, _mu, normal, sticking):
        return np.minimum(self.mu * normal, sticking)


class FullBuffer(PlainContact):
    """Has room for 64 shared nodes of a pair; the rest is dropped."""

    def shared_nodes(self, grid, pair):
        a, b = super().shared_nodes(grid, pair)
        return a[:64], b[:64]


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


class AbsoluteSpeed(PlainContact):
    """Softer where the bodies are fast, as seen from the grid."""

    def correct(self, grid):
        p = self.state.particles
        self.fast = float(np.linalg.norm(p.mass @ p.velocity / p.mass.sum()))
        super().correct(grid)

    def effective_mass(self, pair, m_a, m_b):
        return super().effective_mass(pair, m_a, m_b) / (1.0 + self.fast / 10.0)


class WritesStress(PlainContact):
    """Relieves the stress of all points a little while bodies touch."""

    @hookimpl
    def after_momentum_projection(self, grid, phi, particles):
        PlainContact.after_momentum_projection(self, grid, phi, particles)
        if any(len(a) for _, a, _, _ in self.shared):
            particles.stress *= 1.0 - 1e-3


class Remembers(PlainContact):
    """Keeps what it did in every step, for nobody."""

    def correct(self, grid):
        super().correct(grid)
        self.log = [*getattr(self, "log", []), grid.momentum.copy()]


class EveryOtherStep(PlainContact):
    """Acts in two steps, and rests in two."""

    @hookimpl
    def setup(self, setup):
        PlainContact.setup(self, setup)
        self.asked = 0

    def correct(self, grid):
        self.asked += 1
        if self.asked // 4 % 2 == 0:
            super().correct(grid)


class LightIsNothing(PlainContact):
    """Leaves nodes out that have less than a hundredth of the largest mass."""

    def shared_nodes(self, grid, pair):
        a, b = super().shared_nodes(grid, pair)
        heavy = np.minimum(grid.mass[a], grid.mass[b]) > 0.01 * grid.mass.max()
        return a[heavy], b[heavy]
