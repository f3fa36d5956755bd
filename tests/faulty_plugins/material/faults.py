"""Materials whose fault is more than a change of text."""

import numpy as np

from faulty_plugins.material.sound import G, K, Keeping, Sound
from mpmfw.api import hookimpl


class TwiceTheShear(Sound):
    """The modulus that steps are made of is half of what acts."""

    shear_modulus = 0.5 * G


class Damaged(Keeping):
    """Points that were strained get softer, and nobody is told where the energy went."""

    @hookimpl
    def setup(self, setup):
        self.setup_kept(setup)

    @hookimpl
    def update_stress(self, particles):
        for own in self.slices:
            f = particles.deformation_gradient[own]
            strain = np.abs(self.left(f) - np.eye(f.shape[1])).max(axis=(1, 2))
            self.kept[own] = np.maximum(self.kept[own], strain)
            particles.stress[own] = self.stress(f) * self._left(own)[:, None, None]

    def _left(self, own):
        return 1.0 / (1.0 + 20.0 * np.maximum(self.kept[own] - 1e-4, 0.0))

    def energy_of_points(self, particles, own):
        return super().energy_of_points(particles, own) * self._left(own)

    def stress_of_points(self, particles, own):
        return super().stress_of_points(particles, own) * self._left(own)[:, None, None]


class LosingInSilence(Damaged):
    """What is lost is told, but not that anything is."""

    def dissipated_by_points(self, particles, own):  # noqa: ARG002
        return K * self.kept[own]


class GivingBack(Sound):
    """What was lost comes back with the strain."""

    dissipates = True

    def dissipated_by_points(self, particles, own):
        return 0.01 * self.energy_of_points(particles, own)
