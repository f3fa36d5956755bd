"""Momentum exchange at shared nodes, written out in NumPy: right, and easy to spoil in one place.

The law is that of Bardenhagen et al. (2001): where two bodies share a node and approach each other along n,
the normal part of their relative velocity is taken away, and the tangential one as far as Coulomb's cone lets
it."""

import numpy as np

from faulty_plugins.sealed import Named
from mpmfw.api import CONTACT_SERIES, ContactStrategy, hookimpl

FORCE = next(field for field in CONTACT_SERIES if field.name == "contact_force")


class PlainContact(Named, ContactStrategy):
    """The law without a fault; every method below is one place to plant one."""

    name = "plain"
    velocity_fields = "per_body"
    uses_friction = True

    @hookimpl
    def declare_fields(self):
        return [FORCE]

    @hookimpl
    def setup(self, setup):
        self.state, self.pairs, self.h = setup.state, setup.pairs, setup.cell_size
        self.impulse = np.zeros((len(setup.pairs), setup.dim))
        self.shared = []

    @hookimpl
    def after_momentum_projection(self, grid, phi, particles):
        owner = np.repeat(np.arange(particles.count), np.diff(phi.row))
        outward = np.zeros_like(grid.momentum)
        np.add.at(outward, phi.nodes, particles.volume[owner, None] * phi.gradient)
        self.shared = []
        for pair in self.pairs:
            a, b = self.shared_nodes(grid, pair)
            n = self.normal(outward[a], outward[b], grid.position[a])
            length = np.linalg.norm(n, axis=1, keepdims=True)
            self.shared.append((pair, a, b, np.divide(n, length, out=np.zeros_like(n), where=length > 0.0)))
        self.correct(grid)

    @hookimpl
    def after_momentum_update(self, grid):
        self.correct(grid)

    def correct(self, grid):
        """Impulses of all pairs, from the same velocities; a node's mass is shared out among its pairs."""
        sharers = np.zeros(len(grid.mass))
        found = []
        for pair, a, b, n in self.shared:
            relative = grid.momentum[a] / grid.mass[a, None] - grid.momentum[b] / grid.mass[b, None]
            acts = self.acts((relative * n).sum(axis=1))
            a, b, n, relative = a[acts], b[acts], n[acts], relative[acts]
            sharers[a] += 1.0
            sharers[b] += 1.0
            found.append((pair, a, b, n, relative))
        for pair, a, b, n, relative in found:
            m_a, m_b = grid.mass[a] / sharers[a], grid.mass[b] / sharers[b]
            j = self.exchanged(pair, m_a, m_b, relative, n)
            self.apply(grid, pair, a, b, j)
            self.impulse[pair.index] += j.sum(axis=0)

    def shared_nodes(self, grid, pair):
        """Flat nodes of the two bodies' fields at the same places, where both have mass."""
        ids = []
        for body in (pair.first, pair.second):
            shape = grid.window_shape[body]
            local = np.stack(np.unravel_index(np.arange(np.prod(shape)), shape), axis=1)
            ids.append(np.ravel_multi_index((grid.window_lower[body] + local).T, grid.nodes + 1))
        _, i, j = np.intersect1d(*ids, assume_unique=True, return_indices=True)
        a, b = grid.offset[pair.first] + i, grid.offset[pair.second] + j
        both = (grid.mass[a] > 0.0) & (grid.mass[b] > 0.0)
        return a[both], b[both]

    def normal(self, outward_a, outward_b, _position):
        """Out of the first body, of any length."""
        return outward_a - outward_b

    def acts(self, approach):
        """At which nodes there is contact."""
        return approach > 0.0

    def exchanged(self, pair, m_a, m_b, relative, n):
        """Impulse on the first body, (k, dim)."""
        m = self.effective_mass(pair, m_a, m_b)
        approach = (relative * n).sum(axis=1)
        slip = relative - approach[:, None] * n
        speed = np.linalg.norm(slip, axis=1)
        direction = np.divide(slip, speed[:, None], out=np.zeros_like(slip), where=speed[:, None] > 0.0)
        tangential = self.friction(pair.friction, m * approach, m * speed)
        return -(m * approach)[:, None] * n - tangential[:, None] * direction

    def effective_mass(self, _pair, m_a, m_b):
        return m_a * m_b / (m_a + m_b)

    def friction(self, mu, normal, sticking):
        """Magnitude of the tangential impulse, against the slip."""
        return np.minimum(mu * normal, sticking)

    def apply(self, grid, _pair, a, b, j):
        grid.momentum[a] += j
        grid.momentum[b] -= j

    def restart(self):
        self.impulse[:] = 0.0

    @hookimpl
    def diagnostics(self, interval):
        force = self.impulse / interval if interval > 0.0 else np.zeros_like(self.impulse)
        self.impulse = np.zeros_like(self.impulse)
        return {"contact_force": force}
