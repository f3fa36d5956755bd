"""Energies of the bodies; series of the bodies, which every run has, of stress, and of the time step."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.types import Floats, Ints, Points
from mpmfw.plugin.checks import of_points
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Effect, Setup
from mpmfw.state.fields import (
    AFFINE_ENERGY,
    MATERIAL_WORK,
    SERIES_FIELDS,
    AnyArray,
    Field,
    FloatArray,
)
from mpmfw.state.structs import State

#: Energy over stiffness and volume that counts as zero: rounding in bodies at rest.
NOTHING = 1e-12


@kernel
def sum_motion(
    first: Ints, points: Points, total: Floats, centre: Floats, mean: Floats, spin: Floats, second: Floats,
    kinetic: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Mass, centre, mean velocity, spin, second moment and kinetic energy of every body.

    ``total`` is m = Σ m_p, (B,) [kg/m]; ``centre`` c = Σ m_p x_p / m and ``mean`` v = Σ m_p v_p / m, (B, dim)
    [m, m/s]; ``spin`` Σ m_p r × w with r = x_p − c and w = v_p − v, (B, 1) in 2D and (B, 3) in 3D [kg m/s];
    ``second`` Σ m_p r rᵀ [kg m], (B, dim, dim); ``kinetic`` Σ m_p |v_p|² / 2, (B,) [J/m]. Points
    ``first[b]:first[b + 1]`` belong to body b."""
    dim = len(spacing)
    r, w = scratch.vector(spacing), scratch.vector(spacing)
    c, v = scratch.vector(spacing), scratch.vector(spacing)
    turned, inertia = scratch.vector((0.0, 0.0, 0.0)), scratch.matrix(spacing, spacing)
    axes = 1 if dim == 2 else 3
    for b in range(len(first) - 1):
        body_mass = energy = 0.0
        for d in range(dim):
            c[d] = v[d] = 0.0
            for e in range(dim):
                inertia[d, e] = 0.0
        for a in range(axes):
            turned[a] = 0.0
        for p in range(first[b], first[b + 1]):
            body_mass += points.mass[p]
            for d in range(dim):
                velocity = points.velocity[p, d]
                c[d] += points.mass[p] * points.position[p, d]
                v[d] += points.mass[p] * velocity
                energy += 0.5 * points.mass[p] * velocity * velocity
        for d in range(dim):
            c[d] /= body_mass
            v[d] /= body_mass
        for p in range(first[b], first[b + 1]):
            for d in range(dim):
                r[d] = points.position[p, d] - c[d]
                w[d] = points.velocity[p, d] - v[d]
            if dim == 2:
                turned[0] += points.mass[p] * (r[0] * w[1] - r[1] * w[0])
            else:
                for a in range(axes):
                    d, e = (a + 1) % 3, (a + 2) % 3
                    turned[a] += points.mass[p] * (r[d] * w[e] - r[e] * w[d])
            for d in range(dim):
                for e in range(dim):
                    inertia[d, e] += points.mass[p] * r[d] * r[e]
        total[b], kinetic[b] = body_mass, energy
        for d in range(dim):
            centre[b, d], mean[b, d] = c[d], v[d]
            for e in range(dim):
                second[b, d, e] = inertia[d, e]
        for a in range(axes):
            spin[b, a] = turned[a]


def cross(arm: FloatArray, vector: FloatArray) -> FloatArray:
    """Return a × b of vectors (n, dim): about z in the plane (n, 1), or (n, 3)."""
    if arm.shape[1] == 3:
        return np.cross(arm, vector)
    return arm[:, :1] * vector[:, 1:] - arm[:, 1:] * vector[:, :1]


def kinetic_energy_of(state: State) -> float:
    """Return the kinetic energy of the material points and of free rigid bodies [J/m]."""
    p = state.particles
    of_points = float(np.einsum("n,nd,nd->", 0.5 * p.mass, p.velocity, p.velocity))  # threads of BLAS wait
    return of_points if state.rigid is None else of_points + float(state.rigid.kinetic_energy.sum())


def affine_energies(state: State) -> FloatArray:
    """Return Σ m_p l² C:C / 24 of every body (n_bodies,) [J/m], the motion by C in cubes of edge
    l = V^(1/dim); 0 without C."""
    p = state.particles
    if p.affine is None:
        return np.zeros(len(state.bodies))
    square = np.einsum("nde,nde->n", p.affine, p.affine)
    return state.sums(p.mass * p.volume ** (2.0 / p.dim) * square / 24.0)


def energy_unit(state: State) -> str:
    """Return the unit of a state's energies, J in space, and of bodies of a thickness or of revolution."""
    return "J/m" if state.grid.dim == 2 and state.particles.thickness is None else "J"


def negligible_energy(state: State) -> float:
    """Return the energy that counts as zero, a share of stiffness [J/m]."""
    volume = state.particles.times_thickness(state.particles.initial_volume)
    soft = state.soft_bodies
    volumes = [volume[body.particles].sum() for body in soft]
    stiffness = [body.bulk_modulus + body.shear_modulus for body in soft]
    return NOTHING * float(np.dot(volumes, stiffness))


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
            self._energies = state.energies(by_points("energy_of_points", self.materials, state))
            self._moment = moment
        return self._energies

    @property
    def dissipates(self) -> bool:
        """True if a material of a body loses energy."""
        return any(material.dissipates for material in self.materials if material.slices)

    def dissipated(self, state: State) -> FloatArray:
        """Return the energy lost by materials since time zero (body,) [J/m]."""
        return state.energies(by_points("dissipated_by_points", self.materials, state))


