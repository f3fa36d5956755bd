"""Energies of the material points, which are series of every run and terms of the verdict and the ledger."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from mpmfw.kernels import kernel
from mpmfw.kernels.body_sums import sum_affine_energy
from mpmfw.kernels.types import Floats
from mpmfw.plugin.checks import of_points
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import State

#: Energy over stiffness and volume that counts as zero: rounding in bodies at rest.
NOTHING = 1e-12


@kernel
def kinetic_energy(mass: Floats, velocity: Floats) -> float:
    """Σ m v² / 2 over material points."""
    total = 0.0
    for p in range(len(mass)):
        square = 0.0
        for d in range(velocity.shape[1]):
            square += velocity[p, d] * velocity[p, d]
        total += 0.5 * mass[p] * square
    return total


def motion_energy(state: State) -> float:
    """Return the kinetic and affine energy of the material points [J/m]."""
    p, affine = state.particles, np.zeros(1)
    if p.affine is not None:
        sum_affine_energy(np.array([0, p.count]), p, p.affine, affine, state.grid.spacing)
    return float(kinetic_energy(p.mass, p.velocity) + affine[0])


def negligible_energy(state: State) -> float:
    """Return the energy of the bodies that counts as zero [J/m], a share of their stiffness."""
    volume = state.particles.times_thickness(state.particles.initial_volume)
    volumes = [volume[body.particles].sum() for body in state.bodies]
    stiffness = [body.bulk_modulus + body.shear_modulus for body in state.bodies]
    return NOTHING * float(np.dot(volumes, stiffness))


def made_of(materials: Iterable[Any]) -> Iterator[tuple[slice, Any]]:
    """Yield slices of material points with the material that they are made of."""
    return ((own, material) for material in materials for own in material.slices)


class StrainEnergies:
    """Σ V_0 W(F) of every body, from the bodies' materials; computed once at an output."""

    def __init__(self, materials: tuple[Any, ...]) -> None:
        self.materials = materials
        self._energies = np.empty(0)
        self._moment: tuple[int, float] | None = None

    def of(self, state: State) -> FloatArray:
        """(body,) [J/m]."""
        moment = state.steps, state.time
        if moment != self._moment:
            self._energies = self._sums(state, "energy_of_points")
            self._moment = moment
        return self._energies

    @property
    def dissipates(self) -> bool:
        """True if a material of a body loses energy."""
        return any(material.dissipates for material in self.materials if material.slices)

    def dissipated(self, state: State) -> FloatArray:
        """Return the energy that every body's material has lost since time zero (body,) [J/m]."""
        return self._sums(state, "dissipated_by_points")

    def _sums(self, state: State, density: str) -> FloatArray:
        particles, values = state.particles, np.empty(state.particles.count)
        for own, material in made_of(self.materials):
            values[own] = of_points(density, material, state, own)
        return np.add.reduceat(
            values * particles.times_thickness(particles.initial_volume),
            [body.particles.start for body in state.bodies],
        )
