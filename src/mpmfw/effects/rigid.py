"""Rigid bodies: each is a velocity field of dim + 1 points of mass, with its mass, centre and inertia.

The velocity anywhere on a body is affine in those of its points, with barycentric weights that never change.
Rows of contact refer to the points as to nodes of the grid, behind which they lie. What forces make of their
momenta is projected to a rigid motion, which keeps the sum and the moment. A mass of −1 marks points whose
motion is prescribed: their momentum is minus their velocity, and no force moves them. The projection also
keeps what is held of a free body's motion.

Matrices W have W r = ω × r. With the second moment S of mass the angular momentum is L = W S + S W; along the
principal axes of S, which are the body's own axes, W_de = L_de / (s_d + s_e).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.effects.contact_moment import CONTACT_HOOKS
from mpmfw.effects.rigid_kinematics import (
    in_axes,
    mass_of,
    matrix_of,
    rotations,
    simplex,
    tables_of,
    vector_of,
)
from mpmfw.errors import SceneError
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body, Grid, Stencil
from mpmfw.state.surface import moments_of

if TYPE_CHECKING:
    from mpmfw.scene.bodies import RigidBody

#: Most iterations for the angular velocity in the middle of a step; about five are used.
ITERATIONS = 50

#: By how many times the points of mass of a body whose rotation is held are farther apart: rows then see the
#: body's mass alone, where they see an inertia else.
FAR = 1e2

#: Second moment of mass over the largest below which a body counts as a plate without thickness.
FLAT = 1e-9


class RigidBodies:
    """All rigid bodies of a scene: places, turns and motion, and what they do in a step."""

    name = "rigid"
    stage = "contact"
    history = ("centre", "turn", "velocity", "spin", "belt", "work")

    def __init__(self, setup: Setup) -> None:
        self.state, self.dim = setup.state, setup.dim
        self.bodies = [body for body in setup.bodies if body.rigid]
        count, dim = len(self.bodies), self.dim
        models: list[RigidBody] = [setup.scene.bodies[body.name] for body in self.bodies]  # type: ignore[misc]
        self.prescribed = np.array([body.prescribed for body in self.bodies])
        self.free = ~self.prescribed
        self.centre, self.velocity = np.zeros((count, dim)), np.zeros((count, dim))
        self.turn, self.spin = np.zeros((count, dim, dim)), np.zeros((count, dim, dim))
        self.belt = np.zeros((count, dim))  #: velocity of the surface over the body [m/s]
        held = [getattr(model.rigid, "held", None) or () for model in models]
        if setup.state.grid.axisymmetric:  # what acts round the axis moves a free body along it alone
            held = [("x", "rotation") if free else () for free in self.free]
        #: components of the velocity (n, dim) and spins (n, 1, 1) of free bodies that no force changes
        self.held = np.array([[name in each for name in "xyz"[:dim]] for each in held])
        self.held_spin = np.array(["rotation" in each for each in held])[:, None, None]
        #: axes (n, 3) about which alone bodies in space do not turn
        self.held_axes = np.array([[f"rotation-{name}" in each for name in "xyz"] for each in held])
        self.work = 0.0  #: of what holds them, on free bodies [J/m]
        self.turned = 0.0  #: of it that of this step's torques, which keep spins as bodies turn
        #: whether part of a free body's motion is held
        self.holds = bool(self.held.any() or self.held_spin.any() or self.held_axes.any())
        if self.holds:
            self.ledger_term = "external", "held rigid bodies"
        self.mass = np.zeros(count)  #: (n,) [kg/m]; 0 where the motion is prescribed
        self.spread = np.zeros((count, dim))  #: (n, dim) Σ m x_k² along the body's own axes
        self.radii = np.zeros((count, dim))  #: of gyration, which the points of mass have [m]
        self.offset = np.zeros((count, dim))  #: (n, dim) of the centroid, in the body's own axes [m]
        places, weights = [], []
        for k, (body, model) in enumerate(zip(self.bodies, models, strict=True)):
            self._describe(k, body, model)
            nodes = np.concatenate(body.outlines)
            places.append((nodes - self.centre[k]) @ self.turn[k])
            weights.append(self.weights_at(k, nodes))
        self.place = np.concatenate(places)  #: (n_s, dim) surface nodes in the bodies' own axes [m]
        self.owner = np.repeat(np.arange(count), [len(each) for each in places])
        self.weight: FloatArray = np.concatenate(weights).ravel()
        self.sums = self.spread[:, :, None] + self.spread[:, None, :]  #: s_d + s_e (n, dim, dim)
        self.sums[self.sums == 0.0] = np.inf  # no spin is of one axis
        self.points = simplex(dim) * self.radii[:, None]  #: of mass, in the body's own axes (n, dim + 1, dim)
        self.share = np.where(self.prescribed, -1.0, self.mass / (dim + 1))[:, None, None]  #: of each point
        self.point_mass = np.repeat(self.share, dim + 1)
        #: of rows of the surface nodes: their ends, and nodes, from the first point of mass on
        self.row = (dim + 1) * np.arange(1, len(self.place) + 1)
        self.nodes = ((dim + 1) * self.owner[:, None] + np.arange(dim + 1)).ravel()
        self.motion = [tables_of(model, dim) for model in models]
        self.moves = not self.prescribed.all() or any(np.any(t.values) for each in self.motion for t in each)
        self.table: Stencil | None = None
        self.moved = False  #: in this step
        self.while_settling(None)

    def _describe(self, k: int, body: Body, model: RigidBody) -> None:
        """Take centre, axes, radii and mass of a body."""
        volume, centroid, second = moments_of(body.outlines, body.facets)
        if model.geometry.type == "half_space":
            centroid = model.geometry.centroid
        self.centre[k], self.turn[k] = centroid, np.eye(self.dim)
        self.radii[k] = np.full(self.dim, np.sqrt(np.trace(second) / volume / self.dim))
        if (
            not isinstance(model.rigid, bool)
            and model.rigid.motion is not None
            and model.rigid.motion.about is not None
        ):
            self.centre[k] = model.rigid.motion.about
            self.offset[k] = centroid - self.centre[k]
        elif not body.prescribed:
            thickness = 2.0 * np.pi * centroid[0] if self.state.grid.axisymmetric else body.thickness
            self.mass[k], own = mass_of(model, volume, second, thickness)
            spread, self.turn[k] = np.linalg.eigh(own)
            flat = spread < FLAT * spread.max()
            self.spread[k] = np.where(flat, 0.0, spread)
            shape = np.diag(self.turn[k].T @ second @ self.turn[k]) / volume
            squares = np.where(flat, shape, self.spread[k] / self.mass[k])  # a flat one's are of its shape
            self.radii[k] = np.sqrt(squares) * (FAR if self.held_spin[k] else 1.0)

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

    # -- where they are

    @property
    def centroid(self) -> FloatArray:
        """Centroids (n, dim) [m]."""
        return np.asarray(self.centre + np.einsum("nde,ne->nd", self.turn, self.offset))

    def restored(self) -> None:
        """Work out arms and velocities of the points of mass, (n, dim + 1, dim), from place and motion."""
        self.arms = np.einsum("nde,nje->njd", self.turn, self.points)
        self.point_velocity = self.velocity[:, None] + np.einsum("nde,nje->njd", self.spin, self.arms)
        if self.belt.any():
            self.point_velocity += self.belt[:, None]

    @property
    def angular_velocity(self) -> FloatArray:
        """ω (n, 1) in the plane, (n, 3) in space [rad/s]."""
        return vector_of(self.spin)

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

    def weights_at(self, body: int, position: FloatArray) -> FloatArray:
        """Weights of the points of mass of rigid body ``body``, from 0, at a ``position`` (n, dim) [m]."""
        own = (position - self.centre[body]) @ self.turn[body]
        return np.asarray((1.0 + (own / self.radii[body]) @ simplex(self.dim).T) / (self.dim + 1))

    # -- what results have of them

    @property
    def kinetic_energy(self) -> FloatArray:
        """Of free bodies (n,) [J/m]; 0 of others, which have no mass."""
        own = in_axes(self.spin, np.swapaxes(self.turn, 1, 2))
        turning = 0.5 * np.einsum("nde,ne,nde->n", own, self.spread, own)
        return np.asarray(0.5 * self.mass * np.einsum("nd,nd->n", self.velocity, self.velocity) + turning)

    @property
    def moment(self) -> FloatArray:
        """L = W S + S W of free bodies (n, dim, dim) [kg m/s]."""
        own = in_axes(self.spin, np.swapaxes(self.turn, 1, 2))
        return in_axes(own * (self.spread[:, :, None] + self.spread[:, None, :]), self.turn)

    def write_sums(self, total: Any, centre: Any, mean: Any, spin: Any, second: Any, kinetic: Any) -> None:
        """Write mass, centre, mean velocity, L, Σ m r rᵀ and energy to the last rows, one a rigid body."""
        own = slice(len(total) - len(self.bodies), None)
        total[own], centre[own], kinetic[own] = self.mass, self.centroid, self.kinetic_energy
        mean[own] = self.velocity + np.einsum("nde,ne->nd", self.spin, self.centroid - self.centre)
        spin[own] = vector_of(self.moment)
        second[own] = in_axes(np.einsum("nd,de->nde", self.spread, np.eye(self.dim)), self.turn)

    # -- a step

    def while_settling(self, asked: Any) -> None:
        """Stand still while a scene settles; ``asked`` is None when the motion begins."""
        self.settles = asked is not None
        for k, (velocity, omega, belt) in enumerate(self.motion):
            moves = 0.0 if self.settles else 1.0
            self.velocity[k], self.belt[k] = moves * velocity.at(0.0), moves * belt.at(0.0)
            self.spin[k] = moves * matrix_of(omega.at(0.0), self.dim)
        self.restored()

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
        if self.holds:
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
        if self.holds:
            self._write_momentum(grid)
            self.work += float(np.vdot((own - before)[free], self.point_velocity[free]))

    def make_rigid(self, grid: Grid) -> None:
        """Give the momenta a rigid motion of the same sum and moment, but for what is prescribed or held."""
        motion = self.velocity.copy(), self.spin.copy()
        self._read_motion(self.own(grid.momentum))
        self._write_momentum(grid)
        self.velocity, self.spin = motion
        self.restored()

    def _read_motion(self, momentum: FloatArray) -> None:
        """Take the motion of free bodies that has the sum and the moment of their points' ``momentum``, but
        for what is held."""
        free = self.free
        if not free.any():
            return
        velocity = momentum[free].sum(axis=1) / self.mass[free, None]
        lever = np.einsum("njd,nje->nde", momentum[free], self.arms[free])
        spin = self._hold_axes(self.spin_of(lever - np.swapaxes(lever, 1, 2), free), free)
        self.velocity[free] = np.where(self.held[free], self.velocity[free], velocity)
        self.spin[free] = np.where(self.held_spin[free], self.spin[free], spin)
        self.restored()

    def spin_of(self, moment: FloatArray, free: Any) -> FloatArray:
        """W of L, (n, dim, dim), of ``free`` bodies."""
        own = in_axes(moment, np.swapaxes(self.turn[free], 1, 2))
        return in_axes(own / self.sums[free], self.turn[free])

    def _hold_axes(self, spin: FloatArray, which: Any, scale: float = 1.0) -> FloatArray:
        """Return ``spin`` (n, dim, dim) of the bodies ``which`` with reactions about the axes that are held.

        There it is ``scale`` times the present one: ω − I⁻¹ λ, λ a torque along these axes alone."""
        own = np.arange(len(self.bodies))[which]
        for row in np.flatnonzero(self.held_axes[own].any(axis=1)):
            k, held = own[row], self.held_axes[own[row]]
            unit = np.array([matrix_of(axis, 3) for axis in np.eye(3)])
            inverse = vector_of(self.spin_of(unit, np.full(3, k)))
            omega = vector_of(spin[row : row + 1])[0]
            excess = omega[held] - scale * vector_of(self.spin[k : k + 1])[0, held]
            spin[row] = matrix_of(omega - np.linalg.solve(inverse[held][:, held], excess) @ inverse[held], 3)
        return spin

    @property
    def inverse_mass(self) -> FloatArray:
        """Velocities (n_points, dim, dim + 1, dim) of a body's points by a unit impulse on one of them, along
        each axis [1/kg]; none by one on prescribed bodies."""
        dim, free = self.dim, np.flatnonzero(self.free)
        inverse = np.zeros((len(self.arms), dim + 1, dim, dim + 1, dim))
        lever = np.einsum("de,npf->npdef", np.eye(dim), self.arms[free])
        moment = (lever - np.swapaxes(lever, 3, 4)).reshape(-1, dim, dim)
        points = np.repeat(free, (dim + 1) * dim)
        spin = self._hold_axes(self.spin_of(moment, points), points, 0.0).reshape(lever.shape)
        spin = np.where(self.held_spin[free, None, None], 0.0, spin)
        moved = np.where(self.held[free, None], 0.0, np.eye(dim)) / self.mass[free, None, None]
        inverse[free] = np.einsum("npdef,nqf->npdqe", spin, self.arms[free]) + moved[:, None, :, None]
        return inverse.reshape(-1, dim, dim + 1, dim)

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

    def _turn(self, dt: float) -> None:
        """Turn all bodies over a step.

        Those that are free to turn keep L, and turn by W of the mean of Rᵀ L R at both ends: a midpoint rule,
        which keeps the energy (Lewis & Simo 1994)."""
        guided = self.held_axes.any(axis=1)
        free = self.free & ~self.held_spin[:, 0, 0] & ~guided
        moment, of_guided, begin = self.moment[free], self.moment[guided], self.turn[guided]
        turned = np.einsum("nda,nae->nde", rotations(dt * self.spin), self.turn)
        if free.any() and self.dim == 3:
            turn, sums = self.turn[free], self.sums[free]
            begin = middle = in_axes(moment, np.swapaxes(turn, 1, 2))
            for _ in range(ITERATIONS):
                by = rotations(dt * middle / sums)
                last, middle = middle, 0.5 * (begin + in_axes(begin, np.swapaxes(by, 1, 2)))
                if np.abs(middle - last).max() <= 1e-15 * np.abs(middle).max():
                    break
            turned[free] = np.einsum("nda,nae->nde", turn, by)
        self.turn = turned @ (1.5 * np.eye(self.dim) - 0.5 * np.swapaxes(turned, 1, 2) @ turned)  # orthogonal
        if free.any():
            self.spin[free] = self.spin_of(moment, free)
        for _ in range(3 if guided.any() else 0):  # by the mean of the spins at both ends
            after = self._hold_axes(self.spin_of(of_guided, guided), guided)
            by = rotations(0.5 * dt * (self.spin[guided] + after))
            self.turn[guided] = np.einsum("nda,nae->nde", by, begin)
        self.spin[guided] = self._hold_axes(self.spin_of(of_guided, guided), guided)
        self.turned = 0.5 * float(np.vdot(self.moment[guided] - of_guided, self.spin[guided]))
        self.work += self.turned
        self.restored()
