"""Laws of springs: a law gives the normal force of its rows, and one stage adds friction.

f = N n + f_t. The tangential force f_t is that of the last step in the row's plane, less k_t times the
slip since, returned to Coulomb's cone: a spring and a slider in a row.
"""

from __future__ import annotations

import numpy as np
from pydantic import Field

from mpmfw.contact.forces import ForceLaw
from mpmfw.contact.law import PairRecords
from mpmfw.contact.rows import ContactRows
from mpmfw.errors import SceneError
from mpmfw.kernels import Struct, device, kernel
from mpmfw.kernels.contact import Records, Rows, add_turned, slip_limit
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw.plugin.base import OptionsModel
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import State


class SpringArrays(Struct):
    """Arrays of n rows that every law of springs has."""

    effective_area: Floats  #: (n,) area that carries force [m^(dim−1)]
    k: Floats  #: (n,) normal stiffness [N m^(dim−4)]
    limit_k: Floats  #: (n,) stiffness that limits the step [N m^(dim−4)]
    normal: Floats  #: (n,) N, the normal force, along the row's normal [N m^(dim−3)]
    pull: Floats  #: (n,) adhesion, which adds to the load of friction [N m^(dim−3)]
    k_t: Floats  #: (n,) tangential stiffness [N m^(dim−4)]; 0 of a row on which nothing acts
    entered: Floats  #: (n,) part of the step that the row spent in contact: 1 but in the first step
    tangential: Floats  #: (n, dim) f_t; (0, dim) where there is no friction


@device
def end_of(c: int, count: int, identity: Ints) -> int:
    """The row behind those that have the identity of row c."""
    e = c + 1
    while e < count and identity[e] == identity[c]:
        e += 1
    return e


@device
def first_of(c: int, identity: Ints) -> int:
    """The first row with the identity of row c."""
    while c > 0 and identity[c - 1] == identity[c]:
        c -= 1
    return c


@device
def approach_of(c: int, rows: Rows) -> Float:
    """Part of row c's motion along its normal [m], negative where its sides approach."""
    along = 0.0
    for d in range(rows.normal.shape[1]):
        along += rows.motion[c, d] * rows.normal[c, d]
    return along


@kernel
def add_friction(
    rows: Rows, count: int, own: SpringArrays, old: Rows, old_count: int, old_own: SpringArrays,
    records: Records, change: Floats,
) -> None:  # fmt: skip
    """Write f = N n + f_t of every row, with the law's N, k_t, pull and area; and add the works of friction.

    Rows of one place share its force by their areas. Friction dissipates |f_t| Δs / k_t of the trial force
    beyond the limit, and ½ f_t² / k_t is stored; both are taken from ``change`` (pair,), if it has pairs.
    """
    dim, has_friction = rows.normal.shape[1], len(own.tangential) > 0
    for c in range(count):
        for d in range(dim):
            rows.force[c, d] = own.normal[c] * rows.normal[c, d]
        if not has_friction:
            continue
        for d in range(dim):
            own.tangential[c, d] = 0.0
        k_t, p, o, total = own.k_t[c], rows.pair[c], rows.previous[c], 0.0
        if k_t == 0.0:
            continue
        if o >= 0:
            for i in range(o, end_of(o, old_count, old.identity)):
                if old_own.k_t[i] > 0.0:
                    add_turned(old_own.tangential, i, old, c, rows, own.tangential)
        for i in range(first_of(c, rows.identity), end_of(c, count, rows.identity)):
            total += own.effective_area[i]
        share = own.effective_area[c] / total if total > 0.0 else 0.0
        approach, square = approach_of(c, rows), 0.0
        for d in range(dim):
            slip = rows.motion[c, d] - approach * rows.normal[c, d]
            own.tangential[c, d] = share * own.tangential[c, d] - k_t * own.entered[c] * slip
            square += own.tangential[c, d] * own.tangential[c, d]
        size = square**0.5
        held = min(size, slip_limit(rows, c, own.normal[c] + own.pull[c]))
        for d in range(dim):
            own.tangential[c, d] *= held / size if size > held else 1.0
            rows.force[c, d] += own.tangential[c, d]
        lost, stored = held * (size - held) / k_t, 0.5 * held * held / k_t
        records.frictional_work[p] += lost
        records.energy[p] += stored
        if len(change) > 0:
            change[p] -= lost + stored


