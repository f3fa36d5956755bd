"""Run a scene for a number of steps and judge it by its invariants: energy, momentum, penetration,
surfaces.
"""

from __future__ import annotations

import copy
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from mpmfw.campaigns.outcome import Finished, Outcome
from mpmfw.campaigns.work import Task
from mpmfw.errors import PastStabilityLimit, PluginError, ResultsWarning, SceneError, SimulationError
from mpmfw.plugin.checks import cause
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.stability.record import Hopeless, Record
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import State

#: What a run must record to be judged, and need not.
OUTPUT = {
    "output.ledger": True,
    "output.stability": True,
    "output.gap": True,
    "output.energy": True,
    "output.particles": False,
    "output.surface": False,
}


#: What numbers that run away end in; another error of a method is its mistake.
_RUN_AWAY = (ArithmeticError, ValueError, np.linalg.LinAlgError)


@dataclass(frozen=True)
class Invariants:
    """What became of a run.

    Attributes
    ----------
    status
        ``ok``, ``suspect``, ``refused``, ``failed`` if numbers ran away, ``broken`` if a method raised an
        error or its process died.
    message
        Why it is not ``ok``.
    steps
        Steps taken after time zero.
    time
        Simulated time [s].
    energy
        Largest energy plus dissipation less the work put in, over the energy at the start and what was put
        in; of all steps, positions and velocities taken at the same time. NaN if it is no number.
    energy_end
        The same at the end.
    stored
        Largest energy without dissipation, else as ``energy``.
    momentum
        Largest change of the bodies' total linear momentum, over the sum of the largest of each.
    penetration
        Deepest penetration, over the cell size.
    lost
        Surface nodes that ended more than half a cell farther from their body's material points than they
        began.
    contact_steps
        Fewest steps that a contact of a surface node lasted; NaN where nothing counts them.
    limit
        Least stable time step after the first step [s]; before it, a contact has not seen where its bodies
        meet.
    touched
        Whether bodies were in contact.
    travel
        (body, axis) displacement of the centres at the end, over the cell size.
    """

    status: str
    message: str = ""
    steps: int = 0
    time: float = 0.0
    energy: float = float("nan")
    energy_end: float = float("nan")
    stored: float = float("nan")
    momentum: float = float("nan")
    penetration: float = float("nan")
    lost: int = 0
    contact_steps: float = float("nan")
    limit: float = float("nan")
    touched: bool = False
    travel: FloatArray | None = None


def probe(
    scene: Any,
    contact: Any = None,
    shape: Any = None,
    set: Mapping[str, Any] | None = None,
    *,
    steps: int,
) -> Invariants:
    """Run a scene for a number of steps, or until it fails, and judge every step.

    Parameters
    ----------
    scene, contact, shape, set
        As ``mpmfw.run`` takes them; outputs and their times have no effect.
    steps
        Steps to take after settling.

    Returns
    -------
    Invariants
        Also of a run that was refused or failed.
    """
    with _quiet():
        try:
            loaded = load_scene(scene, set={**(set or {}), **OUTPUT})
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
    """Probe the scene of a task and return its invariants; without any of a method that raises an error."""
    try:
        found = asdict(probe(task.scene, copy.deepcopy(task.contact), copy.deepcopy(task.shape), steps=steps))
    except Exception as error:
        return Finished(Outcome(task.key, f"failed: {cause(error)}", task.name, lasting=False))
    found.pop("travel")
    outcome = Outcome(task.key, found["status"], task.name, task.scene.text, values=found, code=task.code)
    return Finished(outcome)


@contextmanager
def _quiet() -> Iterator[None]:
    """Without warnings of numbers that run away, and of what a reader of results must know."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", ResultsWarning)
        warnings.simplefilter("ignore", RuntimeWarning)
        yield


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
    """(body, axis) centres of mass [m]."""
    p = state.particles
    own = [body.particles for body in state.bodies]
    return np.array([p.mass[s] @ p.position[s] / p.mass[s].sum() for s in own])


def _distances(state: State) -> FloatArray:
    """(surface_node,) distance to the nearest material point of the own body [m]."""
    if state.surface is None:
        return np.zeros(0)
    nearest = np.empty(state.surface.count)
    for body in state.bodies:
        own = state.surface.of(body.index)
        apart = state.surface.position[own][:, None] - state.particles.position[body.particles][None]
        nearest[own] = np.linalg.norm(apart, axis=-1).min(axis=1)
    return nearest
