"""What contact did in every step, measured on the grid round the strategy's own hooks."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mpmfw.api.types import FloatArray, Grid, IntArray, State, hookimpl
from mpmfw.errors import PluginError, SimulationError
from mpmfw.results import Frame
from mpmfw.runs.simulation import Simulation
from mpmfw_testing.check import Inapplicable, Violation
from mpmfw_testing.contact.finite import FiniteWatch
from mpmfw_testing.contact.meeting import Meeting, search_meetings
from mpmfw_testing.saving import remember
from mpmfw_testing.searching import raised
from mpmfw_testing.subject import Subject


@dataclass
class NodalImpulses:
    """What contact gave to the nodes in one step; nodes that got nothing are left out."""

    position: FloatArray  #: (n, dim) x_i [m]
    impulse: FloatArray  #: (n, dim) [N s/m]
    field: IntArray  #: (n,) velocity field

    def of(self, index: int) -> NodalImpulses:
        """Impulses on one velocity field."""
        own = self.field == index
        return NodalImpulses(self.position[own], self.impulse[own], self.field[own])

    def total(self) -> FloatArray:
        """Σ J_i, (dim,) [N s/m]."""
        return np.asarray(self.impulse.sum(axis=0))

    def moment(self, about: FloatArray) -> FloatArray:
        """Σ (x_i − x_0) × J_i, (1,) in 2D, (3,) in 3D [N s]."""
        return moment(self.position - about, self.impulse)

    def magnitude(self) -> float:
        """Σ |J_i| [N s/m]."""
        return float(np.linalg.norm(self.impulse, axis=1).sum())


class ContactRecorder:
    """A plug-in that takes the difference of momentum and force round all contact hooks of a step.

    Scenes of the kit have no gravity, pressure or settling, so that whatever happens there is the strategy's
    doing.
    """

    name = "contact_recorder"

    def __init__(self) -> None:
        self.steps: list[NodalImpulses] = []

    @hookimpl(wrapper=True)
    def after_momentum_projection(self, grid: Grid) -> Generator[None, Any, Any]:
        """Impulse on the projected momentum."""
        before = grid.momentum.copy()
        result = yield
        self.impulse = grid.momentum - before
        return result

    @hookimpl(wrapper=True)
    def add_nodal_force(self, grid: Grid, dt: float) -> Generator[None, Any, Any]:
        """Force times the step."""
        before = grid.force.copy()
        result = yield
        self.impulse += dt * (grid.force - before)
        return result

    @hookimpl(wrapper=True)
    def after_momentum_update(self, grid: Grid) -> Generator[None, Any, Any]:
        """Impulse on the updated momentum; the step's contact is complete."""
        before = grid.momentum.copy()
        result = yield
        self.impulse += grid.momentum - before
        acted = np.flatnonzero(self.impulse.any(axis=1))
        owner = np.searchsorted(grid.offset, acted, side="right") - 1
        self.steps.append(NodalImpulses(grid.position[acted].copy(), self.impulse[acted], owner))
        return result


@dataclass
class Motion:
    """A run of a few dozen steps, observed at every one; the first row of a series is the start."""

    simulation: Simulation
    nodal: list[NodalImpulses]  #: of every step
    dt: list[float] = field(default_factory=list)  #: length of every step [s]
    series: dict[str, list[Any]] = field(default_factory=dict)
    positions: list[FloatArray] = field(
        default_factory=list
    )  #: material points (n, dim) [m], after every step
    failure: SimulationError | None = None  #: what ended the run before its time
    watch: FiniteWatch | None = None  #: knows the first value that is no number

    def require_whole(self) -> None:
        """Raise a violation if the run broke down."""
        if self.failure is not None:
            from mpmfw_testing.contact.drawing import impulses_at

            raise Violation(
                f"the run breaks down: {self.failure.what}",
                {
                    "steps": len(self.dt),
                    "time [s]": float(sum(self.dt)),
                    **(self.watch.first if self.watch is not None else {}),
                },
                impulses_at(self, len(self.dt) - 1) if self.dt else None,
                where=raised(self.failure).where if isinstance(self.failure, PluginError) else (),
            ) from self.failure

    def of(self, name: str) -> FloatArray:
        """A recorded series, (steps + 1, …)."""
        return np.array(self.series[name])

    @property
    def momentum(self) -> FloatArray:
        """Linear momentum, (steps + 1, bodies, dim) [N s/m]."""
        return self.of("linear_momentum")

    @property
    def centre(self) -> FloatArray:
        """Centres of mass, (steps + 1, bodies, dim) [m]."""
        return self.of("centre_of_mass")

    @property
    def velocity(self) -> FloatArray:
        """Mean velocities, (steps + 1, bodies, dim) [m/s]."""
        return self.of("mean_velocity")

    @property
    def energy(self) -> FloatArray:
        """Kinetic and strain energy of all bodies, (steps + 1,) [J/m]."""
        return np.asarray(self.of("total_energy").sum(axis=1))

    @property
    def impulse(self) -> FloatArray:
        """What every body got from contact in every step, (steps, bodies, dim) [N s/m].

        From the nodes of its velocity field; where bodies share one, from the change of its momentum.
        """
        bodies = self.simulation.state.bodies
        if self.simulation.state.grid.n_fields < len(bodies):
            return np.diff(self.momentum, axis=0)
        return np.array([[step.of(b.field).total() for b in bodies] for step in self.nodal])

    @property
    def largest_step(self) -> int:
        """The step in which most was exchanged."""
        return int(np.argmax([step.magnitude() for step in self.nodal]))


