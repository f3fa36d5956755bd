"""[H17] by its equations: springs between surface nodes and every facet that they penetrate.

Source: F. Hamad, S. Giridharan, C. Moormann (2017), A penalty function method for modelling frictional contact in MPM,
Procedia Engineering 175, 116-123. What it leaves open is friction: μ is in none of its equations, and the tangential gap of
eq. 3 counts from the previous step. Here those gaps are read as increments, as explicit finite-element codes have them, to
whose practice [H17] refers: they add up while the contact lasts, and |f_t| ≤ μ f_n. That is an assumption of this module.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from mpmfw.api import (
    ContactRows,
    FloatArray,
    ForceContact,
    Length,
    Pair,
    PairRecords,
    SceneError,
    Setup,
    hookimpl,
)
from mpmfw.kernels import Struct, kernel
from mpmfw.kernels.contact import Records, Rows, slip_bound
from mpmfw.kernels.types import Floats
from mpmfw_contact._springs import along_and_across, end_of, first_of, old_force, return_to_cone
from mpmfw_contact.penalty import SpringOptions, Springs
from mpmfw_contact.surfaces import FacetOptions, Surfaces


class Own(Struct):
    """The law's own arrays of n rows."""

    k: Floats  #: (n,) stiffness [N m^(dim−4)]
    limit_k: Floats  #: (n,) stiffness that limits the step
    tangential: Floats  #: (n, dim) tangential force; (0, dim) where none is carried from step to step


@kernel
def pair_forces(
    rows: Rows, count: int, own: Own, old: Rows, old_count: int, old_own: Own, tangential_ratio: float, records: Records,
) -> None:  # fmt: skip
    """f = −(ω_n g_n C_n + ω_t g_t C_t) of every row that overlaps (eq. 9).

    ``own.tangential`` without rows is the literal friction: g_t of this step alone, and no cap.
    """
    dim, adds_up = rows.normal.shape[1], len(own.tangential) > 0
    records.energy[:] = 0.0
    for c in range(count):
        for d in range(dim):
            rows.force[c, d] = 0.0
            if adds_up:
                own.tangential[c, d] = 0.0
        gap = rows.gap[c]
        if gap >= 0.0:
            continue
        p, k, k_t = rows.pair[c], own.k[c], tangential_ratio * own.k[c]
        records.energy[p] += 0.5 * k * gap * gap
        along, across = along_and_across(c, rows)
        for d in range(dim):
            rows.force[c, d] = -k * gap * rows.normal[c, d]
        if adds_up:
            first = first_of(c, rows.identity)
            share = 1.0 / (end_of(c, count, rows.identity) - first)
            old_force(c, rows.before[c], rows, old, old_count, old_own.tangential, share, own.tangential)
            for d in range(dim):
                own.tangential[c, d] -= k_t * (rows.motion[c, d] - along * rows.normal[c, d])
            limit = slip_bound(rows, c, 0.0) - rows.friction[c] * k * gap
            lost, stored = return_to_cone(c, limit, k_t, own.tangential)
            records.frictional_work[p] += lost
            records.energy[p] += stored
            for d in range(dim):
                rows.force[c, d] += own.tangential[c, d]
        elif len(rows.friction) > 0 and rows.friction[c] > 0.0:
            for d in range(dim):
                rows.force[c, d] -= k_t * (rows.motion[c, d] - along * rows.normal[c, d])
            records.frictional_work[p] += k_t * across * across


class Hamad2017LawOptions(SpringOptions):
    """Stiffness along the normal and the tangent, and the reading of [H17]'s friction."""

    friction_law: Literal["coulomb", "literal"] = Field(
        "coulomb",
        description="coulomb: g_t of the steps add up, |f_t| <= mu f_n; literal: g_t of one step, which ignores mu's value",
    )


class Hamad2017Law(Springs):
    """Linear springs on every row that overlaps, by eq. 9."""

    name = "hamad2017"
    Options = Hamad2017LawOptions
    options: Hamad2017LawOptions
    needs_facets = True

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:
        """Stiffness; the tangential force where gaps add up."""
        coulomb = friction and self.options.friction_law == "coulomb"
        return {"k": 0, "limit_k": 0, "tangential": 1 if coulomb else None}

    def unused(self, pairs: Sequence[Pair]) -> list[str]:
        """The value of μ under literal friction."""
        frictional = [pair.label for pair in pairs if pair.mu > 0.0]
        if self.options.friction_law == "coulomb" or not frictional:
            return []
        return [
            f"value of friction of {', '.join(frictional)}: contact 'hamad2017' with friction_law = 'literal' ignores it"
        ]

    def prepare(self, setup: Setup, owner: str) -> None:
        """As of springs; literal friction has no bound that a friction law could set.

        Raises
        ------
        SceneError
            The scene names one.
        """
        super().prepare(setup, owner)
        if self.options.friction_law == "literal" and setup.friction_law is not None:
            raise SceneError(
                f"contact.friction_law: has no effect with contact.{owner}.friction_law = 'literal', which has no bound; "
                "expected 'coulomb' there"
            )

    def stiffness(self, rows: ContactRows, old: ContactRows) -> FloatArray:  # noqa: ARG002
        """k = κ M A / h of the whole area."""
        own, n = rows.own, slice(rows.count)
        own.k[n] = self.modulus[rows.pair[n]] * rows.area[n]
        own.limit_k[n] = self.stiffest * own.k[n]
        return own.limit_k  # type: ignore[no-any-return]

    def forces(self, rows: ContactRows, old: ContactRows, dashpot: float, records: PairRecords) -> None:  # noqa: ARG002
        """Eq. 9."""
        pair_forces(
            rows, rows.count, rows.own, old, old.count, old.own, self.options.tangential_ratio, records
        )  # fmt: skip


class EveryFacet(Surfaces):
    """One body of a pair is master; its facets meet every node that they find behind them (eq. 10), normals varied (eq. 7)."""

    Options: ClassVar[type[FacetOptions]] = FacetOptions
    every_facet = True
    #: [H17] is of the plane; in space its rows leave a moment where cubes meet face on face (``mpmfw check``: 0.006 cells).
    dimensions = (2,)


class Hamad2017Options(Hamad2017LawOptions, FacetOptions):
    """Springs between surfaces, with [H17]'s layer, and the reading of its friction: options of the law and of detection.

    The stiffness "can be the same as the elastic stiffness" ([H17] 3.1): κ = 1.
    """

    kappa: float = Field(
        1.0, gt=0, description="stiffness factor: k = kappa M area / h, M the softer K + 4 G / 3"
    )
    interface_thickness: Length = Field(
        0.001, ge=0, description="thickness of the surface layer that carries mass ([H17] 3.1)"
    )


class Hamad2017(ForceContact):
    """One body of a pair is master; its facets repel every node that they find behind them (eq. 10), by eq. 7-11."""

    name = "hamad2017"
    Detection = EveryFacet
    Law = Hamad2017Law
    Options = Hamad2017Options

    @hookimpl
    def concerns(self) -> list[str]:
        """What friction ignores, for the results."""
        return self.unused(self.state.pairs)
