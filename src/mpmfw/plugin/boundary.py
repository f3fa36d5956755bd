"""Boundary conditions that a scene names: motion that is prescribed by time and place."""

from __future__ import annotations

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.kernels import kernel
from mpmfw.kernels.types import Floats, Ints, Table
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.named import NamedPlugIn
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, FloatArray
from mpmfw.state.structs import Grid, Particles, Stencil


@kernel
def project_mass(which: Ints, table: Table, mass: Floats, node_mass: Floats) -> None:
    """m_i = Σ φ_ip m_p of some points alone."""
    node_mass[:] = 0.0
    for p in which:
        for k in range(table.row[p], table.row[p + 1]):
            node_mass[table.nodes[k]] += table.weight[k] * mass[p]


class Boundary(NamedPlugIn):
    """Base of boundary conditions: one instance for each table ``[boundaries.NAME]`` of the scene.

    Subclasses say which material points are held, :meth:`holds`, and how they move, :meth:`velocity`. Nodes
    with most of their mass from held points move so: the region's edge is known to half a cell. A body's
    ``sides`` hold plane sides exactly.
    """

    ledger_term = ("external", "boundary conditions")
    history = ("work",)
    work = 0.0  #: on the bodies so far [J/m]

    def holds(self, position: FloatArray) -> AnyArray:
        """Return which points at ``position`` (n, dim) [m] are held: (n,)."""
        raise NotImplementedError

    def velocity(self, position: FloatArray, time: float) -> FloatArray:
        """Return the velocity (n, dim) [m/s] of nodes at ``position`` (n, dim) [m] at a ``time`` [s].

        NaN leaves a component free."""
        raise NotImplementedError

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Find the held points; refuse none, and a shared velocity field."""
        self.state = state = setup.state
        found = []
        if state.grid.n_fields < len(state.bodies):
            raise SceneError(
                "the bodies share one velocity field; none can be held alone", key=f"boundaries.{self.title}"
            )
        for body in self.bodies:
            position = state.particles.position[body.particles]
            held = self.checked(self.holds(position.copy()), (len(position),), state) != 0.0
            found.append(body.particles.start + np.flatnonzero(held))
        self.held = np.concatenate(found).astype(np.int64)
        if len(self.held) == 0:
            names = ", ".join(body.name for body in self.bodies)
            raise SceneError(f"holds no material point of {names}", key=f"boundaries.{self.title}")
        self.node_mass, self.at_rest = np.zeros(0), False
        self.calls = self.left = 2 if setup.scheme == "usf" else 1

    def while_settling(self, asked: object) -> None:
        """Stand still until ``asked`` is None."""
        self.at_rest = asked is not None

    @hookimpl
    def detect(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """Project the mass of the held points alone."""
        if len(self.node_mass) != len(grid.mass):
            self.node_mass = np.zeros(len(grid.mass))
        project_mass(self.held, phi, particles.mass, self.node_mass)

    @hookimpl
    def constrain_momentum(self, grid: Grid, time: float) -> None:
        """(m v)_i = m_i V(x_i, t) at held nodes, t the end of the step."""
        nodes = np.flatnonzero(self.node_mass > 0.5 * grid.mass)
        position = grid.position[nodes]
        answer = self.velocity(position.copy(), time)
        velocity = self.checked(answer, position.shape, self.state, missing=True)
        if self.at_rest:
            velocity *= 0.0
        wanted = grid.mass[nodes, None] * velocity
        wanted = np.where(np.isnan(velocity), grid.momentum[nodes], wanted)
        if self.left > 0:  # the call of MUSL after the second projection moves nothing
            self.work += float(np.nansum((wanted - grid.momentum[nodes]) * velocity))
            self.left -= 1
        grid.momentum[nodes] = wanted

    @hookimpl
    def end_step(self) -> None:
        """Count the work of the next step."""
        self.left = self.calls
