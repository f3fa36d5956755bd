"""Linear elasticity at small strain, with rotation taken out by the polar decomposition of F; plane strain in
2D."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mpmfw.api.types import FloatArray, Particles, hookimpl
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.arithmetic import invert
from mpmfw.kernels.types import Floats
from mpmfw_material._isotropic import Elastic, pad_plane_strain

MAX_ITERATIONS = 30


@device
def rotation_of(f: Floats, rotation: Floats, inverse: Floats, spacing: tuple[float, ...]) -> None:
    """R of F = R U by Newton's iteration R ← (R + R^−T) / 2 (Higham 1986), which converges quadratically."""
    dim = len(spacing)
    for d in range(dim):
        for e in range(dim):
            rotation[d, e] = f[d, e]
    change = 1.0
    iteration = 0
    while change > 1e-28 and iteration < MAX_ITERATIONS:
        invert(rotation, inverse, spacing)
        change = 0.0
        for d in range(dim):
            for e in range(dim):
                value = 0.5 * (rotation[d, e] + inverse[e, d])
                change += (value - rotation[d, e]) ** 2
                rotation[d, e] = value
        iteration += 1


@kernel
def linear_elastic_stress(
    first: int, last: int, deformation_gradient: Floats, stress: Floats, bulk: float, shear: float,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """σ = R [λ tr(U − 1) 1 + 2 G (U − 1)] Rᵀ, U = Rᵀ F, λ = K − 2 G / 3; U_zz = 1 in 2D."""
    dim = len(spacing)
    lame = bulk - 2.0 * shear / 3.0
    f, rotation = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    inverse, stretch = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    for p in range(first, last):
        for d in range(dim):
            for e in range(dim):
                f[d, e] = deformation_gradient[p, d, e]
        rotation_of(f, rotation, inverse, spacing)
        trace = 0.0
        for d in range(dim):
            for e in range(dim):
                stretch[d, e] = -1.0 if d == e else 0.0
                for a in range(dim):
                    stretch[d, e] += rotation[a, d] * f[a, e]
            trace += stretch[d, d]
        for d in range(dim):
            for e in range(dim):
                value = lame * trace if d == e else 0.0
                for a in range(dim):
                    for b in range(dim):
                        value += 2.0 * shear * rotation[d, a] * stretch[a, b] * rotation[e, b]
                stress[p, d, e] = value


class LinearElastic(Elastic):
    """σ = R C:(U − 1) Rᵀ: Cauchy stress linear in the Biot strain, objective, for small strain and any
    rotation."""

    name = "linear_elastic"

    @property
    def kernel(self) -> Callable[..., None]:
        return linear_elastic_stress

    @hookimpl
    def update_stress(self, particles: Particles) -> None:
        f, stress = particles.deformation_gradient, particles.stress
        self.over_points(self.evaluate, particles, f, stress, *self.constants)

    def energy_density(self, deformation_gradient: FloatArray) -> FloatArray:
        """W = λ/2 tr²(U − 1) + G |U − 1|², (n,) [J/m^3]; exact to second order in the strain."""
        f = pad_plane_strain(deformation_gradient)
        values, vectors = np.linalg.eigh(np.swapaxes(f, 1, 2) @ f)
        strain = np.einsum("nia,na,nja->nij", vectors, np.sqrt(values) - 1.0, vectors)  # U − 1 from U² = Fᵀ F
        lame = self.bulk_modulus - 2.0 * self.shear_modulus / 3.0
        trace = np.einsum("nii->n", strain)
        square = np.einsum("nij,nij->n", strain, strain)
        energy: FloatArray = 0.5 * lame * trace**2 + self.shear_modulus * square
        return energy
