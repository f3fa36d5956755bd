"""Soils: elastic in the logarithmic strain, with strength that grows with pressure."""

from __future__ import annotations

import math
from typing import ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from mpmfw.api import Field as ArrayField
from mpmfw.api.types import FloatArray, Particles, Setup, State, hookimpl
from mpmfw.api.units import Angle, Pressure
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.arithmetic import invert
from mpmfw.kernels.types import Floats
from mpmfw_material._isotropic import Moduli, pad_plane_strain
from mpmfw_material._plastic import (
    MODULUS,
    OPENED,
    SPACE,
    Flow,
    Plastic,
    compose,
    diagonalise,
    pad,
    push_forward,
)
from mpmfw_material._return import closing_volume, norm_square, return_stiffened, wave_modulus

#: Logarithm of the volume beyond which points no longer touch: what has opened so far opens no further.
SEPARATED = math.log(2.0)

#: Largest trace of C_p⁻¹, about |F|²: the product F C_p⁻¹ Fᵀ loses digits with its square.
DISTORTED = 1e4


@device
def restart_shape(f: Floats, jacobian: float, excess: float, axes: int, out: Floats) -> None:
    """Replace F along the grid's ``axes``, in ``f`` and ``out``, by a swelling of volume J exp(−``excess``).

    Soil has no memory of its shape: with the metric that belongs to the new F its elastic strain remains."""
    volume = jacobian / f[2, 2] if axes == 2 else jacobian
    edge = (volume * math.exp(-excess)) ** (1.0 / axes)
    for d in range(axes):
        for e in range(axes):
            f[d, e] = out[d, e] = edge if d == e else 0.0


@kernel
def frictional_stress(
    first: int, last: int, deformation_gradient: Floats, volume: Floats, flow: Flow, opened: Floats,
    stress: Floats, modulus: Floats, bulk: float, shear: float, surface: tuple[float, float, float],
    tension: float, cone: bool, stiffening: tuple[float, float], spacing: tuple[float, ...], axes: int,
) -> None:  # fmt: skip
    """σ = τ / J, with τ_a = (K − 2 G / 3) Σ ε + 2 G ε_a of ε = ½ ln F C_p⁻¹ Fᵀ, returned to the surface.

    With ``stiffening`` (m > 0, p₀) that is t of :mod:`mpmfw_material._return`, ``bulk`` is K', and
    ``modulus`` (n,) becomes that of waves.

    Plastic work is that of the stress after the return. Volume that tension ``opened`` (n,), as a logarithm,
    closes before there is pressure again. Beyond ``SEPARATED`` it opens no further: F and V become smaller.
    """
    dim = len(spacing)
    f, matrix = scratch.matrix(SPACE, SPACE), scratch.matrix(SPACE, SPACE)
    b, vectors = scratch.matrix(SPACE, SPACE), scratch.matrix(SPACE, SPACE)
    values, strain, tau = scratch.vector(SPACE), scratch.vector(SPACE), scratch.vector(SPACE)
    for p in range(first, last):
        pad(deformation_gradient, p, f, spacing)
        push_forward(f, flow.metric[p], b)
        diagonalise(b, values, vectors)
        for a in range(3):
            strain[a] = 0.5 * math.log(values[a])
        closed = closing_volume(opened[p], strain, bulk, shear, stiffening)
        opened[p] -= closed
        volumetric = strain[0] + strain[1] + strain[2] + closed
        for a in range(3):
            strain[a] += closed / 3.0
            tau[a] = (bulk - 2.0 / 3.0 * shear) * volumetric + 2.0 * shear * strain[a]
        flows, factor = return_stiffened(tau, bulk, shear, surface, tension, cone, stiffening)
        shift = (factor - 1.0) * stiffening[1]
        if stiffening[0] > 0.0:
            modulus[p] = wave_modulus(tau, bulk, shear, stiffening, factor)
        for a in range(3):
            values[a] = factor * tau[a] - shift
        compose(values, vectors, b)
        jacobian = invert(f, matrix, SPACE)
        for i in range(dim):
            for j in range(dim):
                stress[p, i, j] = b[i, j] / jacobian
        if flows or closed > 0.0:
            pressure = (tau[0] + tau[1] + tau[2]) / 3.0
            square = 0.0
            for a in range(3):
                elastic = (tau[a] - pressure) / (2.0 * shear) + pressure / (3.0 * bulk)
                plastic = strain[a] - elastic
                flow.work[p] += values[a] * plastic
                square += (plastic - (volumetric - pressure / bulk) / 3.0) ** 2
                values[a] = math.exp(2.0 * elastic)
            flow.strain[p] += math.sqrt(2.0 / 3.0 * square)
            if flows and pressure >= (tension + shift) / factor - 1e-12 * bulk:
                opened[p] += volumetric - pressure / bulk
            compose(values, vectors, b)
            distorted = flow.metric[p, 0, 0] + flow.metric[p, 1, 1] + flow.metric[p, 2, 2] > DISTORTED
            if opened[p] > SEPARATED or distorted:
                excess = max(opened[p] - SEPARATED, 0.0)
                opened[p] -= excess
                volume[p] *= math.exp(-excess)
                restart_shape(f, jacobian, excess, axes, deformation_gradient[p])
                invert(f, matrix, SPACE)
            push_forward(matrix, b, flow.metric[p])


