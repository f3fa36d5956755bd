"""Laws that see what they must not: the order of the bodies, the place in the grid, its axes, one shape
function.
"""

from __future__ import annotations

import numpy as np

from faulty_plugins.contact.plain import PlainContact
from mpmfw.api import hookimpl


class FirstIsMaster(PlainContact):
    """The normal is the first body's own, whichever that is."""

    name = "first-is-master"

    def normal(self, outward_a, _outward_b, _position):
        return outward_a


class MiddleIsLighter(PlainContact):
    """Of three bodies the one in the middle of the list gets smaller impulses; the same one if the list is
    reversed.
    """

    name = "middle-is-lighter"

    def effective_mass(self, pair, m_a, m_b):
        middle = len(self.state.bodies) == 3 and 1 in (pair.first, pair.second)
        return (0.9 if middle else 1.0) * super().effective_mass(pair, m_a, m_b)


class FeelsOrigin(PlainContact):
    """The normal leans away from the scene's origin."""

    name = "feels-origin"

    def normal(self, outward_a, outward_b, position):
        exact = super().normal(outward_a, outward_b, position)
        return exact + 0.1 * np.linalg.norm(exact, axis=1, keepdims=True) * position


class AlongAxes(PlainContact):
    """The normal is the grid's axis that is nearest."""

    name = "along-axes"

    def normal(self, outward_a, outward_b, position):
        exact = super().normal(outward_a, outward_b, position)
        largest = np.abs(exact).max(axis=1, keepdims=True)
        return np.where(np.abs(exact) == largest, exact, 0.0)


class NineEntries(PlainContact):
    """Takes rows of nine entries for rows of six, which CPDI has as well, but not all of them."""

    name = "nine-entries"

    @hookimpl
    def after_momentum_projection(self, grid, phi, particles):
        if (np.diff(phi.row) == 9).all():
            six = particles.volume[:, None, None] * phi.gradient.reshape(particles.count, 6, grid.dim)
            self.outward_sum = six.sum(axis=(0, 1))
        PlainContact.after_momentum_projection(self, grid, phi, particles)


class Flat(PlainContact):
    """Knows x and y alone: a third component of the normal is dropped."""

    name = "flat"

    def normal(self, outward_a, outward_b, position):
        exact = super().normal(outward_a, outward_b, position)
        exact[:, 2:] = 0.0
        return exact
