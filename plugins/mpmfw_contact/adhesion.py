"""Springs that pull as well, up to a traction, and let go at a distance.

Source: D. Maugis (1992), Adhesion of spheres: the JKR-DMT transition using a Dugdale model, J. Colloid
Interface Sci. 150, 243-269: the traction between surfaces is constant, σ_0, up to a distance δ, and none
beyond; the work of adhesion is σ_0 δ. The attraction adds to the load of friction, T = μ (N + σ_0 A): B.
Derjaguin (1934), Molekulartheorie der äußeren Reibung, Z. Physik 88, 661-675. Neither paper was at hand; both
laws are textbooks'.

Assumed here: a spring of k = κ M A / h leads from pressure to σ_0, since a force that jumps has no stable
step. The force follows from the gap alone, and nothing is lost: detections whose gaps jump are refused.
"""

from __future__ import annotations

from pydantic import Field, model_validator

from mpmfw.api import ContactRows, Length, PairRecords, Pressure
from mpmfw.contact.springs import SpringArrays, SpringLaw, SpringOptions
from mpmfw.contact.surfaces import Surfaces
from mpmfw.kernels import device, kernel
from mpmfw.kernels.contact import Records, Rows
from mpmfw.kernels.types import Float


@device
def reach_of(k: Float, pull: Float, separation: Float) -> Float:
    """Gap from which on nothing acts [m]: ``separation``, or where a spring comes to its ``pull`` σ_0 A."""
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
    rows: Rows, count: int, own: SpringArrays, traction: float, separation: float, tangential_ratio: float,
    records: Records
) -> None:  # fmt: skip
    """N of every row within reach, and its pull σ_0 A, which adds to the load of friction."""
    for c in range(count):
        k, gap, pull = own.k[c], rows.gap[c], traction * rows.area[c]
        if k == 0.0 or gap >= reach_of(k, pull, separation):
            continue
        own.normal[c], own.pull[c] = normal_force(k, gap, pull, separation), pull
        own.k_t[c] = tangential_ratio * k
        records.energy[rows.pair[c]] += energy_of(k, gap, pull, separation)


class AdhesionLawOptions(SpringOptions):
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


class AdhesionLaw(SpringLaw):
    """f_n = max(−k g, −σ_0 A) up to a separation, and friction of the load f_n + σ_0 A with a history."""

    name = "adhesion"
    needs = frozenset({"gap", "steady gap"})
    Options = AdhesionLawOptions
    options: AdhesionLawOptions

    def range(self) -> float:
        """Return the separation, or where the softest springs come to the traction; 0 without tension."""
        if self.options.traction == 0.0:
            return 0.0
        softest = min(body.p_wave_modulus for body in self.state.bodies)
        spring = float(self.options.traction) * self.cell_size / (self.kappa * softest)
        return max(float(self.options.separation), spring)

    def normal_forces(self, rows: ContactRows, old: ContactRows, records: PairRecords) -> None:  # noqa: ARG002
        options = self.options
        adhesive_forces(
            rows, rows.count, rows.own, float(options.traction), float(options.separation),
            options.tangential_ratio, records
        )  # fmt: skip


class Adhesion(AdhesionLaw):
    """Springs between surfaces that pull up to a traction."""

    Detection = Surfaces
