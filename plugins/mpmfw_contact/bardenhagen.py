"""Contact of multiple velocity fields (Bardenhagen, Brackbill & Sulsky 2000; Bardenhagen et al. 2001)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from mpmfw.api import (
    AnyArray,
    ContactStrategy,
    FloatArray,
    Grid,
    Particles,
    SceneError,
    Setup,
    State,
    Stencil,
    hookimpl,
)
from mpmfw.api import Field as ArrayField
from mpmfw_contact import _shared_nodes as shared
from mpmfw_contact.records import PairRecords

if TYPE_CHECKING:
    from mpmfw_contact._leaning import LeaningNormals

NODAL = (
    ArrayField(
        "volume_gradient", ("node", "axis"), "m", "sum V_p grad phi_ip, points out of the body", "grid"
    ),
    ArrayField(
        "mean_position",
        ("node", "axis"),
        "m",
        "sum phi m x / m, the body's position as seen by the node",
        "grid",
    ),
)


class BardenhagenOptions(BaseModel):
    """Criterion of contact and kind of normal."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    criterion: Literal["velocity", "position"] = Field(
        "velocity",
        description="velocity: bodies approach at a shared node (2000, 2001); position: and their extrapolated "
        "positions are closer than the cut-off",
    )
    cut_off: float = Field(
        0.8, gt=0, description="separation in cells below which bodies touch (criterion = position)"
    )
    normal: Literal["averaged", "master", "specified"] = Field(
        "averaged", description="averaged of the pair, the stiffer body's, or given by `direction`"
    )
    direction: tuple[float, ...] | None = Field(
        None, description="unit vector out of a pair's first body (normal = specified)"
    )

    @model_validator(mode="after")
    def _options_have_an_effect(self) -> BardenhagenOptions:
        if "cut_off" in self.model_fields_set and self.criterion != "position":
            raise ValueError(
                '\'cut_off\' has no effect with criterion = "velocity"; expected criterion = "position"'
            )
        if (self.direction is not None) != (self.normal == "specified"):
            raise ValueError("'direction' and normal = \"specified\" go together")
        if self.direction is not None and not np.isclose(np.linalg.norm(self.direction), 1.0):
            raise ValueError("'direction' must have length 1")
        return self


