"""Series that every run has: momentum, energy and rotation of every body, from its material points."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from mpmfw.kernels.body_sums import sum_affine_energy, sum_motion
from mpmfw.plugin.checks import of_points
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import (
    AFFINE_ENERGY,
    MATERIAL_WORK,
    SERIES_FIELDS,
    AnyArray,
    Field,
    FloatArray,
    IntArray,
)
from mpmfw.state.structs import Body, State


class StrainEnergies:
    """Σ V_0 W(F) of every body, asked by several at one output and computed once.

    Parameters
    ----------
    materials
        For each body, its material (:class:`mpmfw.api.material.Material`).
    """

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
        """Whether a material loses energy."""
        return any(material.dissipates for material in self.materials)

    def dissipated(self, state: State) -> FloatArray:
        """What every body's material has lost since time zero (body,) [J/m]."""
        return self._sums(state, "dissipated_by_points")

    def _sums(self, state: State, density: str) -> FloatArray:
        particles, made_of = state.particles, of_one_material(state.bodies, self.materials)
        each = np.concatenate([of_points(density, material, state, own) for own, material in made_of])
        return np.add.reduceat(
            each * particles.times_thickness(particles.initial_volume),
            [body.particles.start for body in state.bodies],
        )


class BodySeries:
    """Computed at outputs only, over material points.

    Parameters
    ----------
    strain
        Energies of the strain.
    affine
        Whether the transfer has an affine field, whose energy is a series of its own.
    energy
        Whether the energies are wanted.
    """

    name = "body_series"
    stage = "output"

    def __init__(self, strain: StrainEnergies, *, affine: bool, energy: bool) -> None:
        self.strain, self.affine, self.energy = strain, affine, energy

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        """Return the series, which every run has; those of energies if the scene wants them."""
        energy = setup.scene.output.energy
        setup.note("energies", energy, "series of every body" if energy else "output.energy = false")
        strain = StrainEnergies(setup.material_of_bodies)
        return Acts("", [cls(strain, affine=setup.state.particles.affine is not None, energy=energy)])

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The series that the scene wants; the affine energy if the transfer has an affine field, what
        materials dissipate if one does."""
        if not self.energy:
            return [field for field in SERIES_FIELDS if not field.name.endswith("_energy")]
        affine, lost = (
            ([AFFINE_ENERGY] if self.affine else []),
            ([MATERIAL_WORK] if self.strain.dissipates else []),
        )
        return [*SERIES_FIELDS, *affine, *lost]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Know the dimension."""
        self.dim = setup.dim

    @hookimpl
    def diagnostics(self, state: State) -> dict[str, AnyArray]:
        """All series, (body, …)."""
        p, count, dim = state.particles, len(state.bodies), self.dim
        first = np.array([0, *(body.particles.stop for body in state.bodies)], dtype=np.int64)
        total, kinetic = np.empty(count), np.empty(count)
        centre, mean, second = np.empty((count, dim)), np.empty((count, dim)), np.empty((count, dim, dim))
        spin = np.empty((count, 1 if dim == 2 else 3))
        sum_motion(
            first,
            p.mass,
            p.position,
            p.velocity,
            total,
            centre,
            mean,
            spin,
            second,
            kinetic,
            state.grid.spacing,
        )
        series = {
            "centre_of_mass": centre,
            "mean_velocity": mean,
            "angular_velocity": np.array([_solve_inertia(*each) for each in zip(second, spin, strict=True)]),
            "linear_momentum": total[:, None] * mean,
            "angular_momentum": spin,
        }
        return {**series, **self._energies(state, first, kinetic)} if self.energy else series

    def _energies(self, state: State, first: IntArray, kinetic: FloatArray) -> dict[str, AnyArray]:
        """The energies of every body [J]."""
        p = state.particles
        strain = self.strain.of(state)
        series = {"kinetic_energy": kinetic, "strain_energy": strain, "total_energy": kinetic + strain}
        if self.affine and p.affine is not None:
            series["affine_energy"] = np.empty_like(kinetic)
            sum_affine_energy(first, p.mass, p.volume, p.affine, series["affine_energy"], state.grid.spacing)
        if self.strain.dissipates:
            series["material_dissipation"] = self.strain.dissipated(state)
        return series


def of_one_material(bodies: tuple[Body, ...], materials: tuple[Any, ...]) -> list[tuple[slice, Any]]:
    """Material points of bodies of one material that follow each other, with that material.

    Parameters
    ----------
    bodies, materials
        All bodies, and what each is made of.
    """
    runs = [
        list(run)
        for _, run in itertools.groupby(zip(bodies, materials, strict=True), key=lambda each: id(each[1]))
    ]
    return [(slice(run[0][0].particles.start, run[-1][0].particles.stop), run[0][1]) for run in runs]


def _solve_inertia(second: FloatArray, spin: FloatArray) -> FloatArray:
    """ω of L = I ω, I = tr(S) 1 − S of S = Σ m r rᵀ; one number in 2D."""
    trace = float(np.trace(second))
    if len(second) == 2:
        return spin / trace if trace > 0.0 else np.zeros(1)
    return np.asarray(np.linalg.lstsq(trace * np.eye(3) - second, spin, rcond=None)[0])


VON_MISES = Field(
    "von_mises", ("particle",), "Pa", "von Mises stress, out-of-plane stress included", output=True
)


class VonMises:
    """von Mises stress of the material points, at outputs that hold them."""

    name = "von_mises"
    stage = "output"

    def __init__(self, materials: tuple[Any, ...]) -> None:
        self.materials = materials

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        """Return the stress, wherever frames hold material points."""
        return Acts("frames hold material points", [cls(setup.material_of_bodies)])

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The field."""
        return [VON_MISES]

    @hookimpl
    def diagnostics(self, state: State, points: bool) -> dict[str, AnyArray]:
        """sqrt(3/2 s:s), (n,) [Pa]."""
        if not points:
            return {}
        parts = []
        for own, material in of_one_material(state.bodies, self.materials):
            stress = of_points("stress_of_points", material, state, own)
            deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
            parts.append(np.sqrt(1.5 * np.einsum("nij,nij->n", deviator, deviator)))
        return {"von_mises": np.concatenate(parts)}
