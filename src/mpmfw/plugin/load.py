"""Loads and boundary conditions that a scene names: forces on material points, tractions on surfaces, and
motion prescribed by time and place."""

from __future__ import annotations

import functools
import math
from typing import Self

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.facets import area_vector, read_corners
from mpmfw.kernels.types import Floats, Ints, Table
from mpmfw.plugin.base import NamedPlugIn
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, FloatArray, IntArray
from mpmfw.state.history import IndexMap
from mpmfw.state.structs import Grid, Particles, State, Stencil
from mpmfw.state.surface import nodes_left


@kernel
def add_point_forces(begin: int, table: Table, force: Floats, node_force: Floats) -> None:
    """f_i += Σ φ_ip f_p over the points from ``begin`` on."""
    for q in range(len(force)):
        for k in range(table.row[begin + q], table.row[begin + q + 1]):
            for d in range(force.shape[1]):
                node_force[table.nodes[k], d] += table.weight[k] * force[q, d]


@kernel
def measure_facets(
    which: Ints, facets: Ints, position: Floats, centre: Floats, normal: Floats, area: Floats,
    spacing: tuple[float, ...]
) -> None:  # fmt: skip
    """Centre [m], outward unit normal and area [m^(dim−1)] of facets."""
    dim = len(spacing)
    corners, vector = scratch.matrix(spacing, spacing), scratch.vector(spacing)
    share = 1.0 if dim == 2 else 0.5  # the area vector of a triangle is twice its area
    for q in range(len(which)):
        read_corners(which[q], position, facets, corners, spacing)
        area_vector(corners, vector, spacing)
        square = 0.0
        for d in range(dim):
            square += vector[d] * vector[d]
        length = math.sqrt(square)
        area[q] = share * length
        for d in range(dim):
            normal[q, d] = vector[d] / length if length > 0.0 else 0.0
            centre[q, d] = 0.0
            for a in range(dim):
                centre[q, d] += corners[a, d] / dim


@kernel
def add_facet_forces(
    which: Ints, force: Floats, facets: Ints, table: Table, node_force: Floats, share: Floats | None = None
) -> None:
    """f_i += f_m / dim N_i(x_s) from every corner of the facets (eq. 11 of [H17]).

    Of bodies of revolution a corner a has the ``share`` (n, dim) of f_m."""
    dim = force.shape[1]
    for q in range(len(which)):
        for a in range(dim):
            node = facets[which[q], a]
            for k in range(table.row[node], table.row[node + 1]):
                for d in range(dim):
                    if share is None:
                        node_force[table.nodes[k], d] += table.weight[k] * force[q, d] / dim
                    else:
                        node_force[table.nodes[k], d] += table.weight[k] * force[q, d] * share[q, a]


@kernel
def project_mass(which: Ints, table: Table, mass: Floats, node_mass: Floats) -> None:
    """m_i = Σ φ_ip m_p of some points alone."""
    node_mass[:] = 0.0
    for p in which:
        for k in range(table.row[p], table.row[p + 1]):
            node_mass[table.nodes[k]] += table.weight[k] * mass[p]


class Load(NamedPlugIn):
    """Base of :class:`BodyLoad` and :class:`SurfaceLoad`, one instance for each table ``[loads.NAME]``.

    One that depends on the velocity may implement the hook ``stable_timestep``.
    """

    history = ("work",)
    work = 0.0  #: on the bodies so far [J/m]

    @property
    def ledger_term(self) -> tuple[str, str]:
        """Term of the energy ledger, and what does the work."""
        return "external", f"load '{self.title}'"

    def copy_history(self, other: Load, index_map: IndexMap) -> None:  # noqa: ARG002
        """Take the work of the same load in another simulation."""
        self.work, other.work = self.work + other.work, 0.0


class BodyLoad(Load):
    """Base of loads on material points: :meth:`forces`."""

    def forces(self, particles: Particles, own: slice, time: float) -> FloatArray:
        """Return the force on each of a body's points ``own``, (n, dim) [N], at a ``time`` [s].

        ``particles`` are all points at the beginning of the step; they may not be changed. Those of a free
        rigid body are dim + 1 points with its mass and inertia."""
        raise NotImplementedError

    @hookimpl
    def add_nodal_force(self, grid: Grid, state: State, phi: Stencil, dt: float) -> None:
        """f_i += Σ φ_ip f_p: sum and power are those of the points."""
        self._impulses = []
        for body in self.bodies:
            points = state.rigid.particles_of(body) if body.rigid else state.particles
            own = slice(0, points.count) if body.rigid else body.particles
            shape = (own.stop - own.start, state.grid.dim)
            force = self.checked(self.forces(points, own, state.time), shape, state)
            if body.rigid:
                state.rigid.add_forces(body, force, grid.force)
            else:
                add_point_forces(own.start, phi, force, grid.force)
            self._impulses.append((body, points.velocity, dt * force))

    @hookimpl
    def end_step(self, state: State) -> None:
        """Count the works; on a rigid body those on the mean of the motions before and after the step."""
        for body, begin, impulse in self._impulses:
            if body.rigid:
                velocity = 0.5 * (begin + state.rigid.particles_of(body).velocity)
            else:
                velocity = state.particles.velocity[body.particles]
            self.work += float(np.vdot(impulse, velocity))


