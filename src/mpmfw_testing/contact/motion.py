"""The motion of a scene with contact, and what contact did to the grid in every step."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmfw.api.contact import ContactRows
from mpmfw.api.types import AnyArray, FloatArray, Grid, IntArray
from mpmfw.errors import PluginError, SimulationError
from mpmfw.plugin.hooks import Observer
from mpmfw.results import Frame
from mpmfw.runs.simulation import Simulation
from mpmfw_testing.check import Inapplicable, Violation, remember, within
from mpmfw_testing.contact.impact import CELL, Impact, search_impacts
from mpmfw_testing.searching import raised
from mpmfw_testing.subject import Subject

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")
#: Energy that bodies may gain, as a share of that at the start.
GAINED = 0.005
#: Difference of two motions that should be the same, as a share of a cell and of the largest momentum.
SAME = 1e-9
#: Steps of motions that are compared.
STEPS = 45


@dataclass
class NodalImpulses:
    """The impulses of contact on the nodes in one step; nodes that got nothing are left out."""

    position: FloatArray  #: (n, dim) x_i [m]
    impulse: FloatArray  #: (n, dim) [N s/m]
    field: IntArray  #: (n,) velocity field

    def of(self, index: int) -> NodalImpulses:
        """Return the impulses on one velocity field."""
        own = self.field == index
        return NodalImpulses(self.position[own], self.impulse[own], self.field[own])

    def total(self) -> FloatArray:
        """Return Σ J_i, (dim,) [N s/m]."""
        return np.asarray(self.impulse.sum(axis=0))

    def magnitude(self) -> float:
        """Return Σ |J_i| [N s/m]."""
        return float(np.linalg.norm(self.impulse, axis=1).sum())


class ContactRecorder(Observer):
    """Records the changes of momentum and force by all contact hooks of a step, and the first value that is
    not a number.

    Scenes of the kit have no gravity, pressure or settling, so that all changes there are the strategy's.
    """

    name = "contact_recorder"
    observes = ("detect", "after_momentum_projection", "add_nodal_force", "after_momentum_update")
    running = True

    def __init__(self, contact: Any) -> None:
        self.contact, self.steps = contact, list[NodalImpulses]()
        self.first_bad: dict[str, object] = {}  #: array, place, hook and step of the first such value

    def before(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:  # noqa: ARG002
        """Keep momentum and force."""
        if plugin is None:
            self._look(f"before {hook}", grid)
            if hook == "after_momentum_projection":
                self.impulse = np.zeros_like(grid.momentum)
            self.momentum, self.force = grid.momentum.copy(), grid.force.copy()

    def after(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:
        """Add the impulse of a hook; after the last one the step's contact is complete."""
        if plugin is not None:
            return
        self._look(f"in {hook}", grid)
        if hook == "add_nodal_force":
            self.impulse += dt * (grid.force - self.force)
        elif hook != "detect":
            self.impulse += grid.momentum - self.momentum
        if hook == "after_momentum_update":
            acted = np.flatnonzero(self.impulse.any(axis=1))
            owner = np.searchsorted(grid.offset, acted, side="right") - 1
            self.steps.append(NodalImpulses(grid.position[acted].copy(), self.impulse[acted], owner))

    def _look(self, when: str, grid: Grid) -> None:
        """Find a value that is not finite; forces and momenta of massless nodes may be."""
        if self.first_bad:
            return
        rows, has_mass = getattr(self.contact, "rows", None), grid.mass > 0.0
        arrays: dict[str, AnyArray] = {"grid.mass": grid.mass}
        if isinstance(rows, ContactRows):
            arrays = {f"rows.{name}": getattr(rows, name)[: rows.count] for name in ("normal", "force")}
        for name in ("momentum", "force"):
            arrays[f"grid.{name}"] = np.where(has_mass[:, None], getattr(grid, name), 0.0)
        for name, array in arrays.items():
            bad = np.flatnonzero(~np.isfinite(array).all(axis=tuple(range(1, array.ndim))))
            if len(bad):
                node = ", ".join(f"{x:.6g}" for x in grid.position[bad[0]])
                at = f", node at ({node}) m" if name.startswith("grid") else ""
                self.first_bad = {
                    "first that is no number": f"{name}[{bad[0]}]{at}",
                    "made": f"{when}, step {len(self.steps) + 1}",
                }
                return