class Bardenhagen(ContactStrategy):
    """Momentum exchange at grid nodes that two bodies share, with Coulomb friction.

    At a shared node with approaching bodies the relative velocity along the normal is taken away, and the
    tangential one as far as Coulomb's cone lets it. Both the projected and the updated momentum are
    corrected. Where one body touches several others at a node, its mass is shared out between them and all
    corrections are taken from the same velocities, so that the order of the bodies does not matter.
    """

    name = "bardenhagen"
    Options = BardenhagenOptions
    options: BardenhagenOptions
    velocity_fields = "per_body"
    uses_friction = True
    stage = "contact"

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.leaning: LeaningNormals | None = None
        if self.options.normal == "averaged":
            from mpmfw_contact._leaning import LeaningNormals

            self.leaning = LeaningNormals(self)

    def parts(self) -> list[Any]:
        """What follows averaged normals; the other kinds lean on one body alone."""
        return [] if self.leaning is None else [self.leaning]

    @hookimpl
    def declare_fields(self) -> list[ArrayField]:
        """Nodal arrays and the pairs' series."""
        arrays = NODAL if self.options.criterion == "position" else NODAL[:1]
        own = (
            []
            if self.options.normal == "specified" and self.options.criterion == "velocity"
            else list(arrays)
        )
        return [*own, *PairRecords.declarations()]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Laws of the pairs as arrays."""
        direction = self.options.direction
        if direction is not None and len(direction) != setup.dim:
            raise SceneError(
                f"contact.bardenhagen.direction: expected {setup.dim} components, found {len(direction)}"
            )
        self.state = setup.state
        self.records = PairRecords(setup, self.name)
        self._list_pairs()
        self.given_normal = np.array(direction if direction is not None else [0.0] * setup.dim)
        self.cut_off = (
            self.options.cut_off * setup.cell_size if self.options.criterion == "position" else np.inf
        )
        self.contacts = shared.empty_contacts(64, setup.dim)
        self.frame = -1

    @hookimpl
    def add_pairs(self, state: State) -> None:
        """Laws and records of bodies that have come near."""
        self._list_pairs()
        self.records.add_pairs(state)

    def _list_pairs(self) -> None:
        """Bodies, friction and weights of the normals of all pairs."""
        bodies, pairs = self.state.bodies, self.state.pairs
        self.first = np.array([pair.first for pair in pairs], dtype=np.int64)
        self.second = np.array([pair.second for pair in pairs], dtype=np.int64)
        self.friction = np.array([pair.friction for pair in pairs], dtype=float)
        # The normal is w_a g_a − w_b g_b of the outward gradients g: both, or the stiffer body's alone.
        stiffer_second = np.array(
            [bodies[p.second].p_wave_modulus > bodies[p.first].p_wave_modulus for p in pairs], dtype=bool
        )
        averaged = self.options.normal == "averaged"
        self.weight_first = np.where(averaged | ~stiffer_second, 1.0, 0.0)
        self.weight_second = np.where(averaged | stiffer_second, 1.0, 0.0)

    def _fit(self, grid: Grid) -> None:
        """Fit the nodal arrays to the windows whenever these were laid anew."""
        if self.frame == grid.frame:
            return
        self.frame = grid.frame
        empty = np.zeros((0, grid.dim))
        self.gradient: FloatArray = (
            np.zeros_like(grid.momentum) if self.options.normal != "specified" else empty
        )
        self.mean: FloatArray = (
            np.zeros_like(grid.momentum) if self.options.criterion == "position" else empty
        )
        self.sharers = np.zeros(len(grid.mass))
        for name, array in (
            ("volume_gradient", self.gradient),
            ("mean_position", self.mean),
            ("sharers", self.sharers),
        ):
            if len(array):
                self.state.arrays[f"{self.name}/{name}"] = array

    @hookimpl
    def after_momentum_projection(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """Find the shared nodes and their normals; correct the projected momentum."""
        self._fit(grid)
        count = self._find(grid)
        if count:
            self._normals(grid, phi, particles, count)
            self._correct(grid, count, projected=True)
            self._record(grid, count)
        self.count = count

    @hookimpl
    def after_momentum_update(self, grid: Grid) -> None:
        """Correct the updated momentum at the same nodes, with the same normals."""
        if self.count:
            self._correct(grid, self.count, projected=False)
            self._record(grid, self.count)
        else:
            self.records.count.fill(0.0)

    @hookimpl
    def after_second_projection(self, grid: Grid) -> None:
        """Correct MUSL's second momentum, from which the strain is taken, at the same nodes, with the same normals.

        Else bodies that no longer approach are strained as if they did, and what the strain takes up has no work
        against it. No point moves with this momentum: its impulse and work are in no record.
        """
        if self.count:
            self._correct(grid, self.count, projected=False)

    def _find(self, grid: Grid) -> int:
        arguments = (self.first, self.second, grid.window_lower, grid.window_shape, grid.offset, grid.mass)
        count = shared.find_shared_nodes(
            *arguments, self.contacts.pair, self.contacts.node_a, self.contacts.node_b
        )
        if count > len(self.contacts.pair):
            self.contacts = shared.empty_contacts(2 * count, grid.dim)
            shared.find_shared_nodes(
                *arguments, self.contacts.pair, self.contacts.node_a, self.contacts.node_b
            )
        return count

    def _normals(self, grid: Grid, phi: Stencil, particles: Particles, count: int) -> None:
        c = self.contacts
        if len(self.gradient):
            shared.project_volume_gradient(
                phi.row, phi.nodes, phi.gradient, particles.volume, self.gradient, grid.spacing
            )
        if len(self.mean):
            shared.project_position(
                phi.row,
                phi.nodes,
                phi.weight,
                particles.mass,
                particles.position,
                grid.mass,
                self.mean,
                grid.spacing,
            )
        shared.pair_normals(
            count,
            c.pair,
            c.node_a,
            c.node_b,
            self.weight_first,
            self.weight_second,
            self.given_normal,
            self.gradient,
            self.mean,
            self.cut_off,
            c.normal,
            grid.spacing,
        )

    def _correct(self, grid: Grid, count: int, *, projected: bool) -> None:
        c = self.contacts
        shared.correct_momentum(
            count,
            c.pair,
            c.node_a,
            c.node_b,
            c.normal,
            c.impulse,
            c.work,
            projected,
            self.friction,
            grid.mass,
            grid.momentum,
            self.sharers,
            grid.spacing,
        )

    def _record(self, grid: Grid, count: int) -> None:
        """Add the last correction to what the pairs' series are made from."""
        c, records = self.contacts, self.records
        shared.record(
            count,
            c.pair,
            c.impulse,
            c.work,
            records.impulse,
            records.frictional_work,
            records.count,
            grid.spacing,
        )

    def restart(self) -> None:
        """Forget impulse and work of the settling."""
        self.records.restart()
        if self.leaning is not None:
            self.leaning.restart()

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:  # noqa: ARG002
        """The pairs' series."""
        return self.records.series(interval)
