"""Series that every run has: momentum, energy and rotation of every body, from its material points."""

from __future__ import annotations

import itertools

import numpy as np

from mpmfw.fields import AFFINE_ENERGY, SERIES_FIELDS, AnyArray, Field, FloatArray
from mpmfw.hookspecs import hookimpl
from mpmfw.setup import Setup
from mpmfw.state import Body, State


class BodySeries:
    """Computed at outputs only, over material points.

    Parameters
    ----------
    materials
        For each body, an object with ``energy_density`` (see :class:`mpmfw.api.Material`).
    affine
        Whether the transfer has an affine field, whose energy is a series of its own.
    energy
        Whether the energies are wanted.
    """

    name = "body_series"
    stage = "output"

    def __init__(self, materials: tuple[object, ...], *, affine: bool, energy: bool) -> None:
        self.materials, self.affine, self.energy = materials, affine, energy

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The series that the scene wants, the affine energy among them if the transfer has an affine
        field."""
        if not self.energy:
            return [field for field in SERIES_FIELDS if not field.name.endswith("_energy")]
        return [*SERIES_FIELDS, AFFINE_ENERGY] if self.affine else list(SERIES_FIELDS)

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Know the dimension."""
        self.dim = setup.dim

    @hookimpl
    def diagnostics(self, state: State) -> dict[str, AnyArray]:
        """All series, (body, …)."""
        density = self._energy_density(state) if self.energy else None
        rows = [self._of(state, body.particles, density) for body in state.bodies]
        return {name: np.array([row[name] for row in rows]) for name in rows[0]}

    def _energy_density(self, state: State) -> FloatArray:
        """Stored energy per reference volume of all material points, (n,) [J/m^3]."""
        f = state.particles.deformation_gradient
        made_of = of_one_material(state.bodies, self.materials)
        return np.concatenate([material.energy_density(f[own]) for own, material in made_of])  # type: ignore[attr-defined]

    def _of(self, state: State, own: slice, density: FloatArray | None) -> dict[str, AnyArray | float]:
        """The series of one body."""
        p = state.particles
        x, v, m = p.position[own], p.velocity[own], p.mass[own]
        mass = m.sum()
        centre, mean = m @ x / mass, m @ v / mass
        r, w = x - centre, v - mean
        spin = (m[:, None] * _cross(r, w)).sum(axis=0)
        row: dict[str, AnyArray | float] = {
            "centre_of_mass": centre,
            "mean_velocity": mean,
            "angular_velocity": _solve_inertia(m, r, spin),
            "linear_momentum": mass * mean,
            "angular_momentum": spin,
        }
        return row if density is None else {**row, **self._energies(state, own, density)}

    def _energies(self, state: State, own: slice, density: FloatArray) -> dict[str, float]:
        """The energies of one body [J]."""
        p = state.particles
        v, m = p.velocity[own], p.mass[own]
        strain = float(density[own] @ p.initial_volume[own])
        kinetic = 0.5 * float(m @ np.einsum("nd,nd->n", v, v))
        row = {"kinetic_energy": kinetic, "strain_energy": strain, "total_energy": kinetic + strain}
        if self.affine and p.affine is not None:
            # A square of edge l moves within itself with the energy m l²/24 C:C.
            edge2 = p.volume[own] ** (2.0 / self.dim)
            row["affine_energy"] = (
                float((m * edge2) @ np.einsum("nij,nij->n", p.affine[own], p.affine[own])) / 24.0
            )
        return row


def of_one_material(bodies: tuple[Body, ...], materials: tuple[object, ...]) -> list[tuple[slice, object]]:
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


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """a × b, (n, 1) in 2D and (n, 3) in 3D."""
    if a.shape[1] == 2:
        product: FloatArray = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])[:, None]
        return product
    return np.cross(a, b)


def _solve_inertia(m: FloatArray, r: FloatArray, spin: FloatArray) -> FloatArray:
    """ω of L = I ω, I = Σ m (|r|² 1 − r rᵀ); one number in 2D."""
    second = (m[:, None] * r).T @ r
    if r.shape[1] == 2:
        trace = np.trace(second)
        return np.asarray(spin / trace if trace > 0.0 else np.zeros(1))
    inertia = np.trace(second) * np.eye(3) - second
    return np.asarray(np.linalg.lstsq(inertia, spin, rcond=None)[0])


VON_MISES = Field(
    "von_mises", ("particle",), "Pa", "von Mises stress, out-of-plane stress included", output=True
)


class VonMises:
    """von Mises stress of the material points, at outputs that hold them."""

    name = "von_mises"
    stage = "output"

    def __init__(self, materials: tuple[object, ...]) -> None:
        self.materials = materials

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The field."""
        return [VON_MISES]

    @hookimpl
    def diagnostics(self, state: State) -> dict[str, AnyArray]:
        """sqrt(3/2 s:s), (n,) [Pa]."""
        parts = []
        for own, material in of_one_material(state.bodies, self.materials):
            stress = material.cauchy_stress(state.particles.deformation_gradient[own])  # type: ignore[attr-defined]
            deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
            parts.append(np.sqrt(1.5 * np.einsum("nij,nij->n", deviator, deviator)))
        return {"von_mises": np.concatenate(parts)}
