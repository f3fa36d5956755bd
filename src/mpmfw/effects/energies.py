"""Energies of the material points, and the end of a run whose energy grows without reason."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from mpmfw.errors import SimulationError
from mpmfw.kernels import kernel
from mpmfw.kernels.body_sums import sum_affine_energy
from mpmfw.kernels.types import Floats
from mpmfw.plugin.checks import of_points
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import State

#: Energy over stiffness and volume that counts as zero: rounding in bodies at rest.
NOTHING = 1e-12

#: Growth, as a share of the energy at the start and what was put in since, past which a run is stopped.
GROWTH_LIMIT = 0.5

#: Where energy may come from: its name, and what helps, by the names of :attr:`Setup.remedies` or in words.
CAUSES = {
    "contact": ("contact", ("step", "contact")),
    "inertia": ("the inertia correction", ("step", "rotation = 'lumped'")),
    "transfer": ("the transfer between points and grid", ("another stepping.transfer", "shape")),
    "strain": ("the strain's integration in time", ("step", "scheme")),
}


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
    return kinetic_energy_of(state) + float(affine[0])


def kinetic_energy_of(state: State) -> float:
    """Return the kinetic energy of the material points and of free rigid bodies [J/m]."""
    p = state.particles
    of_points = float(kinetic_energy(p.mass, p.velocity))
    return of_points if state.rigid is None else of_points + float(state.rigid.kinetic_energy.sum())


def negligible_energy(state: State) -> float:
    """Return the energy that counts as zero, a share of stiffness [J/m]."""
    volume = state.particles.times_thickness(state.particles.initial_volume)
    volumes = [volume[body.particles].sum() for body in state.soft_bodies]
    stiffness = [body.bulk_modulus + body.shear_modulus for body in state.soft_bodies]
    return NOTHING * float(np.dot(volumes, stiffness))


def made_of(materials: Iterable[Any]) -> Iterator[tuple[slice, Any]]:
    """Yield slices of material points with the material that they are made of."""
    return ((own, material) for material in materials for own in material.slices)


class StrainEnergies:
    """Σ V_0 W(F) of every body; computed once at an output."""

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
        """Return the energy lost by materials since time zero (body,) [J/m]."""
        return self._sums(state, "dissipated_by_points")

    def _sums(self, state: State, density: str) -> FloatArray:
        particles, values = state.particles, np.empty(state.particles.count)
        for own, material in made_of(self.materials):
            values[own] = of_points(density, material, state, own)
        sums, soft = np.zeros(len(state.bodies)), state.soft_bodies
        sums[: len(soft)] = np.add.reduceat(
            values * particles.times_thickness(particles.initial_volume),
            [body.particles.start for body in soft],
        )
        return sums


class EnergyGuard:
    """Bound on the energy of the bodies; ``nothing`` [J/m] counts as none."""

    history = ("start", "given", "input", "loaded", "fallen", "depth")

    def __init__(self, nothing: float, remedies: Mapping[str, str]) -> None:
        self.nothing, self.remedies = nothing, remedies
        self.restart(0.0)

    def restart(self, start: float) -> None:
        """Begin with bodies that have the energy ``start`` [J/m]."""
        self.start = start
        self.given = self.input = 0.0
        self.loaded: float | None = None  #: energy of the contact springs at the start, once a step has told
        self.fallen = self.depth = 0.0

    def set_external_work(self, work: float) -> None:
        """Set the work of gravity and loads [J/m]; its maximum stays allowed."""
        self.given, self.input = work, max(self.input, work)

    def set_contact_energy(self, energy: float, last_work: float) -> None:
        """Set the energy of contact where the step began [J/m], negative where bodies stick together, and its
        last work.

        Call it after every step. Springs that only push hold no less than nothing, and their energy may as
        well have been given back."""
        self.fallen = max(last_work - energy, -energy) if energy < 0.0 else 0.0
        self.depth = max(self.depth, -energy)

    @property
    def released(self) -> float:
        """Energy that springs and adhesion may have given so far [J/m]."""
        return (self.loaded or 0.0) + self.fallen

    @property
    def allowed(self) -> float:
        """Energy of bodies and springs at the start, and what was put in [J/m]."""
        return self.start + max(self.loaded or 0.0, 0.0) + self.depth + self.input + self.nothing

    def growth(self, energy: float) -> float:
        """Energy beyond what there was, and what contact and loads gave [J/m]."""
        return energy - self.start - self.released - self.given

    def grown(self, energy: float) -> bool:
        """Return True if the growth is too much or NaN."""
        return not self.growth(energy) <= GROWTH_LIMIT * self.allowed

    def error(self, energy: float, terms: dict[str, float], time: float) -> SimulationError:
        """Return what stops the run at an ``energy`` of the bodies [J/m], with the likely cause.

        ``terms`` [J/m] came from ``contact``, ``inertia``, ``transfer`` and ``strain`` since the start."""
        amounts = {**terms, "contact": terms["contact"] - self.released}
        largest = max(amounts, key=lambda term: amounts[term])
        cause, ways = CAUSES[largest]
        absent = {"step", "scheme", "contact", "shape"} - self.remedies.keys()
        advice = ", or ".join(self.remedies.get(way, way) for way in ways if way not in absent)
        return SimulationError(
            f"the energy grew by {self.growth(energy):.4g} J/m without reason, past {GROWTH_LIMIT:g} of the "
            f"{self.allowed:.4g} J/m that there were and were put in; likely cause: {cause}, which added "
            f"{amounts[largest]:.4g} J/m",
            time=time,
            advice=f"{advice}; allow_unstable = true lets the run go on",
        )