@contextmanager
def recorded(simulation: Simulation) -> Iterator[Motion]:
    """Observe a simulation's steps for a while."""
    recorder = ContactRecorder()
    motion = Motion(simulation, recorder.steps, watch=FiniteWatch(simulation.contact))
    with simulation.extra_plugin(recorder), simulation.extra_plugin(motion.watch):
        yield motion


def note(motion: Motion, frame: Frame) -> None:
    """Keep the series of a frame."""
    state: State = motion.simulation.state
    for name, values in frame.series.items():
        motion.series.setdefault(name, []).append(np.array(values))
    motion.positions.append(state.particles.position.copy())
    if len(motion.positions) > 1:
        motion.dt.append(state.dt)


def simulate(
    contact: Any,
    mapping: dict[str, Any],
    steps: int | None = None,
    *,
    duration: float | None = None,
    shape: Any = None,
    partial: bool = False,
) -> Motion:
    """Run a scene for some stable steps, or for about a ``duration`` [s].

    Parameters
    ----------
    contact
        A strategy object or name, or a subject that makes one.
    partial
        Whether a run that breaks down after its first step is handed back as far as it got, for what can be
        told from it.

    Raises
    ------
    Violation
        The run broke down, and is not wanted in part.
    Inapplicable
        The law does not work in as many dimensions.
    """
    made = contact.make() if isinstance(contact, Subject) else contact
    dim, works = len(mapping["grid"]["lower"]), getattr(made, "dimensions", (2, 3))
    if dim not in works:
        raise Inapplicable(f"the law does not work in {dim}D, of which the scene is")
    simulation = Simulation(mapping, contact=made, shape=shape)
    if steps is None:
        steps = math.ceil((duration or 0.0) / simulation.stable_step())
    remember(mapping, steps)
    with recorded(simulation) as motion:
        try:
            simulation.advance(steps, lambda frame: note(motion, frame))
        except SimulationError as error:
            motion.failure = error
            del motion.nodal[len(motion.dt) :]
    if not partial or not motion.dt:
        motion.require_whole()
    return motion


def moment(arm: FloatArray, vector: FloatArray) -> FloatArray:
    """Σ r × a over rows, (1,) in 2D, (3,) in 3D."""
    if arm.shape[1] == 3:
        return np.asarray(np.cross(arm, vector).sum(axis=0))
    return np.array([(arm[:, 0] * vector[:, 1] - arm[:, 1] * vector[:, 0]).sum()])


def meetings(
    form: str = "blocks",
    *,
    steps: int | None = None,
    lasting: float = 1.0,
    partial: bool = False,
    **numbers: Any,
) -> Callable[[Callable[[Meeting, Motion], None]], Callable[[Subject], None]]:
    """Make a check of a function that looks at the motion of one meeting.

    Parameters
    ----------
    form, numbers
        As of :func:`mpmfw_testing.contact.meeting.search_meetings`.
    steps, lasting
        Length of the runs, in steps or as a share of a meeting's duration.
    partial
        Whether the function is given a run that breaks down, as far as it got.
    """

    def check_of(look: Callable[[Meeting, Motion], None]) -> Callable[[Subject], None]:
        @functools.wraps(look)
        def check(subject: Subject) -> None:
            def trial(meeting: Meeting) -> None:
                duration = None if steps is not None else lasting * meeting.duration
                motion = simulate(subject, meeting.mapping(), steps, duration=duration, partial=partial)
                look(meeting, motion)
                motion.require_whole()

            search_meetings(trial, form, **numbers)

        return check

    return check_of
