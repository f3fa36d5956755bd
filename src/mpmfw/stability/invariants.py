"""Invariants of a short run: energy, momentum, penetration, surfaces."""

from __future__ import annotations

import copy
import warnings
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from mpmfw.campaigns.store import Finished, Outcome
from mpmfw.campaigns.work import Task
from mpmfw.errors import PastStabilityLimit, PluginError, ResultsWarning, SceneError, SimulationError
from mpmfw.plugin.checks import cause
from mpmfw.results import Frame
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import State

#: What a run must record to be judged, and need not.
OUTPUT = {f"output.{name}": True for name in ("ledger", "stability", "gap", "energy")}
OUTPUT |= {"output.particles": False, "output.surface": False}


#: What numbers that run away end in; another error of a method is its mistake.
_RUN_AWAY = (ArithmeticError, ValueError, np.linalg.LinAlgError)


@dataclass(frozen=True)
class Invariants:
    """What became of a run."""

    #: ``ok``, ``suspect``, ``refused``, ``failed`` if numbers ran away, ``broken`` if a method raised an
    #: error or its process died
    status: str
    message: str = ""  #: the reason
    steps: int = 0  #: taken after time zero
    time: float = 0.0  #: after them [s]
    #: largest energy, with dissipation and less the work put in, over the energy at the start and what was
    #: put in; positions and velocities are taken at the same time
    energy: float = float("nan")
    energy_end: float = float("nan")  #: last energy, as ``energy``
    stored: float = float("nan")  #: largest energy without dissipation, else as ``energy``
    momentum: float = float("nan")  #: largest change of the total, over the sum of each body's largest
    penetration: float = float("nan")  #: deepest, over the cell size
    #: surface nodes that ended more than half a cell farther from their body's points than they began
    lost: int = 0
    contact_steps: float = float("nan")  #: fewest steps of a surface node's contact; NaN if not counted
    limit: float = float("nan")  #: least stable time step after the first step [s]
    touched: bool = False  #: whether bodies were in contact
    travel: FloatArray | None = None  #: (body, axis) displacement of the centres, over the cell size


