"""Soils: elastic in the logarithmic strain, with strength that grows with pressure."""

from __future__ import annotations

import math
from typing import ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from mpmfw.api.types import FloatArray, Particles, Setup, hookimpl
from mpmfw.api.units import Angle, Pressure
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.arithmetic import invert
from mpmfw.kernels.types import Float, Floats
from mpmfw_material._isotropic import Moduli, pad_plane_strain
from mpmfw_material._plastic import OPENED, SPACE, Flow, Plastic, pad
from mpmfw_material._principal import compose, diagonalise, push_forward

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


@device
def return_to_cone(tau: Floats, bulk: float, shear: float, surface: tuple[float, float, float]) -> bool:
    """Return principal stresses to √J₂ + η p ≤ k, with the flow of √J₂ + η̄ p; ``surface`` is (η, η̄, k).

    de Souza Neto, Perić & Owen (2008), boxes 8.8 and 8.9: on the cone Δγ = f / (G + K η η̄), else its apex.
    """
    friction, dilation, cohesion = surface
    p = (tau[0] + tau[1] + tau[2]) / 3.0
    root = math.sqrt(0.5 * ((tau[0] - p) ** 2 + (tau[1] - p) ** 2 + (tau[2] - p) ** 2))
    excess = root + friction * p - cohesion
    if excess <= 0.0:
        return False
    slip = excess / (shear + bulk * friction * dilation)
    if shear * slip < root:
        mean, factor = p - bulk * dilation * slip, 1.0 - shear * slip / root
    else:
        mean, factor = cohesion / friction, 0.0
    for a in range(3):
        tau[a] = mean + factor * (tau[a] - p)
    return True


@device
def flow_stress(a: int, plane: tuple[int, int], bulk: float, shear: float, dilation: float) -> Float:
    """(D r)_a for the flow r = (1 + sin ψ) e_i − (1 − sin ψ) e_j of the plane (i, j)."""
    along = (1.0 + dilation if a == plane[0] else 0.0) - (1.0 - dilation if a == plane[1] else 0.0)
    return 2.0 * shear * along + (bulk - 2.0 / 3.0 * shear) * 2.0 * dilation


@device
def fall(
    of: tuple[int, int], by: tuple[int, int], bulk: float, shear: float, friction: float, dilation: float
) -> Float:
    """Fall of the yield function of one plane per unit of flow on another: n · D r, symmetric."""
    return (1.0 + friction) * flow_stress(of[0], by, bulk, shear, dilation) - (1.0 - friction) * flow_stress(
        of[1], by, bulk, shear, dilation
    )


@device
def return_to_pyramid(tau: Floats, bulk: float, shear: float, surface: tuple[float, float, float]) -> bool:
    """Return principal stresses to f = (1 + sin φ) τ_i − (1 − sin φ) τ_j − 2 c cos φ ≤ 0 of all planes.

    ``surface`` is (sin φ, sin ψ, 2 c cos φ). With τ₁ ≥ τ₂ ≥ τ₃ flow is on the plane (1, 3); on the edge with
    (1, 2) or (2, 3), if the order changes otherwise; or at the apex c cot φ. de Souza Neto, Perić & Owen
    (2008), boxes 8.4 to 8.7.
    """
    friction, dilation, cohesion = surface
    i, k = 0, 0
    for a in range(1, 3):
        i = a if tau[a] > tau[i] else i
        k = a if tau[a] <= tau[k] else k
    j = 3 - i - k
    main = (1.0 + friction) * tau[i] - (1.0 - friction) * tau[k] - cohesion
    if main <= 0.0:
        return False
    own = fall((i, k), (i, k), bulk, shear, friction, dilation)
    trial = scratch.vector(SPACE)
    for a in range(3):
        trial[a] = tau[a]
        tau[a] -= main / own * flow_stress(a, (i, k), bulk, shear, dilation)
    if tau[i] >= tau[j] >= tau[k]:
        return True
    beside = (i, j) if tau[j] < tau[k] else (j, k)
    other = (1.0 + friction) * trial[beside[0]] - (1.0 - friction) * trial[beside[1]] - cohesion
    both = fall((i, k), beside, bulk, shear, friction, dilation)
    scale = 1.0 / (own * own - both * both)
    for a in range(3):
        tau[a] = trial[a] - scale * (
            (own * main - both * other) * flow_stress(a, (i, k), bulk, shear, dilation)
            + (own * other - both * main) * flow_stress(a, beside, bulk, shear, dilation)
        )
    if tau[i] < tau[k]:
        for a in range(3):
            tau[a] = 0.5 * cohesion / friction
    return True


@device
def return_stress(
    tau: Floats, bulk: float, shear: float, surface: tuple[float, float, float], tension: float, cone: bool
) -> bool:
    """Return trial stresses ``tau`` to the yield surface and to a mean tension of at most ``tension``.

    Return True if they flow. At the cut-off the volume flows freely: the mean is that tension, and the other
    surface takes what is left as if K were 0.
    """
    trial = scratch.vector(SPACE)
    for a in range(3):
        trial[a] = tau[a]
    flows = (
        return_to_cone(tau, bulk, shear, surface) if cone else return_to_pyramid(tau, bulk, shear, surface)
    )
    if tau[0] + tau[1] + tau[2] <= 3.0 * tension:
        return flows
    mean = (trial[0] + trial[1] + trial[2]) / 3.0
    for a in range(3):
        tau[a] = trial[a] - mean + tension
    if cone:
        return_to_cone(tau, 0.0, shear, surface)
    else:
        return_to_pyramid(tau, 0.0, shear, surface)
    return True


