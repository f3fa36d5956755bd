"""Energy ledger: where every joule comes from and goes to, measured where it changes hands.

Between the projection and the gather a node's momentum changes from m v⁰ to m v¹ by impulses: of gravity, pressures,
contact, inertia corrections, prescribed sides, and of the internal forces. The work of an impulse is its product with
(v⁰ + v¹) / 2; the works of all add up to the change of the grid's kinetic energy exactly. What the transfer loses is
measured across it: the kinetic energy of the material points less the grid's at the projection, and the reverse at
the gather. What is left over against kinetic and strain energy, the residual, is the difference between the work of
the internal forces and the strain energy: the error of the strain's integration in time.
"""

from __future__ import annotations

from collections.abc import Generator
from types import SimpleNamespace
from typing import Any

import numpy as np

from mpmfw.errors import SimulationError
from mpmfw.fields import AnyArray, Field, FloatArray
from mpmfw.hookspecs import hookimpl
from mpmfw.kernels import kernel
from mpmfw.kernels.types import Floats
from mpmfw.setup import Setup
from mpmfw.state import Grid, Particles, State

#: Growth, as a share of the energy at the start and what was put in since, past which a run is stopped.
GROWTH_LIMIT = 0.5

#: Energy per stiffness and volume that counts as nothing: rounding in bodies at rest is no growth.
NOTHING = 1e-12


def _series(name: str, meaning: str) -> Field:
    return Field(name, (), "J m-1", meaning, "series", output=True)


LEDGER_FIELDS = [
    _series("gravity_work", "work of gravity on all bodies since time zero"),
    _series("external_work", "work of pressures and prescribed sides on all bodies since time zero"),
    _series(
        "contact_work", "work of contact on all bodies since time zero (spring energy taken up is negative)"
    ),
    _series("inertia_work", "kinetic energy that the inertia corrections added on the grid since time zero"),
    _series("transfer_dissipation", "kinetic energy lost between material points and grid since time zero"),
    _series("energy_residual", "kinetic and strain energy that no other term of the ledger accounts for"),
]


@kernel
def grid_energy(mass: Floats, momentum: Floats) -> float:
    """Σ |(m v)_i|² / (2 m_i) over nodes with mass."""
    total = 0.0
    for i in range(len(mass)):
        if mass[i] > 0.0:
            square = 0.0
            for d in range(momentum.shape[1]):
                square += momentum[i, d] * momentum[i, d]
            total += 0.5 * square / mass[i]
    return total


@kernel
def impulse_work(impulse: Floats, mass: Floats, start_velocity: Floats, momentum: Floats) -> float:
    """Σ I_i·(v_i⁰ + v_i¹) / 2 over nodes with mass; ``momentum`` is m v¹."""
    total = 0.0
    for i in range(len(mass)):
        if mass[i] > 0.0:
            for d in range(momentum.shape[1]):
                total += 0.5 * impulse[i, d] * (start_velocity[i, d] + momentum[i, d] / mass[i])
    return total


@kernel
def point_energy(mass: Floats, velocity: Floats) -> float:
    """Σ m v² / 2 over material points."""
    total = 0.0
    for p in range(len(mass)):
        square = 0.0
        for d in range(velocity.shape[1]):
            square += velocity[p, d] * velocity[p, d]
        total += 0.5 * mass[p] * square
    return total


