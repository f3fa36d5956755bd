"""Springs that pull as well, up to a traction, and let go at a distance.

Source: D. Maugis (1992), Adhesion of spheres: the JKR-DMT transition using a Dugdale model, J. Colloid Interface Sci. 150,
243-269: the traction between surfaces is constant, σ_0, up to a distance δ, and none beyond; the work of adhesion is σ_0 δ. What
surfaces attract each other by adds to the load of friction, T = μ (N + σ_0 A): B. Derjaguin (1934), Molekulartheorie der äußeren
Reibung, Z. Physik 88, 661-675. Neither paper was at hand; both laws are textbooks'.

Assumed here: a spring of k = κ M A / h leads from pressure to σ_0, since a force that jumps at contact has no stable step. The
force is a function of the gap alone, so that bodies attract each other when they approach as when they part, and nothing is lost.
"""

from __future__ import annotations

from pydantic import Field, model_validator

from mpmfw.api import ContactRows, FloatArray, ForceContact, Length, PairRecords, Pressure
from mpmfw.kernels import Struct, device, kernel
from mpmfw.kernels.contact import Records, Rows, slip_bound
from mpmfw.kernels.types import Float, Floats
from mpmfw_contact._springs import along_and_across, end_of, first_of, old_force, return_to_cone
from mpmfw_contact.penalty import SpringOptions, Springs
from mpmfw_contact.surfaces import Surfaces, SurfacesOptions


class AdhesionArrays(Struct):
    """The law's own arrays of n rows."""

    k: Floats  #: (n,) stiffness [N m^(dim−4)]
    limit_k: Floats  #: (n,) stiffness that limits the step
    tangential: Floats  #: (n, dim) tangential force; (0, dim) where there is no friction


@device
def reach_of(k: Float, pull: Float, separation: Float) -> Float:
    """Gap from which on nothing acts: ``separation``, or where the spring of stiffness k comes to its ``pull`` σ_0 A [m]."""
    return max(separation, pull / k)


@device
def normal_force(k: Float, gap: Float, pull: Float, separation: Float) -> Float:
    """max(−k g, −σ_0 A) within reach, else 0."""
    if gap >= reach_of(k, pull, separation):
        return 0.0
    return max(-k * gap, -pull)


@device
def energy_of(k: Float, gap: Float, pull: Float, separation: Float) -> Float:
    """Work that brings a place from afar to a gap, negative where bodies stick together [J m^(dim−3)]."""
    reach = reach_of(k, pull, separation)
    if gap >= reach:
        return 0.0
    full = pull / k
    if gap >= full:
        return -pull * (reach - gap)
    return 0.5 * k * (gap * gap - full * full) - pull * (reach - full)


@kernel
def adhesive_forces(
    rows: Rows, count: int, own: AdhesionArrays, old: Rows, old_count: int, old_own: AdhesionArrays, traction: float,
    separation: float, tangential_ratio: float, records: Records,
) -> None:  # fmt: skip
    """f = f_n n + f_t of every row within reach; f_t is the last step's, less k_t times the slip, within μ (f_n + σ_0 A) + a.

    The pairs' works are added to, their energies written.
    """
    dim, has_friction = rows.normal.shape[1], len(own.tangential) > 0
    records.energy[:] = 0.0
    for c in range(count):
        for d in range(dim):
            rows.force[c, d] = 0.0
            if has_friction:
                own.tangential[c, d] = 0.0
        k, pull, gap, p = own.k[c], traction * rows.area[c], rows.gap[c], rows.pair[c]
        if k == 0.0 or gap >= reach_of(k, pull, separation):
            continue
        f_n = normal_force(k, gap, pull, separation)
        records.energy[p] += energy_of(k, gap, pull, separation)
        for d in range(dim):
            rows.force[c, d] = f_n * rows.normal[c, d]
        if has_friction:
            share = 1.0 / (end_of(c, count, rows.identity) - first_of(c, rows.identity))
            old_force(c, rows.before[c], rows, old, old_count, old_own.tangential, share, own.tangential)
            along, _ = along_and_across(c, rows)
            for d in range(dim):
                own.tangential[c, d] -= tangential_ratio * k * (rows.motion[c, d] - along * rows.normal[c, d])
            limit = slip_bound(rows, c, f_n + pull)
            lost, stored = return_to_cone(c, limit, tangential_ratio * k, own.tangential)
            records.frictional_work[p] += lost
            records.energy[p] += stored
            for d in range(dim):
                rows.force[c, d] += own.tangential[c, d]


class AdhesionLawOptions(SpringOptions):
    """Those of springs, and what they pull with."""

    traction: Pressure = Field(0.0, ge=0, description="largest tension between the surfaces, sigma_0")
    separation: Length = Field(
        0.0,
        ge=0,
        description="distance at which they let go; at least where the springs come to the traction",
    )

    @model_validator(mode="after")
    def _separation_has_an_effect(self) -> AdhesionLawOptions:
        if self.separation > 0.0 and self.traction == 0.0:
            raise ValueError("'separation' has no effect without tension; expected traction > 0")
        return self


class AdhesionLaw(Springs):
    """f_n = max(−k g, −σ_0 A) up to a separation, and friction of the load f_n + σ_0 A with a history."""

    name = "adhesion"
    Options = AdhesionLawOptions
    options: AdhesionLawOptions

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:
        """Stiffness, and the tangential force."""
        return {"k": 0, "limit_k": 0, "tangential": 1 if friction else None}

    def widest_gap(self) -> float:
        """The separation, or where the springs of the softest body come to the traction; nothing without tension."""
        if self.options.traction == 0.0:
            return 0.0
        softest = min(body.p_wave_modulus for body in self.state.bodies)
        spring = float(self.options.traction) * self.cell_size / (self.options.kappa * softest)
        return max(float(self.options.separation), spring)

    def stiffness(self, rows: ContactRows, old: ContactRows) -> FloatArray:  # noqa: ARG002
        """k = κ M A / h."""
        own, n = rows.own, slice(rows.count)
        own.k[n] = self.modulus[rows.pair[n]] * rows.area[n]
        own.limit_k[n] = self.stiffest * own.k[n]
        return own.limit_k  # type: ignore[no-any-return]

    def forces(self, rows: ContactRows, old: ContactRows, dashpot: float, records: PairRecords) -> None:  # noqa: ARG002
        """Tension up to the traction, and friction."""
        options = self.options
        adhesive_forces(
            rows, rows.count, rows.own, old, old.count, old.own, float(options.traction), float(options.separation),
            options.tangential_ratio, records,
        )  # fmt: skip


class AdhesionOptions(AdhesionLawOptions, SurfacesOptions):
    """Those of the law and of the surfaces."""


class Adhesion(ForceContact):
    """Springs between surfaces that pull up to a traction."""

    name = "adhesion"
    Detection = Surfaces
    Law = AdhesionLaw
    Options = AdhesionOptions
