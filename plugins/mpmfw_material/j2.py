"""Metal plasticity: von Mises' yield criterion at finite strain, with isotropic hardening, linear or after
Johnson & Cook (1985) without their softening by temperature; plane strain in 2D."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field, model_validator

from mpmfw.api.types import FloatArray, Particles, Setup, hookimpl
from mpmfw.api.units import Pressure, quantity
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.arithmetic import determinant, invert
from mpmfw.kernels.types import Float, Floats
from mpmfw_material._isotropic import Moduli, pad_plane_strain
from mpmfw_material._plastic import SPACE, Flow, Plastic, pad

ROOT = math.sqrt(2.0 / 3.0)


@device
def elastic_metric(p: int, f: Floats, flow: Flow, out: Floats) -> Float:
    """b_e = J^(−2/3) F C_p⁻¹ Fᵀ to ``out`` (3, 3); return J."""
    jacobian = determinant(f, SPACE)
    scale = math.exp(-2.0 / 3.0 * math.log(jacobian))
    for i in range(3):
        for j in range(3):
            out[i, j] = 0.0
            for a in range(3):
                for b in range(3):
                    out[i, j] += scale * f[i, a] * flow.metric[p, a, b] * f[j, b]
    return jacobian


@device
def isochoric_mean(s: Floats, norm: Float, shear: Float, mean: Float) -> Float:
    """x with det(s/G + x 1) = 1, from ``mean`` by Newton's method: x³ − |s|² x / (2 G²) + det(s)/G³ = 1."""
    second, third = -0.5 * (norm / shear) ** 2, determinant(s, SPACE) / shear**3 - 1.0
    for _ in range(20):
        change = (mean**3 + second * mean + third) / (3.0 * mean * mean + second)
        mean -= change
        if abs(change) < 1e-15:
            break
    return mean


@device
def set_plastic_metric(p: int, f: Floats, jacobian: Float, be: Floats, flow: Flow) -> None:
    """C_p⁻¹ = J^(2/3) F⁻¹ b_e F⁻ᵀ."""
    inverse = scratch.matrix(SPACE, SPACE)
    invert(f, inverse, SPACE)
    scale = math.exp(2.0 / 3.0 * math.log(jacobian))
    for i in range(3):
        for j in range(3):
            total = 0.0
            for a in range(3):
                for b in range(3):
                    total += scale * inverse[i, a] * be[a, b] * inverse[j, b]
            flow.metric[p, i, j] = total


@device
def johnson_cook_slip(
    excess: Float, stiffness: Float, strain: Float, yield_stress: float, hardening: float, exponent: float,
    rate: float, times: Float,
) -> Float:  # fmt: skip
    """Δα of ``excess`` − ``stiffness`` Δα = (σ_y + H (α + Δα)^n) (1 + C ln(Δα ``times``)), the logarithm at
    least 0: Newton's method, within the bounds known so far. The left side is the stress over √(2/3)."""
    low, high = 0.0, excess / stiffness
    found = high
    for _ in range(60):
        total = strain + found
        static, fast = yield_stress + hardening * total**exponent, found * times > 1.0
        factor = 1.0 + (rate * math.log(found * times) if fast else 0.0)
        left = excess - stiffness * found - static * factor
        if left > 0.0:
            low = found
        else:
            high = found
        slope = stiffness + factor * hardening * exponent * total ** (exponent - 1.0)
        slope += static * rate / found if fast else 0.0
        change = left / slope
        if abs(change) <= 1e-12 * found:
            break
        found += change
        if not low < found < high:
            found = 0.5 * (low + high)
    return found


