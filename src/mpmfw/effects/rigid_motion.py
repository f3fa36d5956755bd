"""Motion of rigid bodies as masses on dim + 1 points each: place, turn, velocity and spin, and their inertia.

Matrices W have W r = ω × r. With the second moment S of mass the angular momentum is L = W S + S W; along the
principal axes of S, which are the body's own axes, W_de = L_de / (s_d + s_e).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.effects.rigid_kinematics import (
    in_axes,
    mass_of,
    matrix_of,
    rotations,
    simplex,
    tables_of,
    vector_of,
)
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body
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


class RigidMotion:
    """Places, turns and motion of all rigid bodies of a scene, whose points of mass are regular simplices."""

    history: tuple[str, ...] = ("centre", "turn", "velocity", "spin", "belt", "work")

    def __init__(self, setup: Setup) -> None:
        """Take all rigid bodies as the scene has them, at rest."""
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
        self.far = np.where(self.held_spin[:, 0, 0], FAR, 1.0)  #: (n,)
        self.work = 0.0  #: of what holds them, on free bodies [J/m]
        self.turned = 0.0  #: of it that of this step's torques, which keep spins as bodies turn
        #: whether part of a free body's motion is held
        self.holds = bool(self.held.any() or self.held_spin.any() or self.held_axes.any())
        self.mass = np.zeros(count)  #: (n,) [kg/m]; 0 where the motion is prescribed
        self.volume = np.zeros(count)  #: (n,) of free bodies, times the thickness [m^dim]
        self.spread = np.zeros((count, dim))  #: (n, dim) Σ m x_k² along the body's own axes
        self.radii = np.zeros((count, dim))  #: of gyration, which the points of mass have [m]
        self.offset = np.zeros((count, dim))  #: (n, dim) of the centroid, in the body's own axes [m]
        for k, (body, model) in enumerate(zip(self.bodies, models, strict=True)):
            self._describe(k, body, model)
        self.sums = self.spread[:, :, None] + self.spread[:, None, :]  #: s_d + s_e (n, dim, dim)
        self.sums[self.sums == 0.0] = np.inf  # no spin is of one axis
        self.points = simplex(dim) * self.radii[:, None]  #: of mass, in the body's own axes (n, dim + 1, dim)
        self.share = np.where(self.prescribed, -1.0, self.mass / (dim + 1))[:, None, None]  #: of each point
        self.motion = [tables_of(model, dim) for model in models]

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
            self.volume[k] = volume * thickness
            self.mass[k], own = mass_of(model, volume, second, thickness)
            spread, self.turn[k] = np.linalg.eigh(own)
            flat = spread < FLAT * spread.max()
            self.spread[k] = np.where(flat, 0.0, spread)
            shape = np.diag(self.turn[k].T @ second @ self.turn[k]) / volume
            squares = np.where(flat, shape, self.spread[k] / self.mass[k])  # a flat one's are of its shape
            self.radii[k] = np.sqrt(squares) * self.far[k]

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

    def weights_at(self, body: int, position: FloatArray) -> FloatArray:
        """Weights of the points of mass of rigid body ``body``, from 0, at a ``position`` (n, dim) [m]."""
        own = (position - self.centre[body]) @ self.turn[body]
        return np.asarray((1.0 + (own / self.radii[body]) @ simplex(self.dim).T) / (self.dim + 1))

    def while_settling(self, asked: Any) -> None:
        """Stand still while a scene settles; ``asked`` is None when the motion begins."""
        self.settles = asked is not None
        for k, (velocity, omega, belt) in enumerate(self.motion):
            moves = 0.0 if self.settles else 1.0
            self.velocity[k], self.belt[k] = moves * velocity.at(0.0), moves * belt.at(0.0)
            self.spin[k] = moves * matrix_of(omega.at(0.0), self.dim)
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
            first = middle = in_axes(moment, np.swapaxes(turn, 1, 2))
            for _ in range(ITERATIONS):
                by = rotations(dt * middle / sums)
                last, middle = middle, 0.5 * (first + in_axes(first, np.swapaxes(by, 1, 2)))
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
