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
from mpmfw.contact.springs import SpringArrays, SpringLaw, SpringOptions, approach_of
from mpmfw.kernels import kernel
from mpmfw.kernels.contact import Records, Rows
from mpmfw_contact.every_facet import EveryFacet


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
    """Stiffness along the normal and the tangent, and the reading of [H17]'s friction."""

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
        """Write N."""
        linear_springs(rows, rows.count, rows.own, self.options.tangential_ratio, records)

    def forces(self, rows: ContactRows, old: ContactRows, dashpot: float, records: PairRecords) -> None:
        """Write eq. 9, with the friction that the options name."""
        super().forces(rows, old, dashpot, records)
        if self.options.friction_law == "literal" and len(rows.friction):
            add_literal_friction(rows, rows.count, rows.own, records)

    @hookimpl
    def concerns(self) -> list[str]:
        """Add what friction ignores."""
        return [*super().concerns(), *self.unused(self.state.pairs)]


class Hamad2017(Hamad2017Law):
    """One body of a pair is master; its facets repel every node that they find behind them (eq. 10), by eq.
    7-11.

    The surface layer has the mass of [H17] 3.1, where the stiffness "can be the same as the elastic
    stiffness": κ = 1.
    """

    Detection = EveryFacet
    defaults: ClassVar[dict[str, float]] = {"kappa": 1.0, "interface_thickness": 0.001}
