"""Rigid bodies: each is a velocity field of dim + 1 points of mass, with its mass, centre and inertia.

The velocity anywhere on a body is affine in those of its points, with barycentric weights that never change.
Rows of contact refer to the points as to nodes of the grid, behind which they lie. What forces make of their
momenta is projected to a rigid motion, which keeps the sum and the moment. A mass of −1 marks points whose
motion is prescribed: their momentum is minus their velocity, and no force moves them.

Matrices W have W r = ω × r. With the second moment S of mass the angular momentum is L = W S + S W; along the
principal axes of S, which are the body's own axes, W_de = L_de / (s_d + s_e).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.effects.contact_moment import CONTACT_HOOKS
from mpmfw.errors import SceneError
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body, Grid, Stencil
from mpmfw.units import TimeTable

if TYPE_CHECKING:
    from mpmfw.scene.tables import RigidBody

#: Most iterations for the angular velocity in the middle of a step; about five are used.
ITERATIONS = 50


def moments_of(
    outlines: tuple[FloatArray, ...], facets: tuple[Any, ...]
) -> tuple[float, FloatArray, FloatArray]:
    """Return volume, centroid and ∫ r rᵀ about it of what closed surfaces enclose, of their simplices."""
    corners = np.concatenate([nodes[own] for nodes, own in zip(outlines, facets, strict=True)])
    dim = corners.shape[1]
    origin = corners.mean(axis=(0, 1))
    corners = corners - origin
    part = np.linalg.det(corners) / (2.0 if dim == 2 else 6.0)
    total, volume = corners.sum(axis=1), float(part.sum())
    centre = part @ total / (dim + 1) / volume
    second = np.einsum("k,kad,kae->de", part, corners, corners) + np.einsum("k,kd,ke->de", part, total, total)
    second = second / ((dim + 1) * (dim + 2)) - volume * np.outer(centre, centre)
    return volume, origin + centre, second


def simplex(dim: int) -> FloatArray:
    """Corners u of a regular simplex (dim + 1, dim): Σ u = 0, and Σ u uᵀ is dim + 1 times the unit matrix."""
    if dim == 3:
        return np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])
    angle = np.pi * np.array([1.0 / 2.0, 7.0 / 6.0, 11.0 / 6.0])
    return np.asarray(np.sqrt(2.0) * np.stack([np.cos(angle), np.sin(angle)], axis=1))


def matrix_of(omega: Any, dim: int) -> FloatArray:
    """Return W of ω, (1,) in the plane and (3,) in space."""
    x, y, z = (0.0, 0.0, omega[0]) if dim == 2 else omega
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])[:dim, :dim]


def vector_of(matrix: FloatArray) -> FloatArray:
    """Return ω (n, 1) or (n, 3) of W (n, dim, dim); of L the angular momentum."""
    entries = ((1, 0),) if matrix.shape[1] == 2 else ((2, 1), (0, 2), (1, 0))
    return np.stack([matrix[:, d, e] for d, e in entries], axis=1)


def rotations(angles: FloatArray) -> FloatArray:
    """exp(A) = 1 + sin θ / θ A + (1 − cos θ) / θ² A² of A = Δt W, (n, dim, dim)."""
    theta = np.sqrt(0.5 * np.einsum("nde,nde->n", angles, angles))[:, None, None] / np.pi
    square = np.einsum("nda,nae->nde", angles, angles)
    turned = np.eye(angles.shape[1]) + np.sinc(theta) * angles
    return np.asarray(turned + 0.5 * np.sinc(0.5 * theta) ** 2 * square)


def in_axes(matrix: FloatArray, turn: FloatArray) -> FloatArray:
    """R A Rᵀ of every body (n, dim, dim); with Rᵀ as ``turn`` Rᵀ A R."""
    return np.asarray(np.einsum("nda,nab,neb->nde", turn, matrix, turn))


class RigidBodies:
    """All rigid bodies of a scene: places, turns and motion, and what they do in a step."""

    name = "rigid"
    stage = "contact"
    history = ("centre", "turn", "velocity", "spin")

    def __init__(self, setup: Setup) -> None:
        self.state, self.dim = setup.state, setup.dim
        self.bodies = [body for body in setup.bodies if body.rigid]
        count, dim = len(self.bodies), self.dim
        models: list[RigidBody] = [setup.scene.bodies[body.name] for body in self.bodies]  # type: ignore[misc]
        self.prescribed = np.array([body.prescribed for body in self.bodies])
        self.centre, self.velocity = np.zeros((count, dim)), np.zeros((count, dim))
        self.turn, self.spin = np.zeros((count, dim, dim)), np.zeros((count, dim, dim))
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
        self.points = simplex(dim) * self.radii[:, None]  #: of mass, in the body's own axes (n, dim + 1, dim)
        self.share = np.where(self.prescribed, -1.0, self.mass / (dim + 1))[:, None, None]  #: of each point
        self.motion = [_tables(model, dim) for model in models]
        self.moves = not self.prescribed.all() or any(np.any(t.values) for each in self.motion for t in each)
        self.table: Stencil | None = None
        self.moved = False  #: in this step
        self.while_settling(None)

    def _describe(self, k: int, body: Body, model: RigidBody) -> None:
        """Take centre, axes, radii and mass of a body."""
        volume, centroid, second = moments_of(body.outlines, body.facets)
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
            self.mass[k], second = _mass(model, volume, second, body.thickness)
            self.spread[k], self.turn[k] = np.linalg.eigh(second)
            self.radii[k] = np.sqrt(self.spread[k] / self.mass[k])

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        """Return the bodies; raise SceneError where a contact cannot tell them from others."""
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
        return Acts(", ".join(body.name for body in bodies.bodies), [bodies])

    # -- where they are

    @property
    def centroid(self) -> FloatArray:
        """Centroids (n, dim) [m]."""
        return np.asarray(self.centre + np.einsum("nde,ne->nd", self.turn, self.offset))

    def restored(self) -> None:
        """Work out arms and velocities of the points of mass, (n, dim + 1, dim), from place and motion."""
        self.arms = np.einsum("nde,nje->njd", self.turn, self.points)
        self.point_velocity = self.velocity[:, None] + np.einsum("nde,nje->njd", self.spin, self.arms)

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
        """Write the sums of :func:`mpmfw.kernels.body_sums.sum_motion`, of which bodies are the last rows."""
        own = slice(len(total) - len(self.bodies), None)
        total[own], centre[own], kinetic[own] = self.mass, self.centroid, self.kinetic_energy
        mean[own] = self.velocity + np.einsum("nde,ne->nd", self.spin, self.centroid - self.centre)
        spin[own] = vector_of(self.moment)
        second[own] = in_axes(np.einsum("nd,de->nde", self.spread, np.eye(self.dim)), self.turn)

    # -- a step

    def while_settling(self, asked: Any) -> None:
        """Stand still while a scene settles; ``asked`` is None when the motion begins."""
        self.settles = asked is not None
        for k, (velocity, omega) in enumerate(self.motion):
            moves = 0.0 if self.settles else 1.0
            self.velocity[k] = moves * velocity.at(0.0)
            self.spin[k] = moves * matrix_of(omega.at(0.0), self.dim)
        self.restored()

    def own(self, nodal: FloatArray) -> FloatArray:
        """Entries of the points of mass in an array of nodes, as (n, dim + 1, dim)."""
        return nodal[len(nodal) - self.points[..., 0].size :].reshape(self.points.shape)

    def with_points(self, plain: Stencil) -> Stencil:
        """Return the table ``plain`` of the surface nodes on the grid with rows of those of rigid bodies."""
        grid, each, end = self.state.grid, self.dim + 1, int(plain.row[-1])
        size = end + len(self.weight)
        if self.table is None or self.table.room < size:
            nodes, row = (
                np.zeros(2 * size, dtype=np.int32),
                np.zeros(len(plain.row) + len(self.place), np.int64),
            )
            self.table = Stencil(row, nodes, np.zeros(2 * size), np.zeros((0, self.dim)))
        row, nodes, weight, _ = self.table.kernel_arrays
        row[: len(plain.row)] = plain.row
        row[len(plain.row) :] = end + each * np.arange(1, len(self.place) + 1)
        nodes[:end], weight[:end] = plain.nodes[:end], plain.weight[:end]
        first = int(grid.offset[-1]) - each * len(self.bodies)
        nodes[end:size] = (first + each * self.owner[:, None] + np.arange(each)).ravel()
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
        grid.mass[-len(self.bodies) * (self.dim + 1) :] = np.repeat(self.share, self.dim + 1)
        self.own(grid.position)[...] = self.centre[:, None] + self.arms
        self.own(grid.start_velocity)[...] = self.point_velocity

    @hookimpl(tryfirst=True)
    def after_momentum_projection(self, grid: Grid, dt: float) -> None:
        """Take the prescribed velocities, which are means over the step of ``dt`` [s]."""
        if self.settles or not self.moves:
            return
        for k in np.flatnonzero(self.prescribed):
            velocity, omega = (_mean(table, self.state.time, dt) for table in self.motion[k])
            self.velocity[k], self.spin[k] = velocity, matrix_of(omega, self.dim)
        self.restored()
        self._write_momentum(grid)

    @hookimpl(tryfirst=True)
    def after_momentum_update(self, grid: Grid) -> None:
        """Take back what contact has done to points whose motion is prescribed."""
        own = self.own(grid.momentum)
        own[self.prescribed] = -self.point_velocity[self.prescribed]

    @hookimpl(trylast=True)
    def constrain_momentum(self, grid: Grid) -> None:
        """Project the momenta to rigid motions, and keep the prescribed ones; MUSL's second moves nothing."""
        if not self.moved:
            self._read_motion(self.own(grid.momentum))
        self._write_momentum(grid)

    def _read_motion(self, momentum: FloatArray) -> None:
        """Take the motion of free bodies that has the sum and the moment of their points' ``momentum``."""
        free = ~self.prescribed
        if not free.any():
            return
        self.velocity[free] = momentum[free].sum(axis=1) / self.mass[free, None]
        lever = np.einsum("njd,nje->nde", momentum[free], self.arms[free])
        self.spin[free] = self._spin_of(lever - np.swapaxes(lever, 1, 2), free)
        self.restored()

    def _spin_of(self, moment: FloatArray, free: Any) -> FloatArray:
        """W of L, (n, dim, dim), of ``free`` bodies."""
        spread = self.spread[free]
        own = in_axes(moment, np.swapaxes(self.turn[free], 1, 2))
        return in_axes(own / (spread[:, :, None] + spread[:, None, :]), self.turn[free])

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
        surface.position[nodes] = new

    def _turn(self, dt: float) -> None:
        """Turn all bodies over a step.

        Free ones keep L, and turn by W of the mean of Rᵀ L R at both ends: a midpoint rule, which keeps the
        energy (Lewis & Simo 1994)."""
        free, moment = ~self.prescribed, self.moment[~self.prescribed]
        turned = np.einsum("nda,nae->nde", rotations(dt * self.spin), self.turn)
        if free.any() and self.dim == 3:
            turn, spread = self.turn[free], self.spread[free]
            begin = middle = in_axes(moment, np.swapaxes(turn, 1, 2))
            for _ in range(ITERATIONS):
                by = rotations(dt * middle / (spread[:, :, None] + spread[:, None, :]))
                last, middle = middle, 0.5 * (begin + in_axes(begin, np.swapaxes(by, 1, 2)))
                if np.abs(middle - last).max() <= 1e-15 * np.abs(middle).max():
                    break
            turned[free] = np.einsum("nda,nae->nde", turn, by)
        self.turn = turned
        if free.any():
            self.spin[free] = self._spin_of(moment, free)
        self.restored()