class Motion:
    """A simulation with contact, observed at every step; the first row of a series is the start.

    ``contact`` is a strategy object or name, or a subject that makes one; the name of a ``shape`` function
    replaces that of the scene, ``mapping``. ``Inapplicable`` is raised of a law for other dimensions.
    """

    def __init__(self, contact: Any, mapping: Mapping[str, Any], shape: Any = None) -> None:
        made = contact.make() if isinstance(contact, Subject) else contact
        dim = len(mapping["grid"]["lower"])
        if dim not in getattr(made, "dimensions", (2, 3)):
            raise Inapplicable(f"the law does not work in {dim}D, of which the scene is")
        self.simulation, self.mapping, self.asked = Simulation(mapping, contact=made, shape=shape), mapping, 0
        self.failure: SimulationError | None = None  #: the error that ended the run early
        self.forget()

    def forget(self) -> None:
        """Clear the record."""
        self.recorder = ContactRecorder(self.simulation.contact)
        self.series: dict[str, list[Any]] = {}
        self.positions: list[FloatArray] = []  #: of points (n, dim) [m], at every output
        self.dt: list[float] = []  #: length of every step [s]

    def advance(self, steps: int, dt: float | None = None, *, partial: bool = False) -> Motion:
        """Take a number of steps, stable ones or of length ``dt`` [s], with an output at first and after
        each.

        A run that breaks down is a violation; ``partial`` allows this after the first step.
        """
        self.asked += steps
        remember(self.mapping, self.asked, self.draw)
        try:
            with self.simulation.extra_plugin(self.recorder):
                if dt is None:
                    self.simulation.advance(steps, self._note)
                else:
                    self.simulation.advance(0, self._note)
                    for _ in range(steps):
                        self.simulation.step(dt)
                        self.simulation.advance(0, self._note)
        except SimulationError as error:
            self.failure = error
        if not partial or not self.dt:
            self.require_whole()
        return self

    def _note(self, frame: Frame) -> None:
        """Keep the series of a frame."""
        state = self.simulation.state
        for name, values in frame.series.items():
            self.series.setdefault(name, []).append(np.array(values))
        self.positions.append(state.particles.position.copy())
        if len(self.recorder.steps) > len(self.dt):
            self.dt.append(state.dt)

    @property
    def nodal(self) -> list[NodalImpulses]:
        """Return the impulses of every step that is complete."""
        return self.recorder.steps[: len(self.dt)]

    def require_whole(self) -> None:
        """Raise a violation if the run broke down."""
        if self.failure is not None:
            raise Violation(
                f"the run breaks down: {self.failure.what}",
                {"steps": len(self.dt), "time [s]": float(sum(self.dt)), **self.recorder.first_bad},
                where=raised(self.failure).where if isinstance(self.failure, PluginError) else (),
            ) from self.failure

    def require_no_gain(self, who: str) -> None:
        """Raise a violation where kinetic and strain energy grow by more than ``GAINED``."""
        energy = self.of("total_energy").sum(axis=1)
        text = f"{who} gain energy from contact (growth over the energy at the start)"
        within(energy.max() / energy[0] - 1.0, GAINED, text, {"step": int(energy.argmax())})

    def require_stopped(self, impact: Impact, share: float, who: str = "bodies that meet") -> None:
        """Raise a violation if more than a share of the speed of approach is left at the end."""
        text = f"{who} are not stopped: a share of the speed of approach is left"
        within(self.left() @ impact.normal / impact.speed, share, text)

    def left(self) -> FloatArray:
        """Return the velocity of the first body against the second at the end, (dim,) [m/s]."""
        first, second = self.series["mean_velocity"][-1][:2]
        return np.asarray(first - second)

    def of(self, name: str) -> FloatArray:
        """Return a recorded series, (steps + 1, …)."""
        return np.array(self.series[name])

    @property
    def momentum(self) -> FloatArray:
        """Return linear momentum, (steps + 1, bodies, dim) [N s/m]."""
        return self.of("linear_momentum")

    @property
    def impulse(self) -> FloatArray:
        """Return the impulse of contact on every body in every step, (steps, bodies, dim) [N s/m].

        From the nodes of its velocity field; where bodies share one, from the change of its momentum.
        """
        bodies = self.simulation.state.bodies
        if self.simulation.state.grid.n_fields < len(bodies):
            return np.diff(self.momentum, axis=0)
        return np.array([[step.of(b.field).total() for b in bodies] for step in self.nodal])

    def difference(self, other: Motion, back: Callable[[FloatArray], FloatArray] = np.asarray) -> float:
        """Return the largest difference of centres [cells] and relative momenta.

        ``back`` undoes a placement of the other's scene, whose bodies may be in another order.
        """
        order = [[b.name for b in m.simulation.state.bodies] for m in (self, other)]
        same = [order[1].index(name) for name in order[0]]
        centre, momentum = self.of("centre_of_mass"), self.momentum
        apart = np.abs(centre - back(other.of("centre_of_mass")[:, same])).max() / CELL
        turned = back(other.momentum[:, same]) - back(np.zeros((1, centre.shape[-1])))
        return float(max(apart, np.abs(momentum - turned).max() / np.abs(momentum).max()))

    def draw(self, axes: Any, case: Mapping[str, object]) -> None:
        """Draw points and nodal impulses of the step that the case names, or of the largest step."""
        from mpmfw.plots.style import dress

        sizes = [nodal.magnitude() for nodal in self.nodal]
        step = int(str(case["step"])) - 1 if "step" in case else int(np.argmax(sizes or [0.0]))
        step = min(max(step, 0), len(self.positions) - 1)
        for body in self.simulation.state.bodies:
            x = self.positions[step][body.particles]
            colour, label = COLOURS[body.index % 4], f"points of '{body.name}'"
            axes.plot(x[:, 0], x[:, 1], ".", color=colour, markersize=2.5, label=label)
        if step < len(sizes) and sizes[step] > 0.0:
            nodal = self.nodal[step]
            longest = np.linalg.norm(nodal.impulse, axis=1).max()
            arrow = 1.5 * CELL / longest * nodal.impulse
            colours = [COLOURS[index % 4] for index in nodal.field]
            units = {"angles": "xy", "scale_units": "xy", "scale": 1.0}
            axes.quiver(
                *nodal.position[:, :2].T, *arrow[:, :2].T, color=colours, width=0.006, zorder=3, **units
            )
            label = f"nodal impulses of step {step + 1}, longest {longest:.3g} N s/m"
            axes.plot([], [], "-", color="0.2", label=label)
        dress(axes, "x [m]", "y [m]")
        axes.set_aspect("equal", adjustable="datalim")
        axes.legend()


