"""The faults."""

from __future__ import annotations

import numpy as np

from faulty_plugins.material.sound import G, K, Keeping, Sound
from faulty_plugins.sealed import Sealed
from mpmfw.api import FloatArray, Particles, Setup, hookimpl

_noise = np.random.default_rng()


class PreStressed(Sound):
    """Stress at rest."""

    def stress(self, f: FloatArray) -> FloatArray:
        return super().stress(f) + 1e-6 * K * np.eye(f.shape[1])


class TwiceTheShear(Sound):
    """The modulus that steps are made of is half of what acts."""

    shear_modulus = 0.5 * G


class SmallStrain(Sound):
    """σ of the symmetric part of F − 1: a turned body is under stress."""

    def stress(self, f: FloatArray) -> FloatArray:
        one = np.eye(f.shape[1])
        strain = 0.5 * (f + np.swapaxes(f, 1, 2)) - one
        trace = np.einsum("nii->n", strain)[:, None, None]
        return (K - 2.0 * G / 3.0) * trace * one + 2.0 * G * strain


class RightForLeft(Sound):
    """FᵀF in the place of F Fᵀ."""

    def left(self, f: FloatArray) -> FloatArray:
        return np.swapaxes(f, 1, 2) @ f


class Lopsided(Sound):
    """A stress that is not symmetric."""

    def stress(self, f: FloatArray) -> FloatArray:
        found = super().stress(f)
        found[:, 0, 1] *= 1.0 + 1e-6
        return found


class KirchhoffForCauchy(Sound):
    """The division by J was forgotten, in the outputs as well."""

    def stress(self, f: FloatArray) -> FloatArray:
        return super().stress(f) * np.linalg.det(f)[:, None, None]

    def cauchy_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        return (
            super().cauchy_stress(deformation_gradient) * np.linalg.det(deformation_gradient)[:, None, None]
        )


class EverybodysStress(Sound):
    """All points are taken for the material's own."""

    @hookimpl
    def update_stress(self, particles: Particles) -> None:
        particles.stress[:] = self.stress(particles.deformation_gradient)


class MeanPressure(Sound):
    """The pressure is the body's mean."""

    def stress(self, f: FloatArray) -> FloatArray:
        found, one = super().stress(f), np.eye(f.shape[1])
        pressure = np.einsum("nii->n", found)[:, None, None] / f.shape[1]
        return found - pressure * one + pressure.mean() * one


class Counting(Sound):
    """Stiffer with every step, of which it keeps the number to itself."""

    steps = 0

    @hookimpl
    def update_stress(self, particles: Particles) -> None:
        self.steps += 1
        super().update_stress(particles)
        for own in self.slices:
            particles.stress[own] *= 1.0 + 1e-9 * self.steps


class Noisy(Sound):
    """Random numbers of their own in every run."""

    def stress(self, f: FloatArray) -> FloatArray:
        return super().stress(f) * (1.0 + 1e-10 * _noise.uniform())


class Damaged(Keeping):
    """Points that were strained get softer, and nobody is told where the energy went."""

    @hookimpl
    def setup(self, setup: Setup) -> None:
        self.setup_kept(setup)

    @hookimpl
    def update_stress(self, particles: Particles) -> None:
        for own in self.slices:
            f = particles.deformation_gradient[own]
            strain = np.abs(self.left(f) - np.eye(f.shape[1])).max(axis=(1, 2))
            self.kept[own] = np.maximum(self.kept[own], strain)
            particles.stress[own] = self.stress(f) * self._left(own)[:, None, None]

    def _left(self, own: slice) -> FloatArray:
        return 1.0 / (1.0 + 20.0 * np.maximum(self.kept[own] - 1e-4, 0.0))

    def energy_of_points(self, particles: Particles, own: slice) -> FloatArray:
        return super().energy_of_points(particles, own) * self._left(own)

    def stress_of_points(self, particles: Particles, own: slice) -> FloatArray:
        return super().stress_of_points(particles, own) * self._left(own)[:, None, None]


class LosingInSilence(Damaged):
    """What is lost is told, but not that anything is."""

    def dissipated_by_points(self, particles: Particles, own: slice) -> FloatArray:  # noqa: ARG002
        return K * self.kept[own]


class GivingBack(Sound):
    """What was lost comes back with the strain."""

    dissipates = True

    def dissipated_by_points(self, particles: Particles, own: slice) -> FloatArray:
        return 0.01 * self.energy_of_points(particles, own)


class NotANumber(Sound):
    """The logarithm of a negative number."""

    def stress(self, f: FloatArray) -> FloatArray:
        with np.errstate(invalid="ignore"):
            return super().stress(f) + 0.0 * np.sqrt(np.linalg.det(f) - 1.0)[:, None, None]


class OutputsInThePlane(Sound):
    """The stress for outputs has no component across the plane."""

    def cauchy_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        found = super().cauchy_stress(deformation_gradient).copy()
        if deformation_gradient.shape[1] == 2:
            found[:, 2, 2] = 0.0
        return found


class Closed(Sealed, Sound):
    """Holds a function."""

    name = "closed"