def _mass(model: RigidBody, volume: float, second: FloatArray, thickness: float) -> tuple[float, FloatArray]:
    """Return mass and second moment of a free body by its table, from those of its region."""
    rigid: Any = model.rigid
    if rigid.density is not None:
        density = rigid.density * thickness
        return density * volume, density * second
    if len(second) == 2:
        return rigid.mass, second * rigid.inertia / np.trace(second)
    principal = np.array(rigid.inertia)
    return rigid.mass, np.diag(0.5 * principal.sum() - principal)


def _tables(model: RigidBody, dim: int) -> tuple[TimeTable, TimeTable]:
    """Return v and ω over time, prescribed ones or those of the start; 0 where there are none."""
    motion = None if isinstance(model.rigid, bool) else model.rigid.motion
    v, omega = (getattr(motion or model, key) for key in ("velocity", "angular_velocity"))
    axes = 1 if dim == 2 else 3
    return TimeTable.of((0.0,) * dim if v is None else v), TimeTable.of(
        (0.0,) * axes if omega is None else omega
    )


def _mean(table: TimeTable, time: float, dt: float) -> FloatArray:
    """Return the mean of a table from ``time`` over ``dt`` [s]."""
    if len(table.times) == 1 or dt == 0.0:
        return table.at(time)
    within = table.times[(table.times > time) & (table.times < time + dt)]
    times = np.array([time, *within, time + dt])
    values = np.array([table.at(each) for each in times])
    return np.asarray(np.diff(times) @ (0.5 * (values[1:] + values[:-1])) / (times[-1] - times[0]))
