"""Penalty contact: a spring on every row, with friction within Coulomb's cone.

At the depth d = rest − g > 0 a row has the normal force

    N = k d,  k = κ M A / h,  beyond d = l stiffer: N = k (d + 4 (d − l)² / l),

and a dashpot that never pulls. A is the part of its area that lies across the normal. The rest is 0 for a
node that came in by the face; :mod:`mpmfw_contact._springs` says how springs change without gain of energy.

Source: [H17], F. Hamad, S. Giridharan, C. Moormann (2017), in the form that measurements led to
(``docs/guide/methods.md``); :mod:`mpmfw_contact.hamad2017` has its own form. The nearest relative is E. G.
Kakouris, M. N. Chatzis, S. P. Triantafyllou (2024), arXiv 2403.13534, with extended B-splines.
"""

from __future__ import annotations

from typing import Any

from pydantic import Field

from mpmfw.api import AnyArray, ContactRows, FloatArray, PairRecords, Setup, State, hookimpl
from mpmfw.api import Field as ArrayField
from mpmfw.contact.springs import SpringLaw, SpringOptions, approach_of
from mpmfw.contact.surfaces import Surfaces
from mpmfw.kernels import kernel
from mpmfw.kernels.contact import Records, Rows
from mpmfw_contact._springs import (
    LINEAR_TO,
    ChangingSprings,
    add_losses,
    normal_force,
    set_springs,
    spring_energy,
)

SPRING_WORK = ArrayField(
    "spring_work",
    ("pair",),
    "J m-1",
    "energy lost by springs that change or end while they are loaded, since time zero",
    "series",
    output=True,
)


@kernel
def spring_forces(
    rows: Rows, count: int, own: ChangingSprings, old: Rows, tangential_ratio: float, dashpot: float,
    linear_to: float, records: Records,
) -> None:  # fmt: skip
    """N of every row that overlaps, by a spring and a dashpot; and the part of its first step."""
    for c in range(count):
        gap, p, k, o = rows.gap[c], rows.pair[c], own.k[c], rows.previous[c]
        if gap >= 0.0:
            continue
        depth, approach = max(own.rest[c] - gap, 0.0), approach_of(c, rows)
        own.normal[c], own.k_t[c] = normal_force(k, depth, linear_to), tangential_ratio * k
        records.energy[p] += spring_energy(k, depth, linear_to)
        if dashpot > 0.0:
            held = max(-min(dashpot * k, 2.0 * k) * approach, -own.normal[c])
            own.normal[c] += held
            records.damping_work[p] += max(-held * approach, 0.0)
        if approach < 0.0 and (o < 0 or old.gap[o] >= 0.0):
            own.entered[c] = min(1.0, gap / approach)


class PenaltyLawOptions(SpringOptions):
    damping: float = Field(0.0, ge=0, description="normal dashpot as a fraction of critical, at most 2 k dt")
    linear_to: float = Field(
        LINEAR_TO,
        gt=0,
        description="depth l in cells from which springs grow stiffer: f = k (d + 4 (d - l)² / l)",
    )


class PenaltyLaw(SpringLaw):
    """Springs whose stiffness follows their area across the normal, without gain of energy."""

    name = "penalty"
    leaves_bodies_out = True
    Options = PenaltyLawOptions
    options: PenaltyLawOptions

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.damping = self.options.damping

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:
        return {**super().row_arrays(friction=friction), "rest": 0, "moved": 1}

    @hookimpl
    def declare_fields(self) -> list[ArrayField]:
        return [*super().declare_fields(), SPRING_WORK]

    def prepare(self, setup: Setup) -> None:
        setup.allocate(self.name, SPRING_WORK)
        self.linear_to = self.options.linear_to * setup.cell_size
        super().prepare(setup)

    def list_pairs(self, state: State) -> None:
        super().list_pairs(state)
        self.change = state.lengthen(f"{self.name}/{SPRING_WORK.name}", len(state.pairs))

    def stiffness(self, rows: ContactRows, old: ContactRows) -> FloatArray:
        """Write k = κ M A / h with the area across the normal, and return the tangent stiffness."""
        set_springs(
            rows, rows.count, rows.own, old, old.count, old.own, self.modulus, self.stiffest,
            self.cell_size, self.linear_to, self.state.steps == 0, self.detection.mean_gaps,
        )  # fmt: skip
        return rows.own.limit_k  # type: ignore[no-any-return]

    def normal_forces(self, rows: ContactRows, old: ContactRows, records: PairRecords) -> None:
        """Write N; and add what the last step's springs lost."""
        spring_forces(
            rows, rows.count, rows.own, old, self.options.tangential_ratio, self.dashpot, self.linear_to,
            records,
        )  # fmt: skip
        add_losses(rows, rows.count, rows.own, old, old.count, old.own, self.linear_to, self.change)

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        return {**super().diagnostics(state, interval), "spring_work": self.change.copy()}

    def restart(self) -> None:
        """Forget the losses; springs stay loaded."""
        super().restart()
        self.change.fill(0.0)


class Penalty(PenaltyLaw):
    """Springs between surfaces: both bodies slaves, the closest facing facet, friction with a history."""

    Detection = Surfaces
