"""A sound material in plain NumPy, which the faults derive from."""

import numpy as np

from mpmfw.api import FloatArray, Material, hookimpl

K, G = 5e6, 3e6


class Sound(Material):
    """Neo-Hookean: W = G/2 (tr b − 3) − G ln J + λ/2 ln² J."""

    name = "sound"
    bulk_modulus, shear_modulus = K, G

    def left(self, f):
        """b = F Fᵀ."""
        return f @ np.swapaxes(f, 1, 2)

    def stress(self, f):
        """σ(F), (n, dim, dim)."""
        one, jacobian = np.eye(f.shape[1]), np.linalg.det(f)[:, None, None]
        lame = K - 2.0 * G / 3.0
        found: FloatArray = (G * (self.left(f) - one) + lame * np.log(jacobian) * one) / jacobian
        return found

    @hookimpl
    def update_stress(self, particles):
        """Of its own points."""
        for own in self.slices:
            particles.stress[own] = self.stress(particles.deformation_gradient[own])

    def energy_density(self, deformation_gradient):
        """W(F)."""
        f, lame = deformation_gradient, K - 2.0 * G / 3.0
        trace = np.einsum("nij,nij->n", f, f) + (1.0 if f.shape[1] == 2 else 0.0)
        log = np.log(np.linalg.det(f))
        found: FloatArray = 0.5 * G * (trace - 3.0) - G * log + 0.5 * lame * log**2
        return found

    def cauchy_stress(self, deformation_gradient):
        """σ in 3D."""
        f = np.tile(np.eye(3), (len(deformation_gradient), 1, 1))
        dim = deformation_gradient.shape[1]
        f[:, :dim, :dim] = deformation_gradient
        return Sound.stress(self, f)


class Keeping(Sound):
    """Sound, with a number of its own for every point, an array of the run."""

    def setup_kept(self, setup):
        """Make room."""
        self.kept = setup.state.arrays.setdefault("kept", np.zeros(setup.state.particles.count))
