"""[H17] by its equations: springs between surface nodes and every facet that they penetrate.

Source: F. Hamad, S. Giridharan, C. Moormann (2017), A penalty function method for modelling frictional
contact in MPM, Procedia Engineering 175, 116-123. It leaves friction open: μ is in none of its equations,
and the tangential gap of eq. 3 counts from the previous step. Assumed here, as in explicit finite-element
codes, to whose practice [H17] refers: those gaps add up while the contact lasts, and |f_t| ≤ μ f_n.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from mpmfw.api import ContactRows, Pair, PairRecords, SceneError, Setup, hookimpl
from mpmfw.api.types import Surface
from mpmfw.contact.springs import SpringArrays, SpringLaw, SpringOptions, approach_of
from mpmfw.contact.surfaces import FacetOptions, Surfaces
from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw.contact.surfaces.outline import Candidates, clear, hidden
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.contact import Records, Rows
from mpmfw.kernels.facets import project, read_corners, read_point
from mpmfw.kernels.types import Float


@device
def is_behind(s: int, m: int, radius: Float, outline: Surface, spacing: tuple[float, ...]) -> Float:
    """Gap by eq. 10: g_n < 0 with the foot of node s on facet m, a corner within the radius; else 0."""
    dim, near, on_it = len(spacing), False, True
    x, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    corners = scratch.matrix(spacing, spacing)
    read_point(s, outline.position, x, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    gap = project(x, corners, share, normal, spacing)
    for a in range(dim):
        square = 0.0
        for d in range(dim):
            square += (x[d] - corners[a, d]) ** 2
        near, on_it = near or square < radius * radius, on_it and share[a] >= 0.0
    return min(gap, 0.0) if near and on_it else 0.0


@kernel
def find_penetrated(
    radius: float, outline: Surface, near: NearFacets, candidates: Candidates, spacing: tuple[float, ...]
) -> int:
    """List for every node the facets that it penetrates, up to the number of slots; return their number."""
    count, slots = 0, candidates.facet.shape[1]
    for s in range(len(outline.body)):
        clear(s, candidates)
        j = 0
        for k in range(near.first[s], near.first[s + 1]):
            m, gap = near.facet[k], 0.0
            if j < slots and not hidden(m, outline.body[s], outline):
                gap = is_behind(s, m, radius, outline, spacing)
            if gap < 0.0:
                candidates.facet[s, j], candidates.gap[s, j] = m, gap
                j += 1
        count += j
    return count


class EveryFacet(Surfaces):
    """One body of a pair is master; its facets act on every node behind them (eq. 10 and 7)."""

    Options: ClassVar[type[FacetOptions]] = FacetOptions
    every_facet = True
    finds_own = False  # one part would have to be master
    #: [H17] is of the plane; in space its rows leave a moment where cubes meet face on face (``mpmfw check``:
    #: 0.006 cells).
    dimensions = (2,)

    def search(self) -> int:
        if not self.near.update():
            return 0
        return find_penetrated(
            self.radius, self.surface, self.near.near, self.candidates, self.state.grid.spacing
        )


@kernel
def linear_springs(
    rows: Rows, count: int, own: SpringArrays, tangential_ratio: float, records: Records
) -> None:
    """N = −k g of every row that overlaps (eq. 9)."""
    for c in range(count):
        k, gap = own.k[c], rows.gap[c]
        if gap < 0.0:
            own.normal[c], own.k_t[c] = -k * gap, tangential_ratio * k
            records.energy[rows.pair[c]] += 0.5 * k * gap * gap


@kernel
def add_literal_friction(rows: Rows, count: int, own: SpringArrays, records: Records) -> None:
    """Add −ω_t g_t C_t of eq. 9 as it is written: g_t of this step alone, and no limit, where μ > 0."""
    for c in range(count):
        if own.k_t[c] == 0.0 or rows.friction[c] == 0.0:
            continue
        approach, square = approach_of(c, rows), 0.0
        for d in range(rows.normal.shape[1]):
            slip = rows.motion[c, d] - approach * rows.normal[c, d]
            rows.force[c, d] -= own.k_t[c] * slip
            square += slip * slip
        records.frictional_work[rows.pair[c]] += own.k_t[c] * square


class Hamad2017LawOptions(SpringOptions):
    friction_law: Literal["coulomb", "literal"] = Field(
        "coulomb",
        description="coulomb: g_t of the steps add up, |f_t| <= mu f_n; literal: g_t of one step, which "
        "ignores mu's value",
    )


class Hamad2017Law(SpringLaw):
    """Linear springs on every row that overlaps, by eq. 9."""

    name = "hamad2017"
    Options = Hamad2017LawOptions
    options: Hamad2017LawOptions
    needs = frozenset({"gap", "facets"})

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:
        """Return the arrays of springs, with a tangential force where gaps add up."""
        return super().row_arrays(friction=friction and self.options.friction_law == "coulomb")

    def unused(self, pairs: Sequence[Pair]) -> list[str]:
        """Return the value of μ under literal friction."""
        frictional = [pair.label for pair in pairs if pair.mu > 0.0]
        if self.options.friction_law == "coulomb" or not frictional:
            return []
        return [
            f"value of friction of {', '.join(frictional)}: contact '{self.name}' with friction_law = "
            "'literal' ignores it"
        ]

    def prepare(self, setup: Setup) -> None:
        """List the stiffness of the pairs; literal friction has no limit, and refuses a friction law."""
        super().prepare(setup)
        if self.options.friction_law == "literal" and setup.friction_law is not None:
            raise SceneError(
                f"has no effect with contact.{self.law_name}.friction_law = 'literal', which has no bound; "
                "expected 'coulomb' there",
                key="contact.friction_law",
            )

    def normal_forces(self, rows: ContactRows, old: ContactRows, records: PairRecords) -> None:  # noqa: ARG002
        linear_springs(rows, rows.count, rows.own, self.options.tangential_ratio, records)

    def forces(self, rows: ContactRows, old: ContactRows, dashpot: float, records: PairRecords) -> None:
        """Write eq. 9, with the friction that the options name."""
        super().forces(rows, old, dashpot, records)
        if self.options.friction_law == "literal" and len(rows.friction):
            add_literal_friction(rows, rows.count, rows.own, records)

    @hookimpl
    def concerns(self) -> list[str]:
        return [*super().concerns(), *self.unused(self.state.pairs)]


class Hamad2017(Hamad2017Law):
    """One body of a pair is master; its facets repel every node that they find behind them (eq. 10), by eq.
    7-11.

    The surface layer has the mass of [H17] 3.1, where the stiffness "can be the same as the elastic
    stiffness": κ = 1.
    """

    Detection = EveryFacet
    defaults: ClassVar[dict[str, float]] = {"kappa": 1.0, "interface_thickness": 0.001}