class FrictionalOptions(Moduli):
    friction_angle: Angle = Field(ge=0, lt=math.pi / 2, description="angle of friction φ")
    dilation_angle: Angle = Field(0.0, ge=0, lt=math.pi / 2, description="angle of dilation ψ, at most φ")
    cohesion: Pressure = Field(0.0, ge=0, description="cohesion c")
    tension: Pressure | None = Field(
        None,
        ge=0,
        description="largest mean tension, at most that of the apex, c cot φ; left out, that of the apex",
    )
    pressure_exponent: float = Field(
        0.0, ge=0, lt=0.95, description="n: K and G grow as (1 + p/reference_pressure)^n with the pressure p"
    )
    reference_pressure: Pressure | None = Field(
        None,
        gt=0,
        description="pressure at which K and G are 2^n times those at small strain",
    )

    def apex(self) -> float:
        """Return the mean tension at which no shear is left, c cot φ [Pa]."""
        return self.cohesion / math.tan(self.friction_angle) if self.friction_angle > 0.0 else math.inf

    def largest_tension(self) -> float:
        """Return the mean tension that is cut off [Pa]: ``tension``, or that of the apex."""
        return self.apex() if self.tension is None else self.tension

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        """Refuse ψ > φ, which makes energy, strength that is zero, and a cut-off that does nothing."""
        if self.dilation_angle > self.friction_angle:
            raise ValueError("dilation_angle: expected at most friction_angle")
        if self.friction_angle == 0.0 and self.cohesion == 0.0:
            raise ValueError("friction_angle and cohesion: expected at least one above zero")
        if self.tension is not None and self.tension > self.apex():
            raise ValueError(f"tension: expected at most c cot φ, {self.apex():.4g} Pa")
        if (self.reference_pressure is None) != (self.pressure_exponent == 0.0):
            raise ValueError("pressure_exponent and reference_pressure: expected both or neither")
        if self.reference_pressure is not None and self.reference_pressure <= self.largest_tension():
            limit = self.largest_tension()
            if math.isinf(limit):
                raise ValueError("tension: with reference_pressure, expected a cut-off where φ is zero")
            raise ValueError(f"reference_pressure: expected above the largest mean tension, {limit:.4g} Pa")
        return self