@kernel
def frictional_stress(
    first: int, last: int, deformation_gradient: Floats, volume: Floats, flow: Flow, opened: Floats,
    stress: Floats, bulk: float, shear: float, surface: tuple[float, float, float], tension: float,
    cone: bool, spacing: tuple[float, ...], axes: int,
) -> None:  # fmt: skip
    """σ = τ / J, with τ_a = (K − 2 G / 3) Σ ε + 2 G ε_a of ε = ½ ln F C_p⁻¹ Fᵀ, returned to the surface.

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
        volumetric = strain[0] + strain[1] + strain[2]
        closed = min(opened[p], max(-volumetric, 0.0))
        opened[p] -= closed
        volumetric += closed
        for a in range(3):
            strain[a] += closed / 3.0
            tau[a] = (bulk - 2.0 / 3.0 * shear) * volumetric + 2.0 * shear * strain[a]
        flows = return_stress(tau, bulk, shear, surface, tension, cone)
        compose(tau, vectors, b)
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
                flow.work[p] += tau[a] * plastic
                square += (plastic - (volumetric - pressure / bulk) / 3.0) ** 2
                values[a] = math.exp(2.0 * elastic)
            flow.strain[p] += math.sqrt(2.0 / 3.0 * square)
            if flows and pressure >= tension - 1e-12 * bulk:
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

    def apex(self) -> float:
        """Mean tension at which no shear is left, c cot φ [Pa]."""
        return self.cohesion / math.tan(self.friction_angle) if self.friction_angle > 0.0 else math.inf

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        """Refuse ψ > φ, which makes energy, strength that is zero, and a cut-off that does nothing."""
        if self.dilation_angle > self.friction_angle:
            raise ValueError("dilation_angle: expected at most friction_angle")
        if self.friction_angle == 0.0 and self.cohesion == 0.0:
            raise ValueError("friction_angle and cohesion: expected at least one above zero")
        if self.tension is not None and self.tension > self.apex():
            raise ValueError(f"tension: expected at most c cot φ, {self.apex():.4g} Pa")
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

    def largest_tension(self) -> float:
        """Mean tension that is cut off [Pa]: ``tension``, or that of the apex."""
        return self.options.apex() if self.options.tension is None else self.options.tension

    @hookimpl
    def setup(self, setup: Setup) -> None:
        super().setup(setup)
        self.opened, self.axes = self.shared(setup, OPENED), setup.dim
        self.constants = (
            self.bulk_modulus,
            self.shear_modulus,
            self.surface(),
            self.largest_tension(),
            self.cone,
        )

    @hookimpl
    def update_stress(self, particles: Particles) -> None:
        self.over_points(
            frictional_stress, particles, particles.deformation_gradient, particles.volume, self.flow,
            self.opened, particles.stress, *self.constants, self.spacing, self.axes
        )  # fmt: skip

    def set_stress(self, own: slice, stress: FloatArray) -> bool:
        """Take the elastic strain of the stress, and so the plastic metric: ½ ln b_e of b_e = C_p⁻¹."""
        mean = stress.mean(axis=1, keepdims=True)
        strain = (stress - mean) / (2.0 * self.shear_modulus) + mean / (3.0 * self.bulk_modulus)
        self.flow.metric[own] = np.exp(2.0 * strain)[:, :, None] * np.eye(3)
        return True

    def _strain(self, particles: Particles, own: slice) -> tuple[FloatArray, FloatArray, FloatArray]:
        """J (n,), and the elastic strain ½ ln b_e as eigenvalues (n, 3) and eigenvectors (n, 3, 3)."""
        f = pad_plane_strain(particles.deformation_gradient[own])
        b = np.einsum("nia,nab,njb->nij", f, self.flow.metric[own], f)
        values, vectors = np.linalg.eigh(b)
        return np.linalg.det(f), 0.5 * np.log(values), vectors

    def energy_of_points(self, particles: Particles, own: slice) -> FloatArray:
        """Elastic energy W = K/2 (Σ ε)² + G Σ (ε − Σ ε / 3)², (n,) [J/m^3]."""
        _, strain, _ = self._strain(particles, own)
        volumetric = strain.sum(1)
        deviator = strain - volumetric[:, None] / 3.0
        energy: FloatArray = self.shear_modulus * (deviator**2).sum(1)
        energy += 0.5 * self.bulk_modulus * volumetric**2
        return energy

    def stress_of_points(self, particles: Particles, own: slice) -> FloatArray:
        """σ, (n, 3, 3) [Pa]."""
        jacobian, strain, vectors = self._strain(particles, own)
        lame = self.bulk_modulus - 2.0 / 3.0 * self.shear_modulus
        tau = lame * strain.sum(1)[:, None] + 2.0 * self.shear_modulus * strain
        stress: FloatArray = np.einsum("nia,na,nja->nij", vectors, tau / jacobian[:, None], vectors)
        return stress
