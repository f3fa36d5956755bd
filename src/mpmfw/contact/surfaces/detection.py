"""The detection on surfaces: options, roles of the bodies, and the search's steps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from mpmfw.contact.rows import ContactRows, Detection
from mpmfw.contact.strategy import ranks_of, stiffness_ranks
from mpmfw.contact.surfaces.assembly import assemble
from mpmfw.contact.surfaces.near_facets import TravelLimit, VerletList
from mpmfw.contact.surfaces.outline import Candidates
from mpmfw.contact.surfaces.search import CROSSED, find_candidates
from mpmfw.contact.surfaces.surface_rows import SurfaceRows
from mpmfw.errors import SceneError
from mpmfw.plugin.base import OptionsModel
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, FloatArray, IntArray
from mpmfw.state.fields import Field as ArrayField
from mpmfw.state.history import check_indices
from mpmfw.state.structs import Grid, Particles, State, Stencil
from mpmfw.state.surface import nodes_left, outer_facets
from mpmfw.units import Length

FORCE = ArrayField(
    "force", ("surface_node", "axis"), "N m-1", "contact force on the surface node", "surface", output=True
)


class FacetOptions(OptionsModel):
    master: str | None = Field(
        None,
        description="name of the master body (one pass); default: the stiffer; of equally stiff ones that "
        "with the larger surface; of equals each is slave once",
    )
    search_radius: float = Field(1.0, gt=0, le=1.0, description="reach of the search in cells")
    interface_thickness: Length = Field(
        0.0, ge=0, description="thickness of the surface layer that carries mass"
    )
    map: Literal["auto", "plain", "mass_weighted"] = Field(
        "auto", description="surface-to-grid map; auto: mass_weighted for linear and GIMP, else plain"
    )


class SurfacesOptions(FacetOptions):
    passes: Literal["one", "two"] = Field(
        "two",
        description="two: each body is slave once, with half of its area; one: classical master-slave, "
        "but of equal bodies",
    )
    normal_variation: Literal["exact", "hamad2017"] = Field(
        "exact", description="C_n = N, the exact variation, or N - (g_n / l) Q (eq. 7)"
    )

    @model_validator(mode="after")
    def _master_has_an_effect(self) -> SurfacesOptions:
        if self.master is not None and self.passes != "one":
            raise ValueError('\'master\' has no effect with passes = "two"; expected passes = "one"')
        return self


class OnFacets(Detection):
    """Base of detections that search facets of surfaces near items: nodes, or facets."""

    options: Any
    selects_pairs = True
    of_facets = False  #: whether the items are facets
    rank: IntArray  #: (body,) items are tested against facets of bodies of the same or a higher rank

    def parts(self) -> list[Any]:
        return [TravelLimit(self)]

    def range(self, cell_size: float) -> float:
        return float(self.options.search_radius) * cell_size

    def prepare(self, setup: Setup, owner: str) -> None:
        """Take the tracked surfaces, rank the bodies, and make the lists of near facets."""
        self.state, self.has_friction = setup.state, setup.has_friction
        self.surface, self.cell_size = setup.state.tracked_surface, setup.cell_size
        if len(setup.bodies) > 2:
            self.surface.covered = np.full(len(self.surface.facets), -1)
        self.radius = self.range(setup.cell_size)
        self.rank = self.rank_bodies(setup, owner)
        items, first = np.arange(self.surface.count)[:, np.newaxis], self.surface.body_first
        if self.of_facets:
            items, first = self.surface.facets, self.surface.facet_first
        spacing, facets = setup.state.grid.spacing, outer_facets(self.surface, setup.state.grid)
        self.near = VerletList(items, first, self.surface, self.radius, spacing, facets)
        if len(setup.bodies) > 2:
            from mpmfw.contact.surfaces.seams import find_covered

            self.near.find_covered = find_covered
        if setup.state.self_contact is not None:
            self.near.remove_joined = setup.state.self_contact.remove_joined
        self.list_pairs(setup.state)

    def rank_bodies(self, setup: Setup, owner: str) -> IntArray:
        """Return the rank of every body (body,)."""
        raise NotImplementedError

    def list_pairs(self, state: State) -> None:
        self.near.list_pairs(state.pair_bodies, self.rank, self.acting(state))

    def fill(self, rows: ContactRows, write: Callable[[], int]) -> None:
        """Call a kernel that writes the ``rows``, with more room while it returns −1."""
        while (count := write()) < 0:
            rows.make_room(2 * len(rows.pair), 2 * len(rows.dof))
        rows.have(count)


class Surfaces(OnFacets):
    """Every node of a surface against the closest facet of each other body that faces it ([H17], section
    3.2).

    Gap, coordinates ξ_a and normal are those of the closest point; a node inside another body is followed
    until it comes out. Weights are N_i(x_s) of the slave and −ξ_a N_i(x_a) of the master.
    """

    name = "surfaces"
    Options: ClassVar[type[FacetOptions]] = SurfacesOptions
    options: FacetOptions
    provides = frozenset({"facets", "nodes", "steady gap"})
    has_radius = finds_own = True
    #: Whether a node has a row for every facet that it penetrates (eq. 10), not the closest alone.
    every_facet: bool = False
    history = ("count",)
    #: Number of candidates in the last step.
    count = 0
    #: Whether entries of B are written, and not its factors alone.
    writes_entries = True

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.surface_map = self.options.map
        self.adds_mass = self.options.interface_thickness > 0.0
        self.leaves_bodies_out = self.options.master is None and not self.adds_mass  # a master must be there

    def configure(self, needs: frozenset[str], *, forces: bool) -> None:
        self.writes_entries = not forces or "entries" in needs

    def parts(self) -> list[Any]:
        """Return the limit of travel, and the surface layer where it has a thickness."""
        if not self.adds_mass:
            return super().parts()
        from mpmfw.contact.surfaces.layer import InterfaceLayer

        return [*super().parts(), InterfaceLayer(self.options.interface_thickness)]

    def fields(self) -> list[ArrayField]:
        return [FORCE]

    def prepare(self, setup: Setup, owner: str) -> None:
        super().prepare(setup, owner)
        if (thickness := self.options.interface_thickness) > setup.cell_size:
            text = f"{thickness:g} m is thicker than a cell; expected at most grid.cell_size, "
            raise SceneError(f"{text}{setup.cell_size:g} m", key=f"contact.{owner}.interface_thickness")
        others = len(setup.bodies) - (setup.state.self_contact is None)
        slots = 8 if self.every_facet else min(max(others, 1), 3)
        axes, text = ("surface_node", "slot"), "candidates of surface nodes"
        facet = setup.allocate(owner, ArrayField("facet", axes, "1", text, "surface", "i8"), slot=slots)
        gap = setup.allocate(owner, ArrayField("gap", axes, "m", text, "surface"), slot=slots)
        facet.fill(-1)
        gap.fill(np.inf)
        self.candidates = Candidates(facet=facet, gap=gap)
        self.force: FloatArray = setup.allocate(owner, FORCE)
        self.through = np.zeros(3)
        self.place = np.zeros(0, dtype=np.int64)
        self.writes_entries |= setup.state.self_contact is not None  # both sides may share nodes

    def rank_bodies(self, setup: Setup, owner: str) -> IntArray:
        """Rank all alike in two passes; in one the stiffer is master, unless one is named. Of equally stiff
        bodies it is the one with the larger surface, whose edges the other seldom reaches."""
        bodies, master, surface = setup.bodies, self.options.master, self.surface
        if master is not None and master not in [body.name for body in bodies]:
            names = ", ".join(body.name for body in bodies)
            raise SceneError(f"no body '{master}'; expected one of {names}", key=f"contact.{owner}.master")
        soft = [body.name for body in bodies if not body.rigid]
        if len(bodies) > 1 and soft == [master]:
            text = f"'{master}' touches rigid bodies alone, which are always master; leave it out"
            raise SceneError(text, key=f"contact.{owner}.master")
        ranks = np.zeros(len(bodies), dtype=np.int64)
        if getattr(self.options, "passes", "one") == "one":
            size = np.array([surface.tributary[surface.of(body.index)].sum() for body in bodies])
            ranks = stiffness_ranks(bodies) * len(bodies) + ranks_of(size)
            ranks[[body.index for body in bodies if body.name == master]] = len(bodies) ** 2
        rigid = setup.state.rigid
        for body, (*_, belt) in () if rigid is None else zip(rigid.bodies, rigid.motion, strict=True):
            # it follows no node; corners of others would meet the nodes of a belt, which it moves along it
            ranks[body.index] = 2 * len(bodies) ** 2 + belt.values.any()
        return ranks

    def new_rows(self, own: dict[str, int | None]) -> SurfaceRows:
        """Return rows with their slave node and facet."""
        dim, friction = self.state.grid.dim, self.has_friction
        tilts = getattr(self.options, "normal_variation", "hamad2017") == "hamad2017"  # eq. 7
        rows = SurfaceRows(dim, couples=friction, tilts=tilts, spins=friction and dim == 3, own=own)
        rows.n_bodies = len(self.state.bodies)
        if not self.writes_entries:
            rows.use_factors(self.surface)
        rows.limits = {"at/slave": self.surface.count, "at/facet": len(self.surface.facets)}
        return rows

    def radii(self, rows: ContactRows, grid: Grid) -> FloatArray:  # noqa: ARG002
        assert isinstance(rows, SurfaceRows)
        return np.asarray(self.surface.position[rows.places.slave[: rows.count], 0])

    def restored(self) -> None:
        """Refuse candidates on facets that there are not by ``NotSaved``."""
        check_indices(len(self.surface.facets), facet=self.candidates.facet)

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:  # noqa: ARG002
        """Search at x_s(tⁿ), and write a row for each candidate."""
        assert isinstance(rows, SurfaceRows)
        self.count, closest = self.search(), not self.every_facet
        if self.count == 0:
            rows.have(0)
            return
        ties = self.law_range if closest else -np.inf
        if self.writes_entries and len(self.place) < len(grid.mass):
            self.place = np.zeros(len(grid.mass), dtype=np.int64)
        self.fill(
            rows,
            lambda: assemble(
                self.rank, closest, ties, self.candidates, self.surface, self.near.pair_of,
                self.near.first, self.surface.table, self.place, rows, rows.places, grid.spacing,
            ),
        )  # fmt: skip
        if len(rows.spin):
            from mpmfw.contact.surfaces.turning import write_spins  # not called for in the plane

            write_spins(rows.count, self.law_range, self.surface, rows, rows.places, grid.spacing)

    def search(self) -> int:
        """Fill the candidates; return their number. Raise SimulationError if bodies crossed."""
        if not self.near.update() and self.count == 0:
            return 0
        given = self.radius, self.surface, self.near.near, self.candidates, self.through
        for _ in range(2):  # again without nodes that have left their points, which bodies pass
            count = find_candidates(*given, self.state.grid.spacing)
            if self.through[0] <= CROSSED * self.cell_size:
                return count
            self.candidates.gap[nodes_left(self.surface)] = np.inf
        beyond, node, other = float(self.through[0]), int(self.through[1]), int(self.through[2])
        ends = {int(self.surface.body[node]), other}
        pair = next(pair for pair in self.state.pairs if {pair.first, pair.second} == ends)
        text = (
            f"{pair.label}: the bodies have crossed: a surface node came out by the far side of "
            f"'{self.state.bodies[other].name}', and is {beyond / self.cell_size:.2g} cells beyond it"
        )
        advice = "a slower impact, a stiffer contact, or smaller cells"
        raise self.state.error_at(node, text, surface=True, advice=advice)

    def copy_history(self, other: Surfaces, index_map: Any) -> None:
        """Copy the candidates of the last step; of more than there are slots the deepest."""
        theirs, ours = other.candidates, self.candidates
        known = np.flatnonzero(index_map.surface_node >= 0)
        node, facet = index_map.surface_node[known], theirs.facet[known]
        facet = np.where(facet >= 0, index_map.facet[facet], -1)  # of bodies that are here
        gap = np.where(facet >= 0, theirs.gap[known], np.inf)
        deepest = np.argsort(gap, axis=1, kind="stable")[:, : ours.facet.shape[1]]
        slots = deepest.shape[1]
        ours.facet[node], ours.gap[node] = -1, np.inf
        ours.facet[node, :slots] = np.take_along_axis(facet, deepest, axis=1)
        ours.gap[node, :slots] = np.take_along_axis(gap, deepest, axis=1)
        self.count = int((ours.facet >= 0).sum())
        self.near.listed = False

    def outputs(self, rows: ContactRows) -> dict[str, AnyArray]:
        """Return contact forces of the surface nodes; corners share those of facets."""
        assert isinstance(rows, SurfaceRows)
        n, at = slice(rows.count), rows.places
        force, normal, corners = rows.force[n], rows.normal[n], self.surface.facets[at.facet[n]]
        self.force.fill(0.0)
        np.add.at(self.force, at.slave[n], force)
        for a in range(corners.shape[1]):
            on_corner = -at.share[n, a, None] * force
            if len(at.turn):
                on_corner += (at.turn[n, a] * force).sum(axis=1, keepdims=True) * normal
            if len(at.lean):
                on_corner += (force * normal).sum(axis=1, keepdims=True) * at.lean[n, a]
            np.add.at(self.force, corners[:, a], on_corner)
        return {"force": self.force}
