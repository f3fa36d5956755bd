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


class EightPairs(PlainContact):
    """Has room for eight pairs that touch; the rest is dropped."""

    def correct(self, grid):
        self.shared = [each for each in self.shared if len(each[1])][:8]
        super().correct(grid)


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


class TwentiethPerStep(PlainContact):
    """Takes a twentieth of the approach away in a step, however long that is."""

    def effective_mass(self, pair, m_a, m_b):
        return 0.05 * super().effective_mass(pair, m_a, m_b)


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


class CentreLine(PlainContact):
    """The normal is the line between the bodies' centres: right for discs, and for blocks that lie opposite
    each other.
    """

    def shared_nodes(self, grid, pair):
        x, bodies = self.state.particles.position, self.state.bodies
        first, second = (x[bodies[body].particles].mean(axis=0) for body in (pair.first, pair.second))
        self.line = second - first
        return super().shared_nodes(grid, pair)

    def normal(self, outward_a, _outward_b, _position):
        return np.broadcast_to(self.line, outward_a.shape)


class StaleNormal(PlainContact):
    """A node keeps the normal that it had when the bodies first shared it."""

    def shared_nodes(self, grid, pair):
        self.now = pair.index
        return super().shared_nodes(grid, pair)

    def normal(self, outward_a, outward_b, position):
        if not hasattr(self, "kept"):
            self.kept = np.full((len(self.pairs), 400, 400, position.shape[1]), np.nan)
        at = tuple(np.round(position[:, :2] / self.h).astype(int).T + 200)
        found = super().normal(outward_a, outward_b, position)
        first = np.isnan(self.kept[self.now][at]).any(axis=1)
        kept = np.where(first[:, None], found, self.kept[self.now][at])
        self.kept[self.now][at] = kept
        return kept


class PlanarFriction(PlainContact):
    """Friction along x and y alone."""

    def exchanged(self, pair, m_a, m_b, relative, n):
        flat = relative.copy()
        if relative.shape[1] == 3:
            along = (relative[:, 2] * n[:, 2])[:, None] * n
            flat[:, 2] = along[:, 2]
        return super().exchanged(pair, m_a, m_b, flat, n)


class DrainsEnergy(PlainContact):
    """Nodes that touch lose a fiftieth of their motion against each other: momentum stays, energy goes."""

    def apply(self, grid, pair, a, b, j):
        super().apply(grid, pair, a, b, j)
        for nodes in (a, b):
            if len(nodes):
                mass = grid.mass[nodes]
                mean = grid.momentum[nodes].sum(axis=0) / mass.sum()
                grid.momentum[nodes] -= 0.1 * (grid.momentum[nodes] - mass[:, None] * mean)