class LoadedFacets:
    """The facets that a surface load acts on, at the beginning of a step."""

    def __init__(self, state: State, which: IntArray) -> None:
        """Measure the facets ``which`` (n,) of all surfaces."""
        surface, dim = state.tracked_surface, state.grid.dim
        self._state, self._which = state, which
        self.position = np.empty((len(which), dim))  #: their centres [m]
        self.normal = np.empty((len(which), dim))  #: outward unit normals
        #: [m²], in the plane times the body's thickness; 0 where nodes have left their points
        self.area = np.empty(len(which))
        measure_facets(
            which, surface.facets, surface.position, self.position, self.normal, self.area, state.grid.spacing
        )
        #: (n, 2) of the corners in the force on a facet, ∫ r N_a / ∫ r; None where they have equal shares
        self.share: FloatArray | None = None
        if state.grid.axisymmetric:
            radius = surface.position[surface.facets[which], 0]
            self.area *= 2.0 * np.pi * self.position[:, 0]
            self.share = (radius + radius.sum(axis=1)[:, None]) / (6.0 * self.position[:, :1])
        elif state.particles.thickness is not None:
            thickness = np.array([body.thickness for body in state.bodies])
            self.area *= thickness[surface.body[surface.facets[which, 0]]]
        self.area[nodes_left(surface)[surface.facets[which]].any(axis=1)] = 0.0

    @functools.cached_property
    def velocity(self) -> FloatArray:
        """Mean velocity of the corners (n, dim) [m/s], before this step's forces."""
        surface, grid = self._state.tracked_surface, self._state.grid
        phi = surface.table
        moving = phi.weight[:, None] * grid.start_velocity[phi.nodes]
        at_nodes = np.add.reduceat(moving, phi.row[:-1])
        return np.asarray(at_nodes[surface.facets[self._which]].mean(axis=1))


class SurfaceLoad(Load):
    """Base of loads on surfaces: :meth:`traction`."""

    needs_surface = True
    #: Facets that it acts on, of all surfaces: (n,).
    facets: IntArray

    def from_setup(self, setup: Setup) -> Self | str:
        own = [setup.state.tracked_surface.facets_of(body.index) for body in self.bodies]
        self.facets = np.concatenate([np.arange(each.start, each.stop) for each in own])
        return self

    def traction(self, facets: LoadedFacets, time: float) -> FloatArray:
        """Return the force on each of the ``facets`` by its area, (n, dim) [Pa]."""
        raise NotImplementedError

    @hookimpl
    def add_nodal_force(self, grid: Grid, state: State) -> None:
        """Map tractions as contact forces (eq. 11 of [H17])."""
        surface, loaded = state.tracked_surface, LoadedFacets(state, self.facets)
        shape = (len(self.facets), state.grid.dim)
        force = loaded.area[:, None] * self.checked(self.traction(loaded, state.time), shape, state)
        add_facet_forces(self.facets, force, surface.facets, surface.table, grid.force, loaded.share)
        self._force, self._share = force, loaded.share

    @hookimpl
    def end_step(self, state: State) -> None:
        surface = state.tracked_surface
        motion = surface.displacement[surface.facets[self.facets]]
        motion = motion.mean(axis=1) if self._share is None else np.einsum("qa,qad->qd", self._share, motion)
        self.work += float(np.vdot(self._force, motion))


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
        """Find the held points; refuse an empty set, and a shared velocity field."""
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
        self.left = self.calls


def shares_near(position: FloatArray, at: FloatArray, cell_size: float) -> FloatArray:
    """Return shares w_p (n,) of points in the value at a place: Σ w_p = 1, Σ w_p x_p = x (moving least
    squares).

    w_p = k_p (a + b·r_p), r_p = x_p − x, with a kernel k_p that falls to zero 1.5 cells beyond the nearest
    point: fewer would not reach a corner. ``position`` x_p is (n, dim), ``at`` x (dim,), ``cell_size`` h, in
    m. Raise ValueError if no point is within a cell of the place."""
    offset = position - at
    distance = np.sqrt((offset**2).sum(axis=1)) / cell_size
    if distance.min() > 1.0:
        raise ValueError(f"the nearest material point is {distance.min():.3g} cells away")
    kernel = np.maximum(1.0 - distance / (distance.min() + 1.5), 0.0)
    basis = np.column_stack([np.ones(len(offset)), offset])
    target = np.zeros(basis.shape[1])
    target[0] = 1.0
    moments = basis.T @ (kernel[:, None] * basis)
    return np.asarray(kernel * (basis @ np.linalg.lstsq(moments, target, rcond=None)[0]))