#: κ where a scene names none, by dimension. In space bodies are few cells wide, and stiff springs add to
#: elements that are too stiff already (docs/guide/stability.md).
KAPPA = {2: 4.0, 3: 1.0}


class SpringOptions(OptionsModel):
    kappa: float | None = Field(
        None,
        gt=0,
        description="stiffness factor: k = kappa M area / h, M the softer K + 4 G / 3; if left out, 4 in 2D "
        "and 1 in 3D",
    )
    tangential_ratio: float = Field(1.0, gt=0, description="k_t / k_n")


class SpringLaw(ForceLaw):
    """Base of laws of springs: k = κ M A / h of every row, M the softer body's K + 4 G / 3.

    A law writes N, k_t and pull of its rows in :meth:`normal_forces`; :func:`add_friction` does the rest.
    """

    Options = SpringOptions
    options: SpringOptions
    needs = frozenset({"gap"})
    uses_friction = True
    softness_option = "kappa"

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:
        names = [name for name in SpringArrays.member_names if name != "tangential"]
        return {**dict.fromkeys(names, 0), "tangential": 1 if friction else None}

    def prepare(self, setup: Setup) -> None:
        """Choose κ; refuse options of friction where no pair has friction."""
        if not setup.has_friction:
            for name in ("tangential_ratio", "friction_law"):
                if name in self.options.model_fields_set:
                    raise SceneError(
                        "has no effect, since every pair has friction = 0", key=f"contact.{self.name}.{name}"
                    )
        given = self.options.kappa
        self.kappa = KAPPA[setup.state.particles.dim] if given is None else given
        # tangential springs, where there are any, may be the stiffer ones
        self.stiffest = max(1.0, self.options.tangential_ratio) if setup.has_friction else 1.0
        #: Energy that springs lose as they change (pair,) [J m^(dim−3)]; (0,) where none do.
        self.change = np.zeros(0)

    def list_pairs(self, state: State) -> None:
        """List also κ M / h of the pairs [Pa/m]."""
        bodies = state.bodies
        softer = [min(bodies[p.first].p_wave_modulus, bodies[p.second].p_wave_modulus) for p in state.pairs]
        self.modulus: FloatArray = self.kappa * np.array(softer, dtype=float) / self.cell_size
        super().list_pairs(state)

    def compliance(self) -> FloatArray | None:
        """Return h / (κ M), the overlap under a unit of pressure, of every pair [m/Pa]."""
        return 1.0 / self.modulus

    def estimate_frequency(self, bulk_frequency: float) -> float:
        return self.kappa * bulk_frequency**2

    def stiffness(self, rows: ContactRows, old: ContactRows) -> FloatArray:  # noqa: ARG002
        """Write k = κ M A / h of the whole area; return the stiffer of normal and tangential."""
        own, n = rows.own, slice(rows.count)
        own.effective_area[n] = rows.area[n]
        own.k[n] = self.modulus[rows.pair[n]] * rows.area[n]
        own.limit_k[n] = self.stiffest * own.k[n]
        return own.limit_k  # type: ignore[no-any-return]

    def normal_forces(self, rows: ContactRows, old: ContactRows, records: PairRecords) -> None:
        """Write N and k_t of the rows on which the law acts, and add to the pairs' energies. N, k_t and pull
        are 0 before, entered is 1."""
        raise NotImplementedError

    def forces(self, rows: ContactRows, old: ContactRows, dashpot: float, records: PairRecords) -> None:
        own, n, self.dashpot = rows.own, slice(rows.count), dashpot
        records.energy.fill(0.0)
        own.normal[n] = own.pull[n] = own.k_t[n] = 0.0
        own.entered[n] = 1.0
        self.normal_forces(rows, old, records)
        add_friction(rows, rows.count, own, old, old.count, old.own, records, self.change)