def simulate(
    contact: Any,
    mapping: Mapping[str, Any],
    steps: int | None = None,
    *,
    duration: float = 0.0,
    shape: Any = None,
    partial: bool = False,
) -> Motion:
    """Return the motion of a scene for some stable steps, or for about a ``duration`` [s]."""
    motion = Motion(contact, mapping, shape)
    if steps is None:
        steps = math.ceil(duration / motion.simulation.stable_step())
    return motion.advance(steps, partial=partial)


def moment(arm: FloatArray, vector: FloatArray) -> FloatArray:
    """Return Σ r × a over rows, (1,) in 2D, (3,) in 3D."""
    if arm.shape[1] == 3:
        return np.asarray(np.cross(arm, vector).sum(axis=0))
    return np.array([(arm[:, 0] * vector[:, 1] - arm[:, 1] * vector[:, 0]).sum()])


def impacts(
    form: str = "blocks",
    *,
    steps: int | None = None,
    lasting: float = 1.0,
    partial: bool = False,
    **numbers: Any,
) -> Callable[[Callable[[Impact, Motion], None]], Callable[[Subject], None]]:
    """Make a check of a function that looks at the motion of one impact.

    ``form`` and ``numbers`` are those of ``search_impacts``. A run has so many ``steps``, or a share
    ``lasting`` of an impact's duration. With ``partial`` a run that breaks down counts as far as it got.
    """

    def check_of(look: Callable[[Impact, Motion], None]) -> Callable[[Subject], None]:
        @functools.wraps(look)
        def check(subject: Subject) -> None:
            def trial(impact: Impact) -> None:
                duration = lasting * impact.duration
                motion = simulate(subject, impact.mapping(), steps, duration=duration, partial=partial)
                look(impact, motion)
                motion.require_whole()

            search_impacts(trial, form, **numbers)

        return check

    return check_of