class Frictional(Plastic):
    """Base of ``drucker_prager`` and ``mohr_coulomb``."""

    Options = FrictionalOptions
    options: FrictionalOptions
    isochoric = True
    history_fields = (*Plastic.history_fields, OPENED)
    #: True for the cone of Drucker and Prager, False for the planes of Mohr and Coulomb.
    cone: ClassVar[bool]

    def surface(self) -> tuple[float, float, float]:
        """Slopes of yield surface and plastic potential [1], and strength without pressure [Pa]."""
        raise NotImplementedError

    @property
    def dilates(self) -> bool:
        return bool(self.options.dilation_angle > 0.0)

    @property
    def elasticity(self) -> tuple[float, float, tuple[float, float]]:
        """Return K' = (1 − n) K, G and (m, p₀) of :mod:`mpmfw_material._return`; K, G and m = 0 if n is 0."""
        n, reference = self.options.pressure_exponent, self.options.reference_pressure
        return self.bulk_modulus * (1.0 - n), self.shear_modulus, (n / (1.0 - n), reference or 1.0)

    @hookimpl
    def declare_fields(self) -> list[ArrayField]:
        return [*super().declare_fields(), *([MODULUS] if self.options.pressure_exponent else [])]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        super().setup(setup)
        self.opened, self.axes = self.shared(setup, OPENED), setup.dim
        stiffens = self.options.pressure_exponent > 0.0
        self.modulus = self.shared(setup, MODULUS) if stiffens else np.empty(0)
        bulk, shear, stiffening = self.elasticity
        limit = self.options.largest_tension()
        self.constants = bulk, shear, self.surface(), limit, self.cone, stiffening

    @hookimpl
    def update_stress(self, particles: Particles) -> None:
        self.over_points(
            frictional_stress, particles, particles.deformation_gradient, particles.volume, self.flow,
            self.opened, particles.stress, self.modulus, *self.constants, self.spacing, self.axes
        )  # fmt: skip

    @hookimpl
    def stable_timestep(self, state: State) -> tuple[float, str] | None:  # noqa: ARG002
        """Return 2 / ω of the stiffest point [s], if moduli grow with pressure."""
        if not len(self.modulus):
            return None
        frequency = self.bulk_frequency * math.sqrt(self.stiffest() / super().stiffest())
        return 2.0 / frequency, f"bulk under pressure ({self.name})"

    def stiffest(self) -> float:
        own = self.slices if len(self.modulus) else []
        return max([super().stiffest(), *(float(self.modulus[each].max()) for each in own)])

    def set_stress(self, own: slice, stress: FloatArray) -> bool:
        """Take the elastic strain of the stress, and so the plastic metric: ½ ln b_e of b_e = C_p⁻¹."""
        bulk, shear, (power, reference) = self.elasticity
        if power:
            square = norm_square(stress.T, bulk, shear, reference)[:, None]
            stress = reference + (stress - reference) * square ** (-0.5 * power / (1.0 + power))
        mean = stress.mean(axis=1, keepdims=True)
        strain = (stress - mean) / (2.0 * shear) + mean / (3.0 * bulk)
        self.flow.metric[own] = np.exp(2.0 * strain)[:, :, None] * np.eye(3)
        return True

    def _strain(self, particles: Particles, own: slice) -> tuple[FloatArray, FloatArray, FloatArray]:
        """J (n,), and the elastic strain ½ ln b_e as eigenvalues (n, 3) and eigenvectors (n, 3, 3)."""
        f = pad_plane_strain(particles.deformation_gradient[own])
        b = np.einsum("nia,nab,njb->nij", f, self.flow.metric[own], f)
        values, vectors = np.linalg.eigh(b)
        return np.linalg.det(f), 0.5 * np.log(values), vectors

    def energy_of_points(self, particles: Particles, own: slice) -> FloatArray:
        """Elastic energy, (n,) [J/m^3]: W = K/2 (Σ ε)² + G Σ (ε − Σ ε / 3)² of constant moduli."""
        bulk, shear, (power, reference) = self.elasticity
        _, strain, _ = self._strain(particles, own)
        volumetric = strain.sum(1)
        if power:
            square = norm_square(_linear_stress(strain, bulk, shear).T, bulk, shear, reference)
            scale = reference**2 / ((2.0 + power) * bulk)
            return np.asarray(scale * (square ** (1.0 + 0.5 * power) - 1.0) + reference * volumetric)
        deviator = strain - volumetric[:, None] / 3.0
        energy: FloatArray = shear * (deviator**2).sum(1)
        energy += 0.5 * bulk * volumetric**2
        return energy

    def stress_of_points(self, particles: Particles, own: slice) -> FloatArray:
        bulk, shear, (power, reference) = self.elasticity
        jacobian, strain, vectors = self._strain(particles, own)
        tau = _linear_stress(strain, bulk, shear)
        if power:
            factor = norm_square(tau.T, bulk, shear, reference)[:, None] ** (0.5 * power)
            tau = reference + factor * (tau - reference)
        stress: FloatArray = np.einsum("nia,na,nja->nij", vectors, tau / jacobian[:, None], vectors)
        return stress


def _linear_stress(strain: FloatArray, bulk: float, shear: float) -> FloatArray:
    """Return (K − 2 G / 3) Σ ε + 2 G ε (n, 3) [Pa]."""
    result: FloatArray = (bulk - 2.0 / 3.0 * shear) * strain.sum(1)[:, None] + 2.0 * shear * strain
    return result
