"""Compressible Neo-Hookean solid in two energies; plane strain in 2D."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

import numpy as np
from pydantic import Field

from mpmfw.api.types import FloatArray, Particles, hookimpl
from mpmfw.kernels import device, kernel, lanes, scratch
from mpmfw.kernels.arithmetic import determinant
from mpmfw.kernels.types import Float, Floats
from mpmfw_material._isotropic import Elastic, Moduli

#: Largest change of volume for which the series of J^(−5/3) are exact to rounding.
SMALL = 0.1


@device
def inverse_five_thirds(jacobian: Float) -> Float:
    """Return J^(−5/3) where abs(J − 1) < 0.1: r⁵ (J r³)^(−5/3), with the series of r = J^(−1/3) and of the
    second factor about 1.

    Each is cut where the other makes it exact to rounding. It takes half the time of exponential and
    logarithm, which remain for volumes far from the initial one."""
    change = jacobian - 1.0
    square = change * change
    high = 2.0 / 9.0 - 14.0 / 81.0 * change + 35.0 / 243.0 * square
    r = 1.0 - change / 3.0 + high * square
    rest = 1.0 - jacobian * r * (r * r)
    return (r * r) * (r * r) * r * (1.0 + rest * (5.0 / 3.0 + 20.0 / 9.0 * rest))


@device
def split_stress(
    f: Floats, jacobian: Float, power: Float, bulk: float, shear: float, stress: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """``stress`` of F of a point, or of points in lanes; ``power`` is J^(−5/3)."""
    dim = len(spacing)
    for d in range(dim):
        for e in range(dim):
            stress[d, e] = f[d, 0] * f[e, 0]
            for a in range(1, dim):
                stress[d, e] += f[d, a] * f[e, a]
    trace = (1.0 if dim == 2 else 0.0) + stress[0, 0]
    for d in range(1, dim):
        trace += stress[d, d]
    factor = shear * power
    pressure = 0.5 * bulk * (jacobian - 1.0 / jacobian) - factor * trace / 3.0
    for d in range(dim):
        for e in range(dim):
            stress[d, e] *= factor
        stress[d, d] += pressure


@kernel
def neo_hookean_split(
    first: int, last: int, deformation_gradient: Floats, stress: Floats, bulk: float, shear: float,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """σ = K/2 (J − 1/J) 1 + G J^(−5/3) (b − tr b / 3), b = F Fᵀ; in 2D b_zz = 1 enters the trace.

    From W = K/2 [(J² − 1)/2 − ln J] + G/2 [J^(−2/3) tr b − 3].
    """
    f, result = lanes.matrix(spacing, spacing), lanes.matrix(spacing, spacing)
    for p in range(first, last, lanes.WIDTH):
        points = lanes.points_from(p, last)
        lanes.read(deformation_gradient, points, f, spacing)
        jacobian = determinant(f, spacing)
        if lanes.within(jacobian - 1.0, -SMALL, SMALL):
            split_stress(f, jacobian, inverse_five_thirds(jacobian), bulk, shear, result, spacing)
            lanes.write(stress, points, result, spacing)
        else:
            for q in points:
                volume = determinant(deformation_gradient[q], spacing)
                small = abs(volume - 1.0) < SMALL
                power = inverse_five_thirds(volume) if small else math.exp(-5.0 / 3.0 * math.log(volume))
                split_stress(deformation_gradient[q], volume, power, bulk, shear, stress[q], spacing)


@kernel
def neo_hookean_log(
    first: int, last: int, deformation_gradient: Floats, stress: Floats, bulk: float, shear: float,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """σ = [G (b − 1) + λ ln J 1] / J, λ = K − 2 G / 3.

    From W = G/2 (tr b − 3) − G ln J + λ/2 ln² J.
    """
    dim = len(spacing)
    f = scratch.matrix(spacing, spacing)
    lame = bulk - 2.0 * shear / 3.0
    for p in range(first, last):
        for d in range(dim):
            for e in range(dim):
                f[d, e] = deformation_gradient[p, d, e]
        jacobian = determinant(f, spacing)
        pressure = lame * math.log(jacobian)
        for d in range(dim):
            for e in range(dim):
                b = 0.0
                for a in range(dim):
                    b += f[d, a] * f[e, a]
                unit, mean = (1.0, pressure) if d == e else (0.0, 0.0)
                stress[p, d, e] = (shear * (b - unit) + mean) / jacobian


class NeoHookeanOptions(Moduli):
    energy: Literal["split", "log"] = Field(
        "split",
        description="split: K/2 [(J^2-1)/2 - ln J] + G/2 [J^(-2/3) tr b - 3]; log: G/2 (tr b - 3) - G ln J + "
        "l/2 ln^2 J",
    )


class NeoHookean(Elastic):
    """Neo-Hookean solid; ``energy = "split"`` is the one of the rings' finite-element reference."""

    name = "neo_hookean"
    Options = NeoHookeanOptions
    options: NeoHookeanOptions

    @property
    def kernel(self) -> Callable[..., None]:
        return neo_hookean_split if self.options.energy == "split" else neo_hookean_log

    @hookimpl
    def update_stress(self, particles: Particles) -> None:
        f, stress = particles.deformation_gradient, particles.stress
        self.over_points(self.evaluate, particles, f, stress, *self.constants)

    def energy_density(self, deformation_gradient: FloatArray) -> FloatArray:
        bulk, shear = self.bulk_modulus, self.shear_modulus
        f = deformation_gradient
        if f.shape[1] == 2:  # plane strain: F_zz = 1
            jacobian = f[:, 0, 0] * f[:, 1, 1] - f[:, 0, 1] * f[:, 1, 0]
            trace = np.einsum("nij,nij->n", f, f) + 1.0
        else:
            jacobian = np.linalg.det(f)
            trace = np.einsum("nij,nij->n", f, f)
        log = np.log(jacobian)
        if self.options.energy == "split":
            volumetric = 0.5 * bulk * (0.5 * (jacobian**2 - 1.0) - log)
            energy: FloatArray = volumetric + 0.5 * shear * (np.exp(-2.0 / 3.0 * log) * trace - 3.0)
        else:
            lame = bulk - 2.0 * shear / 3.0
            energy = 0.5 * shear * (trace - 3.0) - shear * log + 0.5 * lame * log**2
        return energy
