"""Springs between tracked surfaces as a plug-in: search, stiffness, map, and their stable time step; the force is a law's."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np

from mpmfw.api import (
    AnyArray,
    ContactStrategy,
    Field,
    FloatArray,
    Grid,
    SceneError,
    Setup,
    State,
    Stencil,
    hookimpl,
)
from mpmfw.kernels.polyline import bounding_boxes
from mpmfw_contact.penalty import search
from mpmfw_contact.penalty.candidates import Candidates, SearchGrid
from mpmfw_contact.penalty.laws import PairLaws
from mpmfw_contact.penalty.losses import add_losses
from mpmfw_contact.penalty.options import SurfaceOptions
from mpmfw_contact.penalty.spring import LINEAR_TO
from mpmfw_contact.penalty.stability import (
    contact_frequency,
    map_to_grid,
    spring_stiffness,
)
from mpmfw_contact.penalty.tracking import CROSSED, crossed, find_crossings, keep_inside
from mpmfw_contact.penalty.travel import TravelLimit
from mpmfw_contact.records import PairRecords

#: Travel in a step, in search radii, below which no node can pass the middle of a body unseen.
THIN = 0.05

SPRING_WORK = Field(
    "spring_work",
    ("pair",),
    "J m-1",
    "energy lost by springs that change or end while they are loaded, since time zero",
    "series",
    output=True,
)

FORCE = Field(
    "force", ("surface_node", "axis"), "N m-1", "contact force on the surface node", "surface", output=True
)


class SurfaceSprings(ContactStrategy):
    """Surfaces of two-node segments; a node inside another body is pushed out by springs, and held by friction.

    Spring stiffness of a slave node is k = κ M l_trib / h with M the softer body's K + 4 G / 3, halved where
    both bodies are slaves. The forces are mapped to each body's own velocity field with shape
    functions at the surface nodes (eq. 11). A step must resolve the springs: ω² from the nodal masses bounds
    it together with the bulk's. A law has a name, options and ``_forces``.
    """

    Options = SurfaceOptions
    options: SurfaceOptions
    velocity_fields = "per_body"
    needs_surface = True
    uses_friction = True
    dimensions = (2,)
    stage = "contact"
    #: Whether a node meets every segment that it penetrates (eq. 10), and not the closest one of a body.
    every_segment: ClassVar[bool] = False
    #: Whether springs bear by the part of their length that lies across the normal, and change with it.
    shares: ClassVar[bool] = False
    #: Whether the stiffer body is master, or the one that is named, and not each body slave once.
    one_pass: bool = True
    #: Normal dashpot as a fraction of critical.
    damping: float = 0.0

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.surface_map = self.options.map
        self.adds_mass = self.options.interface_thickness > 0.0

    def parts(self) -> list[Any]:
        """The limit of travel, and the surface layer's inertia where it has a thickness."""
        travel = TravelLimit(self.options.search_radius)
        if not self.adds_mass:
            return [travel]
        from mpmfw_contact.penalty.layer import InterfaceLayer

        return [travel, InterfaceLayer(self.options.interface_thickness)]

    def reach(self, cell_size: float) -> float:
        """The search radius: bodies whose boxes are farther apart cost a comparison of boxes."""
        return self.options.search_radius * cell_size

    def monitors(self) -> list[Any]:
        """Steps per contact and deepest penetration."""
        from mpmfw_contact.penalty.events import monitors

        return monitors(self)

    @property
    def keeps_friction(self) -> bool:
        """Whether the tangential force is stored from step to step."""
        return True

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """Force of the surface nodes, and the pairs' series."""
        return [FORCE, *PairRecords.declarations(), *([SPRING_WORK] if self.shares else [])]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Laws of the pairs as arrays."""
        if setup.state.surface is None:
            raise SceneError(f"contact '{self.name}' needs bodies with outlines")
        self.laws = PairLaws.of(setup, self.name, self.options, one_pass=self.one_pass)
        self.state, self.surface = setup.state, setup.state.surface
        self.records = PairRecords(setup, self.name)
        slots = 8 if self.every_segment else min(max(len(setup.bodies) - 1, 1), 3)
        self.candidates = Candidates.allocate(
            setup,
            self.name,
            slots,
            friction=self.keeps_friction and setup.has_friction,
            damping=self.damping > 0.0,
            shares=self.shares,
        )
        self.spring_work = setup.allocate(self.name, SPRING_WORK) if self.shares else np.zeros(0)
        self.force: FloatArray = setup.allocate(self.name, FORCE)
        self.grid = SearchGrid.allocate(setup, self.name)
        share = 1.0 if self.one_pass else 0.5
        # k = κ M l_trib / h of every surface node, up to M, which depends on the body that it meets.
        self.node_factor = share * self.options.kappa * self.surface.tributary / setup.cell_size
        self.stiffest = max(1.0, self.options.tangential_ratio) if setup.has_friction else 1.0
        self.radius = self.reach(setup.cell_size)
        self.cell_size = setup.cell_size
        self.linear_to = LINEAR_TO * setup.cell_size if self.shares else math.inf
        self.bulk_frequency = setup.bulk_frequency
        self.node_stiffness = np.zeros(0)
        self.omega_squared = 0.0
        self.count = 0
        self.searched = False
        self.rows, self.through = np.zeros((3, 2)), np.zeros(3)

    @hookimpl
    def add_pairs(self, state: State) -> None:
        """Laws and records of bodies that have come near."""
        self.laws.list_pairs(state.pairs)
        self.records.add_pairs(state)
        if self.shares:
            self.spring_work = state.lengthen(f"{self.name}/{SPRING_WORK.name}", len(state.pairs))

    def _table(self) -> Stencil:
        """N_i(x_s) of this step."""
        if self.surface.stencil is None:
            raise RuntimeError("the surface's table was not filled")
        return self.surface.stencil

    @hookimpl
    def detect(self, grid: Grid) -> None:
        """Search at x_s(tⁿ), and the stiffness and frequency of what is found."""
        before, self.count = self.count, self._search(grid)
        if self.count:
            self._stiffness(grid, self._table())
        elif before > 0:
            self._part()

    @hookimpl
    def add_nodal_force(self, grid: Grid, dt: float) -> None:
        """Form the pair forces, and map them (eq. 9, 11)."""
        if self.count == 0:
            return
        phi = self._table()
        rubbed = self.records.frictional_work.copy()
        self._forces(dt)
        self._losses(self.records.frictional_work - rubbed)
        map_to_grid(phi.row, phi.nodes, phi.weight, self.force, grid.force)

    def _search(self, grid: Grid) -> int:
        surface, found = self.surface, self.candidates
        self.searched = True
        boxes = self.grid
        bounding_boxes(surface.body_first, surface.position, boxes.box_lower, boxes.box_upper)
        near = search.boxes_touch(
            self.laws.first, self.laws.second, boxes.box_lower, boxes.box_upper, self.radius
        )
        tagged = near and boxes.list_segments(surface, grid, len(self.state.bodies))
        if not tagged and self.count == 0:
            return 0
        count = 0
        if tagged:
            count = self._search_tagged(grid)
        else:
            found.segment.fill(-1)
        return count + self._track() if self.shares else count

    def _part(self) -> None:
        """No candidate is left: forget forces and history."""
        self.candidates.master.fill(-1)
        self._losses(0.0)
        self.candidates.forget()
        self.force.fill(0.0)
        self.records.count.fill(0.0)
        self.records.energy.fill(0.0)

    def _search_tagged(self, grid: Grid) -> int:
        s, c, g = self.surface, self.candidates, self.grid
        return search.find_pairs(
            g.stamp,
            self.radius,
            self.every_segment,
            s.position,
            s.next,
            s.previous,
            s.body,
            self.laws.rank,
            grid.lower,
            grid.spacing,
            grid.nodes,
            g.shared,
            g.head,
            g.head_stamp,
            g.link,
            g.link_segment,
            c.master,
            c.segment,
            c.coordinate,
            c.gap,
            c.normal,
        )

    def _track(self) -> int:
        """Nodes inside that the search has lost, or missed; the end of the run where bodies have crossed."""
        s, c, g = self.surface, self.candidates, self.grid
        added = keep_inside(
            s.position,
            s.next,
            s.previous,
            s.body,
            s.body_first,
            c.old_master,
            c.old_segment,
            c.master,
            c.segment,
            c.coordinate,
            c.gap,
            c.normal,
            self.through,
        )
        if self.through[0] > CROSSED * self.cell_size:
            raise crossed(self.state, self.through)
        added += find_crossings(
            THIN * self.radius,
            s.position,
            s.displacement,
            s.next,
            s.previous,
            s.body_first,
            self.laws.first,
            self.laws.second,
            self.laws.rank,
            g.box_lower,
            g.box_upper,
            c.master,
            c.segment,
            c.coordinate,
            c.gap,
            c.normal,
        )
        return added

    def _stiffness(self, grid: Grid, phi: Stencil) -> None:
        """Spring stiffness of every candidate, and the highest frequency that they give the grid."""
        c, s = self.candidates, self.surface
        spring_stiffness(
            c.slots,
            c.segment,
            c.master,
            s.body,
            self.node_factor,
            self.laws.modulus,
            s.position,
            s.next,
            s.previous,
            s.displacement,
            c.coordinate,
            c.normal,
            c.gap,
            self.cell_size,
            c.old_master,
            c.old_share,
            c.old_rest,
            self.state.steps == 0,
            c.share,
            c.rest,
            c.stiffness,
        )
        if len(self.node_stiffness) != len(grid.mass):
            self.node_stiffness = np.zeros(len(grid.mass))
            self.state.arrays[f"{self.name}/node_stiffness"] = self.node_stiffness
        self.omega_squared = self.stiffest * contact_frequency(
            c.slots,
            c.segment,
            c.coordinate,
            c.gap,
            c.rest,
            c.stiffness,
            self.linear_to,
            s.next,
            phi.row,
            phi.nodes,
            phi.weight,
            grid.mass,
            self.node_stiffness,
        )
        if self.damping > 0.0 and self.omega_squared > 0.0 and self.state.dt > 0.0:
            # c = ζ 2 sqrt(k m) with the mass k / ω² that goes with the highest frequency; per length of the
            # last step
            period = math.sqrt(self.omega_squared) * self.state.dt
            c.damping[...] = 2.0 * self.damping * c.stiffness / period

    def _losses(self, rubbed: float | FloatArray) -> None:
        """What springs of the last step have lost, but for what friction has ``rubbed`` away in this one [J/m]."""
        if not self.shares:
            return
        c, s = self.candidates, self.surface
        add_losses(
            s.body,
            self.laws.pair_of,
            s.position,
            s.displacement,
            s.next,
            s.previous,
            c.master,
            c.gap,
            c.rest,
            c.stiffness,
            c.tangential,
            c.old_master,
            c.old_segment,
            c.old_coordinate,
            c.old_gap,
            c.old_normal,
            c.old_rest,
            c.old_stiffness,
            c.old_tangential,
            self.options.tangential_ratio,
            self.linear_to,
            self.rows,
            self.spring_work,
        )
        self.spring_work -= rubbed

    def _forces(self, dt: float) -> None:
        """Forces of all candidates in contact into ``self.force``, and the pairs' records."""
        raise NotImplementedError

    @hookimpl
    def stable_timestep(self) -> tuple[float, str] | None:
        """2 / sqrt(ω_bulk² + ω²): bulk and springs act together. Before the first search, ω² = 4 κ (c / h)²
        (equal bodies)."""
        if not self.searched:
            omega_squared = self.options.kappa * self.bulk_frequency**2
        elif self.count:
            omega_squared = self.omega_squared
        else:
            return None
        zeta = self.damping
        # A dashpot that lags by a step takes away from the limit of its spring: 2 (√(1 + ζ²) − ζ) / ω.
        omega_squared /= (math.sqrt(1.0 + zeta * zeta) - zeta) ** 2
        return 2.0 / math.sqrt(self.bulk_frequency**2 + omega_squared), "penalty springs and bulk"

    @hookimpl
    def end_step(self) -> None:
        """What was found in this step is the history of the next."""
        if self.count:
            self.candidates.swap()

    def restart(self) -> None:
        """Forget impulse and work of the settling; springs stay loaded."""
        self.records.restart()
        self.spring_work.fill(0.0)

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:  # noqa: ARG002
        """The pairs' series and the surface nodes' forces."""
        lost = {"spring_work": self.spring_work.copy()} if self.shares else {}
        return {"force": self.force, **self.records.series(interval), **lost}
