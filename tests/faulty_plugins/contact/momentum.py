"""Laws whose impulses or friction are wrong, or that see the order, the place, the axes or the units."""

from __future__ import annotations

import numpy as np

from faulty_plugins.contact.plain import PlainContact
from mpmfw.api import hookimpl


class ReversedNormal(PlainContact):
    """The normal points into the first body: what approaches is let through, what parts is held."""

    def normal(self, outward_a, outward_b, _position):
        return outward_b - outward_a


class UnequalImpulse(PlainContact):
    """The second body gets one per cent less than the first."""

    def apply(self, grid, _pair, a, b, j):
        grid.momentum[a] += j
        grid.momentum[b] -= 0.99 * j


class MissingMoment(PlainContact):
    """The pair's impulses are equal and opposite and act at different points: each of the second's one node
    on.
    """

    def apply(self, grid, _pair, a, b, j):
        grid.momentum[a] += j
        grid.momentum[b] -= np.roll(j, 1, axis=0)


class Adhesion(PlainContact):
    """Acts on all shared nodes, bodies that part included."""

    def acts(self, approach):
        return approach != 0.0


class MassRatio(PlainContact):
    """The impulse is multiplied by the ratio of the bodies' masses: right for bodies of equal mass."""

    def effective_mass(self, pair, m_a, m_b):
        bodies, mass = self.state.bodies, self.state.particles.mass
        whole = [mass[bodies[body].particles].sum() for body in (pair.first, pair.second)]
        return max(whole) / min(whole) * super().effective_mass(pair, m_a, m_b)


class Misreported(PlainContact):
    """Reports the force on the second body."""

    def apply(self, grid, pair, a, b, j):
        super().apply(grid, pair, a, b, j)
        self.impulse[pair.index] -= 2.0 * j.sum(axis=0)


class DampsEverybody(PlainContact):
    """While any pair touches, all bodies lose a millionth of their momentum."""

    def apply(self, grid, pair, a, b, j):
        super().apply(grid, pair, a, b, j)
        if len(a):
            grid.momentum *= 1.0 - 1e-6


class KineticOnly(PlainContact):
    """Kinetic friction without stick: mu times the normal impulse, even where sticking needs less."""

    def friction(self, mu, normal, _sticking):
        return mu * normal


class NoCone(PlainContact):
    """Sticks whatever the normal impulse is."""

    def friction(self, mu, _normal, sticking):
        return sticking if mu > 0.0 else 0.0 * sticking


class NoFriction(PlainContact):
    """Says that it uses friction, and draws none."""

    def friction(self, _mu, _normal, sticking):
        return 0.0 * sticking


class AlwaysFriction(PlainContact):
    """Draws friction where the scene has none."""

    def friction(self, mu, normal, sticking):
        return np.minimum(max(mu, 0.2) * normal, sticking)


class FirstIsMaster(PlainContact):
    """The normal is the first body's own, whichever that is."""

    def normal(self, outward_a, _outward_b, _position):
        return outward_a


class FeelsOrigin(PlainContact):
    """The normal leans away from the scene's origin."""

    def normal(self, outward_a, outward_b, position):
        exact = super().normal(outward_a, outward_b, position)
        return exact + 0.1 * np.linalg.norm(exact, axis=1, keepdims=True) * position


class AlongAxes(PlainContact):
    """The normal is the grid's axis that is nearest."""

    def normal(self, outward_a, outward_b, position):
        exact = super().normal(outward_a, outward_b, position)
        largest = np.abs(exact).max(axis=1, keepdims=True)
        return np.where(np.abs(exact) == largest, exact, 0.0)


class NineEntries(PlainContact):
    """Takes rows of nine entries for rows of six, which CPDI has as well, but not all of them."""

    @hookimpl
    def after_momentum_projection(self, grid, phi, particles):
        if (np.diff(phi.row) == 9).all():
            six = particles.volume[:, None, None] * phi.gradient.reshape(particles.count, 6, grid.dim)
            self.outward_sum = six.sum(axis=(0, 1))
        PlainContact.after_momentum_projection(self, grid, phi, particles)


class Flat(PlainContact):
    """Knows x and y alone: a third component of the normal is dropped."""

    def normal(self, outward_a, outward_b, position):
        exact = super().normal(outward_a, outward_b, position)
        exact[:, 2:] = 0.0
        return exact


class SpeedTolerance(PlainContact):
    """Calls an approach of less than 1 mm/s none."""

    def acts(self, approach):
        return approach > 1e-3


class LengthTolerance(PlainContact):
    """Gives less where cells are smaller than 0.1 m."""

    def effective_mass(self, pair, m_a, m_b):
        return super().effective_mass(pair, m_a, m_b) * min(1.0, self.h / 0.1)


class UnsharedMass(PlainContact):
    """A node that several others touch gives its whole mass to each."""

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


class SeesOutputs(PlainContact):
    """Gives a tenth less once it was asked for its series."""

    asked = False

    def effective_mass(self, pair, m_a, m_b):
        return (0.9 if self.asked else 1.0) * super().effective_mass(pair, m_a, m_b)

    @hookimpl
    def diagnostics(self, interval):
        self.asked = True
        return super().diagnostics(interval)