def by_points(
    method: str, materials: tuple[Any, ...], state: State, shape: tuple[int, ...] = ()
) -> FloatArray:
    """Return what the ``materials`` give of all points (n, *shape)."""
    values = np.empty((state.particles.count, *shape))
    for material in materials:
        for own in material.slices:
            values[own] = of_points(method, material, state, own)
    return values


class BodySeries:
    """Series of the bodies, with energies if the scene requests them."""

    name = "body_series"
    stage = "output"

    def __init__(self, strain: StrainEnergies, *, affine: bool, energy: bool) -> None:
        self.strain, self.affine, self.energy = strain, affine, energy

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        energy = setup.scene.output.energy
        line = Effect("energies", energy, "series of every body" if energy else "output.energy = false")
        strain = StrainEnergies(tuple(setup.materials.values()))
        return Acts("", [cls(strain, affine=setup.state.particles.affine is not None, energy=energy)], [line])

    @hookimpl
    def declare_fields(self) -> list[Field]:
        if not self.energy:
            return [field for field in SERIES_FIELDS if not field.name.endswith("_energy")]
        affine = [AFFINE_ENERGY] if self.affine else []
        return [*SERIES_FIELDS, *affine, *([MATERIAL_WORK] if self.strain.dissipates else [])]

    @hookimpl
    def diagnostics(self, state: State) -> dict[str, AnyArray]:
        count, dim = len(state.bodies), state.grid.dim
        first = np.array([0, *(body.particles.stop for body in state.soft_bodies)], dtype=np.int64)
        total, kinetic = np.empty(count), np.empty(count)
        centre, mean, second = np.empty((count, dim)), np.empty((count, dim)), np.empty((count, dim, dim))
        spin = np.empty((count, 1 if dim == 2 else 3))
        sum_motion(first, state.particles, total, centre, mean, spin, second, kinetic, state.grid.spacing)
        if state.rigid is not None:
            state.rigid.write_sums(total, centre, mean, spin, second, kinetic)
        turning = np.array([_solve_inertia(*each) for each in zip(second, spin, strict=True)])
        if state.rigid is not None:
            turning[len(first) - 1 :] = state.rigid.angular_velocity
        series = {
            "centre_of_mass": centre,
            "mean_velocity": mean,
            "angular_velocity": turning,
            "linear_momentum": total[:, None] * mean,
            "angular_momentum": spin,
        }
        return {**series, **self._energies(state, kinetic)} if self.energy else series

    def _energies(self, state: State, kinetic: FloatArray) -> dict[str, AnyArray]:
        """The energies of every body [J]."""
        strain = self.strain.of(state)
        series = {"kinetic_energy": kinetic, "strain_energy": strain, "total_energy": kinetic + strain}
        if self.affine:
            series["affine_energy"] = affine_energies(state)
        if self.strain.dissipates:
            series["material_dissipation"] = self.strain.dissipated(state)
        return series


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
        return Acts("frames hold material points", [cls(tuple(setup.materials.values()))])

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return [VON_MISES]

    @hookimpl
    def diagnostics(self, state: State, points: bool) -> dict[str, AnyArray]:
        """sqrt(3/2 s:s), (n,) [Pa]."""
        if not points:
            return {}
        stress = by_points("stress_of_points", self.materials, state, (3, 3))
        deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
        return {"von_mises": np.sqrt(1.5 * np.einsum("nij,nij->n", deviator, deviator))}


_MEAN = "mean length of the steps since the last output"
_OWNER = "who sets the limit: index into the attribute time_step_owners of the root"
TIME_STEP_FIELDS = [
    Field("time_step", (), "s", _MEAN, "series", output=True, missing=True),
    Field("time_step_limit", (), "s", "stable time step at the output", "series", output=True),
    Field("time_step_owner", (), "1", _OWNER, "series", output=True),
]


class TimeStepSeries:
    """Series of the time step: length, limit, and who sets it."""

    name = "time_step_series"
    stage = "output"
    history = ("owners", "last")

    def __init__(self, setup: Setup) -> None:
        self.setup = setup  #: has the limits, once the run is built
        self.owners: dict[str, float] = {}  #: their numbers, in the order in which they first set the limit
        self.last = 0

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        """Record the limits of the run, and the contact's series of stability."""
        monitors = [] if setup.contact is None else setup.contact.monitors()
        return Acts("output.stability = true", [cls(setup), *monitors])

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return TIME_STEP_FIELDS

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """Values at this output; an owner is numbered when it first sets the limit."""
        limit, owner = min(self.setup.limits())
        number = self.owners.setdefault(owner, float(len(self.owners)))
        steps, self.last = state.steps - self.last, state.steps
        mean = interval / steps if steps > 0 and interval > 0.0 else np.nan
        values = {"time_step": mean, "time_step_limit": limit, "time_step_owner": number}
        return {name: np.asarray(float(value)) for name, value in values.items()}