def probe(scene: Any, contact: Any = None, shape: Any = None, *, steps: int) -> Invariants:
    """Run a scene for ``steps`` steps after settling, or until it fails, and judge every step."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", ResultsWarning)
        warnings.simplefilter("ignore", RuntimeWarning)
        try:
            loaded = load_scene(scene, set=OUTPUT)
            simulation = Simulation(loaded, contact=contact, shape=shape)
        except SceneError as error:
            return Invariants("refused", str(error))
        begun = _centres(simulation.state), _distances(simulation.state)
        record = Record(simulation)
        status, message = "ok", ""
        try:
            simulation.start()
            begun = _centres(simulation.state), begun[1]
            simulation.advance(steps, record)
            if simulation.status != "ok":
                status, message = "suspect", simulation.status
        except SimulationError as error:
            message = str(error)
            status = "refused" if isinstance(error, PastStabilityLimit) else "failed"
            if isinstance(error, PluginError) and not isinstance(error.__cause__, _RUN_AWAY):
                status = "broken"
        except Hopeless:
            status, message = "failed", "the energy grew beyond all bounds"
        except _RUN_AWAY as error:
            status, message = "failed", f"numbers ran away ({error})"
        return _judged(simulation, record, begun, status, message)


def probe_once(task: Task, steps: int) -> Finished:
    """Probe the scene of a task."""
    try:
        found = asdict(probe(task.scene, copy.deepcopy(task.contact), copy.deepcopy(task.shape), steps=steps))
    except Exception as error:
        return Finished(Outcome(task.key, f"failed: {cause(error)}", task.name, lasting=False))
    found.pop("travel")
    outcome = Outcome(task.key, found["status"], task.name, task.scene.text, values=found, code=task.code)
    return Finished(outcome)


def _judged(
    simulation: Simulation, record: Record, begun: tuple[FloatArray, FloatArray], status: str, message: str
) -> Invariants:
    state, h = simulation.state, simulation.state.grid.cell_size
    if not record.energy:
        return Invariants(status, message, steps=state.steps)
    momentum = np.array(record.momentum)
    drift = np.linalg.norm(momentum.sum(axis=1) - momentum[0].sum(axis=0), axis=-1)
    largest = np.linalg.norm(momentum, axis=-1).max(axis=0).sum()
    return Invariants(
        status,
        message,
        steps=state.steps,
        time=state.time,
        energy=float(np.max(record.energy)),  # NaN if one is
        energy_end=record.energy[-1],
        stored=record.stored,
        momentum=float(drift.max() / largest) if largest > 0.0 else 0.0,
        penetration=max(0.0, -record.gap) / h,
        lost=int(np.sum(~(_distances(state) - begun[1] < 0.5 * h))),
        contact_steps=record.contact_steps if np.isfinite(record.contact_steps) else float("nan"),
        limit=record.limit,
        touched=record.touched,
        travel=(_centres(state) - begun[0]) / h,
    )


def _centres(state: State) -> FloatArray:
    p = state.particles
    own = [body.particles for body in state.bodies]
    return np.array([p.mass[s] @ p.position[s] / p.mass[s].sum() for s in own])


def _distances(state: State) -> FloatArray:
    if state.surface is None:
        return np.zeros(0)
    nearest = np.empty(state.surface.count)
    for body in state.bodies:
        own = state.surface.of(body.index)
        apart = state.surface.position[own][:, None] - state.particles.position[body.particles][None]
        nearest[own] = np.linalg.norm(apart, axis=-1).min(axis=1)
    return nearest


#: Series of energy that is lost.
_LOSSES = (
    "frictional_work", "damping_work", "spring_work", "material_dissipation", "viscous_dissipation",
)  # fmt: skip

#: Energy ratio past which a run is not followed any further.
HOPELESS = 1e3

#: Energy that does not count, as a share of what would strain all bodies by 1: rounding of bodies at rest.
NOTHING = 1e-14


class Hopeless(Exception):
    """A run whose energy is not finite or beyond all bounds."""


class Record:
    """Sums over the bodies at every step of a ``simulation`` with ledger and energy.

    A step leaves velocities half a step behind positions. At the time of the positions the kinetic energy is
    Σ m v·v' / 2, v and v' of the steps before and after: with it a linear system keeps its energy exactly at
    any stable step. The positions' time lies nearer to the velocities of the shorter step.
    """

    def __init__(self, simulation: Simulation) -> None:
        self.state = simulation.state
        particles = simulation.state.particles
        volume = particles.times_thickness(particles.initial_volume)
        stiffness = [body.bulk_modulus + body.shear_modulus for body in simulation.state.bodies]
        volumes = [volume[body.particles].sum() for body in simulation.state.bodies]
        self.nothing = NOTHING * float(np.dot(volumes, stiffness))
        self.energy: list[float] = []  # ratios, with dissipation
        self.stored = 1.0
        self.momentum: list[FloatArray] = []
        self.gap = self.contact_steps = self.limit = np.inf
        self.touched = False
        self.input = self.first = self.first_given = 0.0
        self.length = self.at_positions = 0.0
        self.halves = (0.0, 0.0)
        self.velocity = np.zeros_like(self.state.particles.velocity)

    def __call__(self, frame: Frame) -> None:
        """Judge a step; raise Hopeless at an energy beyond all bounds."""
        series, particles = frame.series, self.state.particles
        at_positions = _total(series, ("strain_energy",))
        halves = _total(series, ("affine_energy",)), _total(series, ("gravity_work", "external_work"))
        if self.momentum:
            kinetic = self._kinetic()
            affine, given = (0.5 * (a + b) for a, b in zip(self.halves, halves, strict=True))
            stored = kinetic + self.at_positions + affine + _total(series, ("contact_energy",))
            self._weigh(stored, _total(series, _LOSSES), given)
        self.length = self.state.dt
        self.velocity, self.at_positions, self.halves = particles.velocity.copy(), at_positions, halves
        self.momentum.append(np.array(series["linear_momentum"]))
        self.gap = min(self.gap, _least(series, "min_gap"))
        if len(self.momentum) > 1:
            self.limit = min(self.limit, _least(series, "time_step_limit"))
            self.contact_steps = min(self.contact_steps, _least(series, "steps_per_contact"))
        self.touched |= bool(np.any(np.asarray(series.get("contact_count", 0.0)) > 0.0))

    def _kinetic(self) -> float:
        """Return kinetic energy at the time of the last positions [J/m]."""
        mass, before, after = self.state.particles.mass, self.velocity, self.state.particles.velocity
        uneven = (self.length - self.state.dt) / (self.length + self.state.dt) if self.energy else 0.0
        both = float(mass @ (before * after).sum(axis=1))
        gained = float(mass @ ((after + before) * (after - before)).sum(axis=1))
        return 0.5 * both + 0.25 * uneven * gained

    def _weigh(self, stored: float, dissipated: float, given: float) -> None:
        """Energy ratios of this step; those of the first are 1."""
        if not self.energy:
            self.first, self.first_given = stored + dissipated, given
        given -= self.first_given
        self.input = max(self.input, given)
        scale = max(self.first + self.input, self.nothing)
        grown = stored - self.first - given
        with_dissipation, without = (
            1.0 if abs(g) <= self.nothing else 1.0 + g / scale for g in (grown + dissipated, grown)
        )
        self.energy.append(with_dissipation)
        self.stored = max(self.stored, without)
        if not with_dissipation < HOPELESS:
            raise Hopeless


def _total(series: Mapping[str, object], names: tuple[str, ...]) -> float:
    return sum(float(np.sum(np.asarray(series[name]))) for name in names if name in series)


def _least(series: Mapping[str, object], name: str) -> float:
    values = np.asarray(series.get(name, np.nan), dtype=float)
    return float(np.nanmin(values)) if np.isfinite(values).any() else np.inf
