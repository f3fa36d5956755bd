"""Damping of materials: a viscous stress beside the elastic one, proportional to the stiffness.

σ_v = τ_K K tr(D) 1 + 2 τ_G G dev(D), with the rate of deformation D = (L + Lᵀ)/2 and times τ [s]: the solid
of Kelvin and Voigt. A mode of circular frequency ω is damped by the share τ ω / 2 of critical. The stress is
isotropic in D, so that it is objective, and its power σ_v:D is never negative."""

from __future__ import annotations

from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.arithmetic import determinant
from mpmfw.kernels.types import Floats, Points
from mpmfw.plugin.base import Material
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.structs import Particles, State

WORK = Field("viscous_work", ("particle",), "J m-3", "energy lost to damping per reference volume")
DISSIPATION = Field(
    "viscous_dissipation", ("body",), "J m-1", "energy lost to the damping of the material since the run "
    "began", "series", output=True,
)  # fmt: skip


@kernel
def add_viscous_stress(
    first: int, last: int, points: Points, bulk: float, shear: float, dt: float, work: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """σ += κ tr(D) 1 + 2 η dev(D) and w += Δt J σ_v:D, of viscosities κ and η [Pa s]; D_zz = 0 in 2D."""
    dim = len(spacing)
    rate, f = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    for p in range(first, last):
        trace = 0.0
        for d in range(dim):
            trace += points.velocity_gradient[p, d, d]
            for e in range(dim):
                f[d, e] = points.deformation_gradient[p, d, e]
                rate[d, e] = 0.5 * (points.velocity_gradient[p, d, e] + points.velocity_gradient[p, e, d])
        mean, power = (bulk - 2.0 / 3.0 * shear) * trace, 0.0
        for d in range(dim):
            for e in range(dim):
                stress = 2.0 * shear * rate[d, e] + (mean if d == e else 0.0)
                power += stress * rate[d, e]
                points.stress[p, d, e] += stress
        work[p] += dt * determinant(f, spacing) * power


class Damping:
    """The damping of every material that has one; ``damped`` are materials, κ and η [Pa s]."""

    name = "material_damping"

    def __init__(self, damped: list[tuple[Material, float, float]]) -> None:
        self.damped = damped

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        damped, reasons = [], []
        for name, material in setup.materials.items():
            if (damping := setup.scene.materials[name].damping) is not None:
                bulk, shear = damping.times
                damped.append((material, bulk * material.bulk_modulus, shear * material.shear_modulus))
                reasons.append(f"{name}: bulk {bulk:.3g} s, shear {shear:.3g} s")
        return Acts("; ".join(reasons), [cls(damped)])

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return [WORK, DISSIPATION]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        self.work, self.spacing = setup.allocate(self.name, WORK), setup.state.grid.tensor_spacing

    @hookimpl
    def update_stress(self, particles: Particles, dt: float) -> None:
        for material, bulk, shear in self.damped:
            material.over_points(
                add_viscous_stress, particles, particles, bulk, shear, dt, self.work, self.spacing
            )

    def dissipated(self, state: State) -> FloatArray:
        """Return the energy that every body has lost to damping, settling included (body,) [J/m]."""
        return state.energies(self.work)

    @hookimpl
    def diagnostics(self, state: State) -> dict[str, AnyArray]:
        return {"viscous_dissipation": self.dissipated(state)}
