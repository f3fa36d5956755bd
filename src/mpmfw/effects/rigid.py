"""Rigid bodies: each is a velocity field of dim + 1 points of mass, with its mass, centre and inertia.

The velocity anywhere on a body is affine in those of its points, with barycentric weights that never change.
Rows of contact refer to the points as to nodes of the grid, behind which they lie. What forces make of their
momenta is projected to a rigid motion, which keeps the sum and the moment. A mass of −1 marks points whose
motion is prescribed: their momentum is minus their velocity, and no force moves them. The projection also
keeps what is held of a free body's motion.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.effects.contact_moment import CONTACT_HOOKS
from mpmfw.effects.rigid_kinematics import matrix_of
from mpmfw.effects.rigid_motion import RigidMotion
from mpmfw.errors import SceneError
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body, Grid, Particles, Stencil


class RigidBodies(RigidMotion):
    """All rigid bodies of a scene, and what they do in a step."""

    name = "rigid"
    stage = "contact"

    def __init__(self, setup: Setup) -> None:
        super().__init__(setup)
        if self.holds:
            self.ledger_term = "external", "held rigid bodies"
        places, weights = [], []
        for k, body in enumerate(self.bodies):
            nodes = np.concatenate(body.outlines)
            places.append((nodes - self.centre[k]) @ self.turn[k])
            weights.append(self.weights_at(k, nodes))
        self.place = np.concatenate(places)  #: (n_s, dim) surface nodes in the bodies' own axes [m]
        self.owner = np.repeat(np.arange(len(self.bodies)), [len(each) for each in places])
        self.weight: FloatArray = np.concatenate(weights).ravel()
        corners = self.dim + 1
        self.point_mass = np.repeat(self.share, corners)
        #: of rows of the surface nodes: their ends, and nodes, from the first point of mass on
        self.row = corners * np.arange(1, len(self.place) + 1)
        self.nodes = (corners * self.owner[:, None] + np.arange(corners)).ravel()
        self.moves = not self.prescribed.all() or any(np.any(t.values) for each in self.motion for t in each)
        loaded = any(body.rigid for load in setup.named["loads"].values() for body in load.bodies)
        self.projects = self.holds or loaded  #: forces to a rigid motion, before contact reads the momenta
        self.table: Stencil | None = None
        self.moved = False  #: in this step
        self.while_settling(None)

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        """Return the bodies; raise SceneError if a contact cannot distinguish them from deformable ones."""
        contact = setup.contact
        if contact is None or not setup.field_per_body:
            raise SceneError(
                "a rigid body needs a contact that gives every body a velocity field", key="contact"
            )
        detection = getattr(contact, "detection", None)
        acts = any(hasattr(contact, hook) for hook in CONTACT_HOOKS)
        if not getattr(detection, "finds_rigid", not acts):
            raise SceneError(
                f"contact '{contact.label}' finds material points, of which a rigid body has none; expected "
                "a detection on surfaces or at nodes",
                key="contact",
            )
        setup.state.rigid = bodies = cls(setup)
        shown = []
        for body in bodies.bodies:
            model: Any = setup.scene.bodies[body.name]
            held = getattr(model.rigid, "held", None)
            shown.append(body.name + (f" ({', '.join(held)} held)" if held else ""))
        return Acts(", ".join(shown), [bodies])

    def surface_velocity(self, body: Body) -> FloatArray:
        """Velocity of a body's surface nodes (n_s, dim) [m/s]."""
        k = self.bodies.index(body)
        arm = self.place[self.owner == k] @ self.turn[k].T
        return np.asarray(self.velocity[k] + arm @ self.spin[k].T)

    @property
    def fastest(self) -> float:
        """Largest speed of a surface node of all bodies [m/s]."""
        if not self.moves:
            return 0.0
        return max(float(np.linalg.norm(self.surface_velocity(body), axis=1).max()) for body in self.bodies)

    def particles_of(self, body: Body) -> Particles:
        """Return dim + 1 points with mass and inertia of a free body, for loads; they bear no stress."""
        k, count, dim = self.bodies.index(body), self.dim + 1, self.dim
        tensor, volume = np.zeros((count, dim, dim)), np.full(count, self.volume[k] / count)
        arms = self.arms[k] / self.far[k]
        return Particles(
            position=self.centre[k] + arms,
            velocity=self.velocity[k] + arms @ self.spin[k].T,
            mass=np.full(count, self.mass[k] / count),
            initial_volume=volume,
            volume=volume,
            deformation_gradient=tensor + np.eye(dim),
            velocity_gradient=tensor + self.spin[k],
            stress=tensor,
            affine=None,
            moment=None,
            first=np.array([0, count]),
        )

    def add_forces(self, body: Body, force: FloatArray, nodal: FloatArray) -> None:
        """Add the ``force`` (dim + 1, dim) on :meth:`particles_of`, with its moment, to that of nodes."""
        k, mean = self.bodies.index(body), force.mean(axis=0)
        self.own(nodal)[k] += mean + (force - mean) / self.far[k]

    def own(self, nodal: FloatArray) -> FloatArray:
        """Entries of the points of mass in an array of nodes, as (n, dim + 1, dim)."""
        return nodal[-len(self.point_mass) :].reshape(self.points.shape)

    def with_points(self, plain: Stencil) -> Stencil:
        """Return the table ``plain`` of the surface nodes on the grid with rows of those of rigid bodies."""
        grid, end = self.state.grid, int(plain.row[-1])
        size = end + len(self.weight)
        if self.table is None or self.table.room < size:
            nodes, row = (
                np.zeros(2 * size, dtype=np.int32),
                np.zeros(len(plain.row) + len(self.place), np.int64),
            )
            self.table = Stencil(row, nodes, np.zeros(2 * size), np.zeros((0, self.dim)))
        row, nodes, weight, _ = self.table.kernel_arrays
        row[: len(plain.row)] = plain.row
        np.add(self.row, end, out=row[len(plain.row) :])
        nodes[:end], weight[:end] = plain.nodes[:end], plain.weight[:end]
        nodes[end:size] = self.nodes + (int(grid.offset[-1]) - len(self.point_mass))
        weight[end:size] = self.weight
        return self.table

    def _write_momentum(self, grid: Grid) -> None:
        """Write the momenta of all points in the present motion."""
        self.own(grid.momentum)[...] = self.share * self.point_velocity

    @hookimpl(tryfirst=True)
    def detect(self, grid: Grid) -> None:
        """Place the points of mass, with their momenta at the beginning of a step."""
        self.moved = False
        self._write_momentum(grid)
        grid.mass[-len(self.point_mass) :] = self.point_mass
        self.own(grid.position)[...] = self.centre[:, None] + self.arms
        self.own(grid.start_velocity)[...] = self.point_velocity

    @hookimpl(tryfirst=True)
    def after_momentum_projection(self, grid: Grid, dt: float) -> None:
        """Take the prescribed velocities, which are means over the step of ``dt`` [s]."""
        if self.settles or not self.moves:
            return
        for k in np.flatnonzero(self.prescribed):
            velocity, omega, belt = (table.mean(self.state.time, dt) for table in self.motion[k])
            self.velocity[k], self.spin[k], self.belt[k] = velocity, matrix_of(omega, self.dim), belt
        self.restored()
        self._write_momentum(grid)

    @hookimpl(tryfirst=True)
    def after_momentum_update(self, grid: Grid) -> None:
        """Take back what forces have done to what is prescribed or held."""
        own = self.own(grid.momentum)
        if self.projects:
            self._project(grid)
        np.copyto(own, -self.point_velocity, where=self.prescribed[:, None, None])

    @hookimpl(trylast=True)
    def constrain_momentum(self, grid: Grid) -> None:
        """Project the momenta to rigid motions, and keep the prescribed ones; MUSL's second moves nothing."""
        if not self.moved and self.free.any():
            self._project(grid)
        self._write_momentum(grid)

    def _project(self, grid: Grid) -> None:
        """Take the motion from the momenta, and what holds parts of it in from their change."""
        own, free = self.own(grid.momentum), self.free
        before = own.copy()
        self._read_motion(own)
        if self.projects:
            self._write_momentum(grid)
            self.work += float(np.vdot((own - before)[free], self.point_velocity[free]))

    def make_rigid(self, grid: Grid) -> None:
        """Give the momenta a rigid motion of the same sum and moment, but for what is prescribed or held."""
        motion = self.velocity.copy(), self.spin.copy()
        self._read_motion(self.own(grid.momentum))
        self._write_momentum(grid)
        self.velocity, self.spin = motion
        self.restored()

    @hookimpl(tryfirst=True)
    def after_second_projection(self, grid: Grid) -> None:
        """Write the momenta again for the velocity of the strain, from which no body moves."""
        self._write_momentum(grid)

    @hookimpl(tryfirst=True)
    def advect(self, grid: Grid, dt: float) -> None:
        """Move the bodies with the final velocities of their points, and their surfaces."""
        self.moved = True
        surface = self.state.tracked_surface
        nodes = slice(surface.on_grid, None)
        if not self.moves:
            self.own(grid.velocity)[...] = surface.displacement[nodes] = 0.0
            return
        self._read_motion(self.share * self.own(grid.velocity))  # settling damps the momentum last of all
        self.own(grid.velocity)[...] = self.point_velocity
        self.centre += dt * self.velocity
        self._turn(dt)
        new = self.centre[self.owner] + np.einsum("sde,se->sd", self.turn[self.owner], self.place)
        surface.displacement[nodes] = new - surface.position[nodes]
        if self.belt.any():
            surface.displacement[nodes] += dt * self.belt[self.owner]
        surface.position[nodes] = new
