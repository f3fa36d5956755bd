"""Laws whose impulses are wrong: their sum, their line, their direction, their size."""

from __future__ import annotations

import numpy as np

from faulty_plugins.contact.plain import PlainContact


class ReversedNormal(PlainContact):
    """The normal points into the first body: what approaches is let through, what parts is held."""

    name = "reversed-normal"

    def normal(self, outward_a, outward_b, _position):
        return outward_b - outward_a


class UnequalImpulse(PlainContact):
    """The second body gets one per cent less than the first."""

    name = "unequal-impulse"

    def apply(self, grid, _pair, a, b, j):
        grid.momentum[a] += j
        grid.momentum[b] -= 0.99 * j


class MissingMoment(PlainContact):
    """The pair's impulses are equal and opposite and act at different points: each of the second's one node
    on.
    """

    name = "missing-moment"

    def apply(self, grid, _pair, a, b, j):
        grid.momentum[a] += j
        grid.momentum[b] -= np.roll(j, 1, axis=0)


class Adhesion(PlainContact):
    """Acts on all shared nodes, bodies that part included."""

    name = "adhesion"

    def acts(self, approach):
        return approach != 0.0


class MassRatio(PlainContact):
    """The impulse is multiplied by the ratio of the bodies' masses: right for bodies of equal mass."""

    name = "mass-ratio"

    def effective_mass(self, pair, m_a, m_b):
        bodies, mass = self.state.bodies, self.state.particles.mass
        whole = [mass[bodies[body].particles].sum() for body in (pair.first, pair.second)]
        return max(whole) / min(whole) * super().effective_mass(pair, m_a, m_b)


class ForceAtDistance(PlainContact):
    """Bodies whose heaviest nodes are within twelve cells push at each other, a little, from the nodes with
    most mass.
    """

    name = "force-at-distance"

    def correct(self, grid):
        super().correct(grid)
        for pair in self.pairs:
            nodes = [grid.field_nodes(body) for body in (pair.first, pair.second)]
            a, b = (own.start + int(grid.mass[own].argmax()) for own in nodes)
            apart = grid.position[b] - grid.position[a]
            if np.linalg.norm(apart) < 12.0 * self.h:
                grid.momentum[a] -= 1e-6 * apart
                grid.momentum[b] += 1e-6 * apart


class Misreported(PlainContact):
    """Reports the force on the second body."""

    name = "misreported"

    def apply(self, grid, pair, a, b, j):
        super().apply(grid, pair, a, b, j)
        self.impulse[pair.index] -= 2.0 * j.sum(axis=0)


class DampsEverybody(PlainContact):
    """While any pair touches, all bodies lose a millionth of their momentum."""

    name = "damps-everybody"

    def apply(self, grid, pair, a, b, j):
        super().apply(grid, pair, a, b, j)
        if len(a):
            grid.momentum *= 1.0 - 1e-6
