"""Compressible neo-Hookean material: replace energy and stress by those of your own."""

from __future__ import annotations

import numpy as np
from pydantic import BaseModel, ConfigDict

from mpmfw.api.material import Material
from mpmfw.api.types import FloatArray, Particles, hookimpl
from mpmfw.api.units import Pressure


class TemplateOptions(BaseModel):
    """Moduli at small strain [Pa]."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    bulk_modulus: Pressure = 5e6
    shear_modulus: Pressure = 3e6


class Template(Material):
    """W = G/2 (tr b − 3) − G ln J + λ/2 ln² J, in plane strain and in space."""

    name = "template"
    Options = TemplateOptions
    options: TemplateOptions

    @property
    def bulk_modulus(self) -> float:
        """K [Pa] at small strain, which sets the wave speed and so the step."""
        return float(self.options.bulk_modulus)

    @property
    def shear_modulus(self) -> float:
        """G [Pa] at small strain."""
        return float(self.options.shear_modulus)

    @hookimpl
    def update_stress(self, particles: Particles) -> None:
        """Cauchy stress of the material's own points."""
        dim = particles.dim
        for own in self.slices:
            stress = self.cauchy_stress(particles.deformation_gradient[own])
            particles.stress[own] = stress[:, :dim, :dim]

    def energy_density(self, deformation_gradient: FloatArray) -> FloatArray:
        """W(F), (n,) [J/m^3]; ``deformation_gradient`` is F, (n, dim, dim)."""
        f, shear = _in_space(deformation_gradient), self.shear_modulus
        lame = self.bulk_modulus - 2.0 * shear / 3.0
        log = np.log(np.linalg.det(f))
        shearing = 0.5 * shear * (np.einsum("nij,nij->n", f, f) - 3.0) - shear * log
        energy: FloatArray = shearing + 0.5 * lame * log**2
        return energy

    def cauchy_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        """σ(F), (n, 3, 3) [Pa]; ``deformation_gradient`` is F, (n, dim, dim)."""
        f, shear = _in_space(deformation_gradient), self.shear_modulus
        lame = self.bulk_modulus - 2.0 * shear / 3.0
        jacobian = np.linalg.det(f)[:, None, None]
        shearing = shear * (f @ np.swapaxes(f, 1, 2) - np.eye(3))
        stress: FloatArray = (shearing + lame * np.log(jacobian) * np.eye(3)) / jacobian
        return stress


def _in_space(deformation_gradient: FloatArray) -> FloatArray:
    """F (n, 3, 3); in plane strain F_zz = 1."""
    dim = deformation_gradient.shape[1]
    f = np.tile(np.eye(3), (len(deformation_gradient), 1, 1))
    f[:, :dim, :dim] = deformation_gradient
    return f
