"""Detection at grid nodes: those that two bodies share, with the normal of their volume gradients; in 2D and
3D.

Multiple velocity fields: Bardenhagen, Brackbill & Sulsky (2000), Bardenhagen et al. (2001).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from mpmfw.contact.rows import ContactRows, Detection
from mpmfw.contact.shared_nodes import (
    GridNodes,
    NodePairs,
    find_shared_nodes,
    mark_nodes,
    project_position,
    project_volume_gradient,
    room_for,
    write_rows,
)
from mpmfw.contact.strategy import stiffness_ranks
from mpmfw.errors import SceneError
from mpmfw.plugin.base import OptionsModel
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import FloatArray, IntArray
from mpmfw.state.structs import Grid, Particles, State, Stencil

if TYPE_CHECKING:
    from mpmfw.contact.rigid_nodes import NearRigid

#: Share of a full cell's mass that both bodies must have where a force acts: less only accelerates.
LEAST_MASS = 0.05


class NodesOptions(OptionsModel):
    criterion: Literal["auto", "velocity", "position"] = Field(
        "auto",
        description="velocity: bodies approach at a shared node (2000, 2001); position: and their "
        "extrapolated positions are closer than the cut-off; auto: position where the law needs a gap, else "
        "velocity",
    )
    cut_off: float = Field(
        0.8, gt=0, description="separation in cells below which bodies touch (criterion = position)"
    )
    normal: Literal["averaged", "master", "specified"] = Field(
        "averaged",
        description="averaged of the pair, the stiffer body's (of equals the larger volume gradient at a "
        "node), or given by `direction`",
    )
    direction: tuple[float, ...] | None = Field(
        None, description="unit vector out of a pair's first body (normal = specified)"
    )

    @model_validator(mode="after")
    def _options_have_an_effect(self) -> NodesOptions:
        if "cut_off" in self.model_fields_set and self.criterion == "velocity":
            raise ValueError(
                '\'cut_off\' has no effect with criterion = "velocity"; expected criterion = "position"'
            )
        if (self.direction is not None) != (self.normal == "specified"):
            raise ValueError("'direction' and normal = \"specified\" go together")
        if self.direction is not None and not np.isclose(np.linalg.norm(self.direction), 1.0):
            raise ValueError("'direction' must have length 1")
        return self


class AtNodes(Detection):
    """Base of detections at grid nodes with mass of both bodies of a pair: rows are v_a − v_b."""

    #: Whether forces act on the rows, which need nodes that have some mass.
    forces = False
    has_radius, mean_radius = True, 1.0 / 3.0
    mean_gaps = selects_pairs = True
    #: What is projected on the nodes: volume gradients, and mean positions.
    projects_gradient = True
    projects_mean = False
    #: Separation of the mean positions below which bodies touch [m].
    cut_off: float = np.inf
    #: Surfaces of rigid bodies; None without any.
    rigid: Any = None
    #: Rows of nodes that two bodies share, the first ones; those against rigid bodies follow.
    shared_rows = 0

    def prepare(self, setup: Setup, owner: str) -> None:
        """Take the bodies of the pairs, and the least mass of a node."""
        self.state, self.owner = setup.state, owner
        self.given = np.zeros(setup.dim)  #: direction that takes the normals' place, if it is one
        full_mass = min(body.areal_density for body in setup.bodies) * setup.cell_size**setup.dim
        if (grid := setup.state.grid).axisymmetric:
            full_mass *= grid.around(min(body.lower[0] for body in setup.state.soft_bodies))
        self.least_mass = LEAST_MASS * full_mass if self.forces else 0.0
        self.shared = room_for(64)
        self.grid: GridNodes | None = None
        self.list_pairs(setup.state)
        if setup.state.rigid is not None:
            from mpmfw.contact.rigid_nodes import RigidSurfaces

            self.rigid = RigidSurfaces(setup.state)

    def weights(self, state: State) -> tuple[FloatArray, FloatArray]:
        """Return the weights of both bodies' volume gradients in the normal, (pair,) each."""
        ones = np.ones(len(state.pairs))
        return ones, ones

    def list_pairs(self, state: State) -> None:
        first, second = np.ascontiguousarray(state.pair_bodies.T)
        weight_first, weight_second = self.weights(state)
        self.pairs = NodePairs(
            first=first, second=second, weight_first=weight_first, weight_second=weight_second
        )

    def radii(self, rows: ContactRows, grid: Grid) -> FloatArray:
        return np.asarray(grid.position[rows.dof[rows.start[: rows.count]], 0])

    def nodes_of(self, grid: Grid) -> GridNodes:
        """Return the grid's arrays and those projected on it, new with its windows."""
        if self.grid is not None and self.grid.mass is grid.mass:
            return self.grid
        empty = np.zeros((0, grid.dim))
        several = self.projects_gradient and len(self.state.soft_bodies) > 2
        self.grid = GridNodes(
            window_lower=grid.window_lower, window_shape=grid.window_shape, offset=grid.offset,
            nodes=grid.nodes, mass=grid.mass, start_velocity=grid.start_velocity,
            shared=np.zeros(len(grid.mass), dtype=bool),
            last_row=np.zeros(len(grid.mass) if several else 0, dtype=np.int64),
            gradient=np.zeros_like(grid.momentum) if self.projects_gradient else empty,
            mean=np.zeros_like(grid.momentum) if self.projects_mean or several else empty,
        )  # fmt: skip
        self.on_axis = np.flatnonzero(grid.on_axis(grid.position))
        for name, array in (("volume_gradient", self.grid.gradient), ("mean_position", self.grid.mean)):
            if len(array):
                self.state.arrays[f"{self.owner}/{name}"] = array
        return self.grid

    @property
    def gradient(self) -> FloatArray:
        """Volume gradients at shared nodes, Σ V ∇φ (n_nodes, dim) [m^(dim−1)]."""
        assert self.grid is not None
        return self.grid.gradient

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:
        """Find the shared nodes, project on them, and write the rows."""
        nodes, rows.count = self.nodes_of(grid), 0
        listed = find_shared_nodes(self.pairs, nodes, self.shared)
        if listed > len(self.shared.pair):
            self.shared = room_for(2 * listed)
            find_shared_nodes(self.pairs, nodes, self.shared)
        if self.acts_on is not None:
            chosen = np.flatnonzero(self.acting(self.state)[self.shared.pair[:listed]])
            listed = len(chosen)
            for array in (self.shared.pair, self.shared.first, self.shared.second):
                array[:listed] = array[chosen]
        near = [] if self.rigid is None else self.rigid.find(grid, self.least_mass, self.acts_on)
        if listed == 0 and not near:
            return
        three = mark_nodes(listed, self.shared, nodes)
        for each in near:
            nodes.shared[each.nodes] = True
        if len(nodes.gradient):
            project_volume_gradient(phi, particles, nodes, grid.spacing)
            nodes.gradient[self.on_axis, 0] = 0.0  # of both halves
        if self.projects_mean or three:
            project_position(phi, particles, nodes, grid.spacing)
        more = sum(len(each.nodes) for each in near)
        if len(rows.pair) < listed + more or len(rows.dof) < 2 * listed + (grid.dim + 2) * more:
            rows.make_room(2 * (listed + more), 2 * (2 * listed + (grid.dim + 2) * more))
        rows.count = self.shared_rows = self.write(listed, grid, phi, particles, rows)
        for each in near:
            self.write_rigid(each, grid, particles, rows)

    def write_rigid(self, near: NearRigid, grid: Grid, particles: Particles, rows: ContactRows) -> None:  # noqa: ARG002
        """Append rows of nodes near a rigid body; where gaps are measured, those of their mean positions."""
        mean = self.nodes_of(grid).mean if self.projects_mean else np.zeros((0, grid.dim))
        self.rigid.write(near, grid, rows, mean, 0.5 * self.cut_off, self.area_across)

    def area_across(self, nodes: IntArray, normal: FloatArray) -> FloatArray:
        """Area of the body of ``nodes`` (n,) across the ``normal`` (n, dim) of another body [m^(dim−1)]."""
        if not self.projects_gradient:
            return np.zeros(len(nodes))
        return np.asarray(np.maximum(-np.einsum("nd,nd->n", self.gradient[nodes], normal), 0.0))

    def write(self, listed: int, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> int:  # noqa: ARG002
        """Write rows of ``listed`` shared nodes where bodies are near; return their number."""
        return write_rows(
            listed, self.shared, self.pairs, self.nodes_of(grid), self.given, self.cut_off, self.least_mass,
            self.state.dt, rows, grid.spacing,
        )  # fmt: skip


class Nodes(AtNodes):
    """Rows by the normal of the volume gradients, or by the given one."""

    name = "nodes"
    Options = NodesOptions
    options: NodesOptions
    #: Bias of the normals; None if every normal belongs to one body, or is given.
    bias: Any = None

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.by_position = self.options.criterion == "position"
        self.measures_area = self.options.normal != "specified"

    def configure(self, needs: frozenset[str], *, forces: bool) -> None:
        """Measure the gap by positions if needed; raise SceneError if options measure none."""
        self.forces = forces
        if "gap" in needs and self.options.criterion == "velocity":
            raise SceneError(
                "detection 'nodes' with criterion = \"velocity\" measures no gap, which the law needs; "
                'expected "position"'
            )
        if forces and not self.measures_area:
            raise SceneError(
                "detection 'nodes' with normal = \"specified\" measures no area, which the law needs; "
                'expected "averaged" or "master"'
            )
        self.by_position = self.by_position or "gap" in needs
        if "cut_off" in self.options.model_fields_set and not self.by_position:
            raise SceneError(
                "detection 'nodes': 'cut_off' has no effect with the criterion of velocity, which auto is "
                'with this law; expected criterion = "position"'
            )

    def range(self, cell_size: float) -> float | None:  # noqa: ARG002
        """Return 0 beyond the cut-off, which gaps count from; None where none is measured."""
        return 0.0 if self.by_position else None

    def prepare(self, setup: Setup, owner: str) -> None:
        """Take the direction, the cut-off, and the pairs' bodies."""
        direction = self.options.direction
        if direction is not None and len(direction) != setup.dim:
            raise SceneError(
                f"expected {setup.dim} components, found {len(direction)}", key=f"contact.{owner}.direction"
            )
        self.bias = None  # of an earlier run
        super().prepare(setup, owner)
        if direction is not None:
            self.given = np.array(direction)
        if self.by_position:
            self.cut_off = self.options.cut_off * setup.cell_size
        self.projects_gradient = self.measures_area
        self.projects_mean = self.by_position
        soft = setup.state.soft_bodies
        # Of two alike the master changes from node to node. Of more some may rest on each other, as tiles do,
        # and normals that lean there slow nothing down
        changes = len(soft) == 2 and self.measures_area and len(np.unique(stiffness_ranks(soft))) == 1
        if self.options.normal == "averaged" or changes:
            from mpmfw.contact.normal_bias import NormalBias

            self.bias = NormalBias(setup, owner)

    def list_pairs(self, state: State) -> None:
        super().list_pairs(state)
        if self.bias:
            self.bias.add_pairs(state)

    def note_forces(self, rows: ContactRows, scale: float) -> None:
        if self.bias and self.shared_rows:
            self.bias.add(rows, self.shared_rows, scale, self.gradient, self.state.grid.spacing)

    def restart(self) -> None:
        if self.bias:
            self.bias.restart()

    def remarks(self) -> list[str]:
        advice = 'normal = "master" for a flat body that is the stiffer, or "specified"'
        if not self.by_position:
            advice += ', criterion = "position" for round bodies'
        return self.bias.remarks(self.state.pairs, advice) if self.bias else []

    def weights(self, state: State) -> tuple[FloatArray, FloatArray]:
        """Return 1 for both, or with ``master`` for the stiffer; 0 for equals."""
        if self.options.normal != "master":
            return super().weights(state)
        ranks, (first, second) = stiffness_ranks(state.bodies), state.pair_bodies.T
        stiffer = ranks[first] - ranks[second]
        return np.where(stiffer > 0, 1.0, 0.0), np.where(stiffer < 0, 1.0, 0.0)
