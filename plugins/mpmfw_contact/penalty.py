"""Penalty contact: a spring on every row, with friction within Coulomb's cone.

Source: [H17], F. Hamad, S. Giridharan, C. Moormann (2017), in the form that measurements led to; what departs from it and why is
said in ``docs/guide/methods.md``. Its own form is :mod:`mpmfw_contact.hamad2017`. The nearest relative is E. G. Kakouris, M. N.
Chatzis, S. P. Triantafyllou (2024), A high-fidelity material point method for frictional contact problems, arXiv 2403.13534:
penalty forces on discretised boundaries of the bodies as well, with extended B-splines as shape functions.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from mpmfw.api import (
    AnyArray,
    ContactRows,
    FloatArray,
    ForceContact,
    ForceLaw,
    PairRecords,
    SceneError,
    Setup,
    State,
)
from mpmfw.api import Field as ArrayField
from mpmfw_contact import _springs as springs
from mpmfw_contact.surfaces import Surfaces, SurfacesOptions

#: Options of [H17]'s own form, which is a method of its own.
MOVED = ("variant", "friction_law", "detection")

SPRING_WORK = ArrayField(
    "spring_work",
    ("pair",),
    "J m-1",
    "energy lost by springs that change or end while they are loaded, since time zero",
    "series",
    output=True,
)


class SpringOptions(BaseModel):
    """Stiffness along the normal and the tangent."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    kappa: float = Field(
        4.0, gt=0, description="stiffness factor: k = kappa M area / h, M the softer K + 4 G / 3"
    )
    tangential_ratio: float = Field(1.0, gt=0, description="k_t / k_n")


class PenaltyLawOptions(SpringOptions):
    """Stiffness along the normal and the tangent, where it begins to grow, and a dashpot."""

    damping: float = Field(0.0, ge=0, description="normal dashpot as a fraction of critical, at most 2 k dt")
    linear_to: float = Field(
        springs.LINEAR_TO,
        gt=0,
        description="depth l in cells from which springs grow stiffer: f = k (d + 4 (d - l)² / l)",
    )


class Springs(ForceLaw):
    """What laws of springs share: k = κ M A / h of every pair, M the softer body's K + 4 G / 3."""

    Options = SpringOptions
    options: SpringOptions
    uses_friction = True
    needs_gap = True
    softness_option = "kappa"

    def prepare(self, setup: Setup, owner: str) -> None:
        """Stiffness of the pairs."""
        if not setup.has_friction:
            for name in ("tangential_ratio", "friction_law"):
                if name in self.options.model_fields_set:
                    raise SceneError(f"contact.{owner}.{name} has no effect: every pair has friction = 0")
        self.owner, self.state, self.cell_size = owner, setup.state, setup.cell_size
        # tangential springs, where there are any, may be the stiffer ones
        self.stiffest = max(1.0, self.options.tangential_ratio) if setup.has_friction else 1.0
        self.list_pairs(setup.state)

    def list_pairs(self, state: State) -> None:
        """Facts of the pairs as arrays."""
        bodies = state.bodies
        softer = [min(bodies[p.first].p_wave_modulus, bodies[p.second].p_wave_modulus) for p in state.pairs]
        self.modulus: FloatArray = self.options.kappa * np.array(softer, dtype=float) / self.cell_size

    def compliance(self) -> FloatArray | None:
        """h / (κ M), overlap under a unit of pressure, of every pair [m/Pa]."""
        return 1.0 / self.modulus

    def expected(self, bulk_frequency: float) -> float:
        """4 κ (c / h)²."""
        return self.options.kappa * bulk_frequency**2


class PenaltyLaw(Springs):
    """A spring bears by the part of its area that lies across the normal, and changes with it without gain of energy."""

    name = "penalty"
    checks_others = True
    Options = PenaltyLawOptions
    options: PenaltyLawOptions

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.damping = self.options.damping

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:
        """Area that bears, gap without force, stiffness, motion over the step, and the tangential force."""
        tangential = 1 if friction else None
        return {"bears": 0, "rest": 0, "k": 0, "tangent_k": 0, "moved": 1, "tangential": tangential}

    def fields(self) -> list[ArrayField]:
        """What springs lose that change."""
        return [SPRING_WORK]

    def prepare(self, setup: Setup, owner: str) -> None:
        """Pairs, and the depth from which springs grow stiffer."""
        self.spring_work: FloatArray = setup.allocate(owner, SPRING_WORK)
        self.linear_to = self.options.linear_to * setup.cell_size
        super().prepare(setup, owner)

    def list_pairs(self, state: State) -> None:
        """Laws and losses of bodies that have come near."""
        super().list_pairs(state)
        self.spring_work = state.lengthen(f"{self.owner}/{SPRING_WORK.name}", len(state.pairs))

    def stiffness(self, rows: ContactRows, old: ContactRows) -> FloatArray:
        """k = κ M A / h with the area that bears; deep springs count with their tangent."""
        springs.set_springs(
            rows, rows.count, rows.own, old, old.count, old.own, self.modulus, self.stiffest,
            self.cell_size, self.linear_to, self.state.steps == 0,
        )  # fmt: skip
        return rows.own.tangent_k  # type: ignore[no-any-return]

    def forces(self, rows: ContactRows, old: ContactRows, dashpot: float, records: PairRecords) -> None:
        """Springs along the normal, a dashpot, and f_t returned to Coulomb's cone; and what the last step's springs lost."""
        springs.spring_forces(
            rows, rows.count, rows.own, old, old.count, old.own, self.options.tangential_ratio, dashpot, self.linear_to,
            records, self.spring_work,
        )  # fmt: skip

    def series(self) -> dict[str, AnyArray]:
        """What springs have lost."""
        return {"spring_work": self.spring_work.copy()}

    def restart(self) -> None:
        """Springs stay loaded; what they lost is forgotten."""
        self.spring_work.fill(0.0)


class PenaltyOptions(PenaltyLawOptions, SurfacesOptions):
    """Springs with a dashpot between surfaces: options of the law and of detection."""

    @model_validator(mode="before")
    @classmethod
    def _own_form_is_a_method(cls, values: Any) -> Any:
        for name in MOVED if isinstance(values, dict) else ():
            if name in values:
                raise ValueError(
                    f"'{name}' is no option of penalty: [H17] by its equations is a contact method of its own, "
                    'contact.method = "hamad2017"'
                )
        return values


class Penalty(ForceContact):
    """Springs between surfaces: both bodies slaves, the closest facing facet, friction with a history."""

    name = "penalty"
    Detection = Surfaces
    Law = PenaltyLaw
    Options = PenaltyOptions
    options: PenaltyOptions

    @property
    def leaves_bodies_out(self) -> bool:  # type: ignore[override]
        """Unless a master is named, who must be there, or a layer on the surfaces has a mass that moves by itself."""
        return self.options.master is None and not self.adds_mass