@kernel
def j2_stress(
    first: int, last: int, deformation_gradient: Floats, flow: Flow, stress: Floats, bulk: float,
    shear: float, yield_stress: float, hardening: float, exponent: float, rate: float, times: float,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """σ = K/2 (J − 1/J) 1 + s/J, |s| ≤ √(2/3) (σ_y + H α^n) (1 + C ln(Δα ``times``)): elastic predictor
    s = G dev b_e, and its radial return. ``times`` is 1/(Δt ε̇₀).

    Simo & Hughes (1998), box 9.1, with tr b_e after the return from det b_e = 1. Plastic work is that of the
    mean of the yield stresses before and after, at the rate of the step.
    """
    dim, linear = len(spacing), exponent == 1.0 and rate == 0.0
    f, be = scratch.matrix(SPACE, SPACE), scratch.matrix(SPACE, SPACE)
    for p in range(first, last):
        pad(deformation_gradient, p, f, spacing)
        jacobian = elastic_metric(p, f, flow, be)
        mean = (be[0, 0] + be[1, 1] + be[2, 2]) / 3.0
        square = 0.0
        for i in range(3):
            be[i, i] -= mean
        for i in range(3):
            for j in range(3):
                be[i, j] *= shear  # s now
                square += be[i, j] * be[i, j]
        before = yield_stress + hardening * (flow.strain[p] if linear else flow.strain[p] ** exponent)
        norm, limit = math.sqrt(square), ROOT * before
        yields = norm > limit
        if yields:
            effective = shear * mean
            if linear:
                slip = (norm - limit) / (2.0 * effective + 2.0 / 3.0 * hardening)
            else:
                slip = johnson_cook_slip(
                    norm / ROOT, 3.0 * effective, flow.strain[p], yield_stress, hardening, exponent, rate,
                    times,
                ) / ROOT  # fmt: skip
            factor = 1.0 - 2.0 * effective * slip / norm
            for i in range(3):
                for j in range(3):
                    be[i, j] *= factor
            flow.strain[p] += ROOT * slip
            if linear:
                flow.work[p] += (before + 0.5 * hardening * ROOT * slip) * ROOT * slip
            else:
                after = yield_stress + hardening * flow.strain[p] ** exponent
                flow.work[p] += 0.5 * (before / after + 1.0) * norm * factor * slip
            norm *= factor
        pressure = 0.5 * bulk * (jacobian - 1.0 / jacobian)
        for i in range(dim):
            for j in range(dim):
                stress[p, i, j] = be[i, j] / jacobian + (pressure if i == j else 0.0)
        if yields:
            mean = isochoric_mean(be, norm, shear, mean)
            for i in range(3):
                for j in range(3):
                    be[i, j] = be[i, j] / shear + (mean if i == j else 0.0)
            set_plastic_metric(p, f, jacobian, be, flow)


class J2Options(Moduli):
    yield_stress: Pressure = Field(gt=0, description="yield stress σ_y under uniaxial tension (Kirchhoff's)")
    hardening_modulus: Pressure = Field(
        0.0, ge=0, description="rise H of the yield stress with the equivalent plastic strain α"
    )
    hardening_exponent: float = Field(
        1.0, gt=0, le=1, description="n of the hardening H α^n (Johnson & Cook)"
    )
    rate_factor: float = Field(
        0.0,
        ge=0,
        description="C of the factor 1 + C ln(rate of α / reference_rate), at least 1 (Johnson & Cook)",
    )
    reference_rate: quantity("1/s") = Field(  # type: ignore[valid-type]
        1.0, gt=0, description="rate of α below which it has no effect (Johnson & Cook)"
    )

    @model_validator(mode="after")
    def _options_have_an_effect(self) -> J2Options:
        for name, other in (("hardening_exponent", "hardening_modulus"), ("reference_rate", "rate_factor")):
            if name in self.model_fields_set and getattr(self, other) == 0.0:
                raise ValueError(f"'{name}' has no effect without '{other}'")
        return self


class J2(Plastic):
    """Elastic as ``neo_hookean``, and von Mises plasticity: it flows at constant volume under σ_y + H α.

    The history of a point is C_p⁻¹, the inverse of the plastic right Cauchy-Green tensor, and α.
    """

    name = "j2"
    isochoric = True
    Options = J2Options
    options: J2Options

    @hookimpl
    def setup(self, setup: Setup) -> None:
        super().setup(setup)
        o = self.options
        self.constants = (
            o.bulk_modulus, o.shear_modulus, o.yield_stress, o.hardening_modulus, o.hardening_exponent,
            o.rate_factor,
        )  # fmt: skip

    @hookimpl
    def update_stress(self, particles: Particles, dt: float) -> None:
        f, stress = particles.deformation_gradient, particles.stress
        times = 1.0 / (dt * self.options.reference_rate) if dt > 0.0 else 0.0
        self.over_points(j2_stress, particles, f, self.flow, stress, *self.constants, times, self.spacing)

    def _elastic(self, particles: Particles, own: slice) -> tuple[FloatArray, FloatArray]:
        """J and b_e of points."""
        f = pad_plane_strain(particles.deformation_gradient[own])
        jacobian = np.linalg.det(f)
        be = np.einsum("nia,nab,njb->nij", f, self.flow.metric[own], f)
        return jacobian, be * jacobian[:, None, None] ** (-2.0 / 3.0)

    def energy_of_points(self, particles: Particles, own: slice) -> FloatArray:
        """Elastic energy W = K/2 [(J² − 1)/2 − ln J] + G/2 (tr b_e − 3), (n,) [J/m^3]."""
        jacobian, be = self._elastic(particles, own)
        volumetric = 0.5 * self.bulk_modulus * (0.5 * (jacobian**2 - 1.0) - np.log(jacobian))
        energy: FloatArray = volumetric + 0.5 * self.shear_modulus * (np.einsum("nii->n", be) - 3.0)
        return energy

    def stress_of_points(self, particles: Particles, own: slice) -> FloatArray:
        jacobian, be = self._elastic(particles, own)
        mean = np.einsum("nii->n", be)[:, None, None] / 3.0
        pressure = 0.5 * self.bulk_modulus * (jacobian - 1.0 / jacobian)
        deviator = self.shear_modulus / jacobian[:, None, None] * (be - mean * np.eye(3))
        stress: FloatArray = deviator + pressure[:, None, None] * np.eye(3)
        return stress