class EnergyLedger:
    """Terms of the energy balance as series, and the end of a run whose energy grows without reason.

    Parameters
    ----------
    materials
        For each body, an object with ``energy_density``.
    gravity, pressure
        The plug-ins of these names, or None.
    terms
        Works that something in the scene does: of ``gravity``, ``external``, ``contact``, ``inertia``. The others
        have no series.
    bounded
        Whether a run whose energy grows past :data:`GROWTH_LIMIT` is stopped.
    """

    name = "energy_ledger"
    stage = "output"

    def __init__(
        self,
        materials: tuple[Any, ...],
        gravity: Any,
        pressure: Any,
        *,
        terms: tuple[str, ...],
        bounded: bool,
    ) -> None:
        self.materials, self.gravity, self.pressure = materials, gravity, pressure
        self.terms, self.bounded = terms, bounded
        self._restart()

    def _restart(self) -> None:
        self.work = dict.fromkeys(("gravity", "external", "contact", "inertia"), 0.0)
        self.dissipated = 0.0
        self.input = 0.0
        self.start: float | None = None
        self.points: float | None = None
        self.constrained = False

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The works that there are, what the transfer loses, and the residual."""
        return [
            field
            for field in LEDGER_FIELDS
            if not field.name.endswith("_work") or field.name.removesuffix("_work") in self.terms
        ]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """What counts as nothing: a share of the stiffness that the bodies have."""
        volumes = [setup.state.particles.volume[body.particles].sum() for body in setup.bodies]
        stiffness = [body.bulk_modulus + body.shear_modulus for body in setup.bodies]
        self.nothing = NOTHING * float(np.dot(volumes, stiffness))

    @hookimpl(wrapper=True)
    def after_momentum_projection(self, grid: Grid, particles: Particles) -> Generator[None, Any, Any]:
        """Particles to grid; then the impulse of contact on the projected momentum."""
        points = point_energy(particles.mass, particles.velocity) if self.points is None else self.points
        self.dissipated += points - grid_energy(grid.mass, grid.momentum)
        self.constrained = False
        before = grid.momentum.copy()
        result = yield
        self.impulse = {"contact": grid.momentum - before}
        return result

    @hookimpl(wrapper=True)
    def add_nodal_force(self, grid: Grid, state: State, dt: float) -> Generator[None, Any, Any]:
        """Impulses of gravity, pressures and contact; what the momentum will be once it is integrated."""
        internal = grid.force.copy()
        result = yield
        gravity, pressure = np.zeros_like(internal), np.zeros_like(internal)
        if self.gravity is not None:
            gravity = grid.mass[:, None] * self.gravity.at(state.time)
        if self.pressure is not None:
            self.pressure.add_nodal_force(grid=SimpleNamespace(force=pressure), state=state)
        self.impulse["gravity"] = dt * gravity
        self.impulse["external"] = dt * pressure
        self.impulse["contact"] += dt * (grid.force - internal - gravity - pressure)
        return result

    @hookimpl(wrapper=True)
    def after_momentum_update(self, grid: Grid) -> Generator[None, Any, Any]:
        """Contact that corrects the updated momentum."""
        return (yield from self._change(grid, "contact"))

    @hookimpl(wrapper=True)
    def correct_inertia(self, grid: Grid) -> Generator[None, Any, Any]:
        """Inertia corrections."""
        return (yield from self._change(grid, "inertia"))

    @hookimpl(wrapper=True)
    def constrain_momentum(self, grid: Grid) -> Generator[None, Any, Any]:
        """Prescribed sides, and the balance of the grid; MUSL and USF ask again for the velocity of the strain,
        which moves nothing."""
        if self.constrained:
            return (yield)
        result = yield from self._change(grid, "external")
        self.constrained = True
        self.moved = grid_energy(grid.mass, grid.momentum)
        for term, impulse in self.impulse.items():
            self.work[term] += impulse_work(impulse, grid.mass, grid.start_velocity, grid.momentum)
        return result

    def _change(self, grid: Grid, term: str) -> Generator[None, Any, Any]:
        """Add the change of the momentum to the impulses of a term."""
        before = grid.momentum.copy()
        result = yield
        self.impulse[term] = self.impulse.get(term, 0.0) + grid.momentum - before
        return result

    @hookimpl
    def end_step(self, state: State) -> None:
        """Grid to particles."""
        self.points = point_energy(state.particles.mass, state.particles.velocity)
        self.dissipated += self.moved - self.points
        self.input = max(self.input, self.work["gravity"] + self.work["external"])

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:
        """The series; at the first output everything starts at zero.

        Raises
        ------
        SimulationError
            The bodies have more energy than they had and were given, by more than :data:`GROWTH_LIMIT`.
        """
        if interval == 0.0:
            self._restart()
        p = state.particles
        energy = point_energy(p.mass, p.velocity) + self._strain_energy(state)
        if self.start is None:
            self.start = energy
        residual = energy - self.start - sum(self.work.values()) + self.dissipated
        if self.bounded:
            self._check(energy, residual, state.time)
        series = {f"{term}_work": np.float64(self.work[term]) for term in self.terms}
        last = {"transfer_dissipation": np.float64(self.dissipated), "energy_residual": np.float64(residual)}
        return {name: np.asarray(value) for name, value in {**series, **last}.items()}

    def _strain_energy(self, state: State) -> float:
        p, total = state.particles, 0.0
        for body, material in zip(state.bodies, self.materials, strict=True):
            own = body.particles
            density: FloatArray = material.energy_density(p.deformation_gradient[own])
            total += float(density @ p.initial_volume[own])
        return total

    def _check(self, energy: float, residual: float, time: float) -> None:
        start = self.start or 0.0
        allowed = start + self.input + self.nothing
        growth = energy - start - self.work["gravity"] - self.work["external"]
        if growth <= GROWTH_LIMIT * allowed:
            return
        causes = {
            "contact": (
                self.work["contact"],
                "a smaller time.safety, or a softer contact (contact.penalty.kappa)",
            ),
            "the inertia correction": (self.work["inertia"], "a smaller time.safety, or rotation = 'lumped'"),
            "the transfer between points and grid": (-self.dissipated, "another stepping.transfer or shape"),
            "the strain's integration in time": (residual, "a smaller time.safety, or scheme 'usl'"),
        }
        cause, (amount, advice) = max(causes.items(), key=lambda item: item[1][0])
        raise SimulationError(
            f"the energy grew by {growth:.4g} J/m without reason, past {GROWTH_LIMIT:g} of the {allowed:.4g} J/m that "
            f"there were and were put in; likely cause: {cause}, which added {amount:.4g} J/m",
            time=time,
            advice=f"{advice}; allow_unstable = true lets the run go on",
        )
