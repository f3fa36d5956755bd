"""A simulation: the state, its plug-ins, and the loop over steps and outputs."""

from __future__ import annotations

import contextlib
import math
import sys
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from mpmfw.effects.settling import Settling, concern, is_settled_for_good
from mpmfw.errors import Diverged, PluginError, SceneError, SimulationError
from mpmfw.kernels._jit import import_numba_without_scipy
from mpmfw.plugin.checks import bundled, declared_fields
from mpmfw.plugin.hooks import HOOKS, BoundHooks, Registry
from mpmfw.plugin.setup import Effect, Setup
from mpmfw.results import Frame, RunHeader
from mpmfw.runs.bodies import initial_velocity
from mpmfw.runs.build import build
from mpmfw.runs.frames import Recorder, check_state_finite
from mpmfw.runs.limits import coarse_bodies, outputs_of
from mpmfw.state.fields import STAGES, STEP_STAGES, AnyArray, Field
from mpmfw.state.history import NotSaved, put, take
from mpmfw.state.windows import fit_windows, is_cut_off, set_windows
from mpmfw.step.schemes import SCHEMES, interpolate
from mpmfw.step.timestep import Clock, TimeStep

if TYPE_CHECKING:
    from mpmfw.runs.sleeping import Sleep

import_numba_without_scipy()

#: Steps between two reports of progress.
REPORT_EVERY = 50


class Simulation:
    """One run of one scene, with a separate plug-in manager.

    Parameters
    ----------
    scene
        A valid scene, or what :func:`mpmfw.load_scene` takes.
    contact, shape
        Name of a plug-in, ``module:Class``, a strategy object or its class, instead of the scene's.
    loads
        Load objects by name, on all bodies, beside the scene's.
    threads
        Threads that share the work of a step, instead of the scene's; the results are the same to the bit.

    Raises
    ------
    SceneError
        The scene cannot be built or run by the chosen methods.
    PluginError
        A plug-in does something that it must not.
    """

    history = (
        "started", "_next_output", "_last_output", "_settled", "clock", "_recorder", "_settling", "_sleep",
    )  # fmt: skip

    def __init__(
        self,
        scene: Any,
        *,
        contact: Any = None,
        shape: Any = None,
        loads: Mapping[str, Any] | None = None,
        threads: int | None = None,
    ) -> None:
        if threads is not None and (type(threads) is not int or threads < 1):
            raise SceneError(f"threads: found {threads!r}; expected an integer of at least 1")
        setup = build(scene, contact, shape, loads)
        self._assemble(setup, Clock(), threads or setup.scene.threads)

    @classmethod
    def of(cls, setup: Setup, clock: Clock, threads: int) -> Simulation:
        """Return the simulation of a setup; its time goes to ``clock``."""
        simulation = cls.__new__(cls)
        simulation._assemble(setup, clock, threads)
        return simulation

    def _assemble(self, setup: Setup, clock: Clock, threads: int) -> None:
        self.setup, self.clock, self.threads = setup, clock, threads
        setup.limits = self.limits
        self.scene, self.state, self.contact = setup.scene, setup.state, setup.contact
        self.shape, self.scheme, self.transfer = setup.shape_function, setup.scheme, setup.exchange
        self.effects: tuple[Effect, ...] = tuple(setup.effects)
        if threads > 1:
            from mpmfw.step.threads import Threads

            particles = self.state.particles
            ascend = self.shape.rows_ascend and self.state.self_contact is None
            particles.threads = Threads(min(threads, particles.count), rows_ascend=ascend)
        self.registry = Registry()
        groups: list[Mapping[str, Any]] = [setup.materials, *setup.named.values()]
        named = {id(plugin): f"{plugin.name} {name}" for group in groups for name, plugin in group.items()}
        for plugin in reversed(setup.plugins):  # the last registered is called first
            self.registry.register(plugin, named.get(id(plugin), str(plugin.name)))
        self._bind_hooks()
        state = self.state
        answers = self.hook.declare_fields() or []
        declared = zip(self._callers("declare_fields"), answers, strict=True)
        self.fields: tuple[Field, ...] = declared_fields(declared)
        self.hook.setup(setup=setup)
        fit_windows(state, self.hook)
        self._check_supports()
        self._step: Any = SCHEMES[self.scheme]
        self._time_step = TimeStep(setup)
        self._recorder = Recorder(self.scene, state, self.fields, self.hook, self._callers("diagnostics"))
        self.started = False
        self._settling: Settling | None = None
        self._settled: dict[str, float] = {}
        self._next_output, self._last_output = 0, 0.0  #: number of the next output, and time of the last [s]
        self._time_step.check(self.hook)
        self._sleep: Sleep | None = None
        if self.scene.sleep is not None:
            from mpmfw.runs.sleeping import Sleep

            self._sleep = Sleep(self, setup)
            self._step = self._sleep.step

    def _bind_hooks(self) -> None:
        self.hook: Any = BoundHooks(self.registry, self.clock, self.state)

    def _callers(self, hook: str) -> list[Any]:
        """Plug-ins that implement a hook, in the order of the calls."""
        return [impl.plugin for impl in self.registry.implementations[hook]]

    def _check_supports(self) -> None:
        """Refuse a body whose shape functions reach beyond the grid at the start."""
        # The bundled ones stay in a window that is not cut off
        if bundled(type(self.shape)) and not is_cut_off(self.state.grid):
            return
        try:
            interpolate(self.state, self.hook, self.clock)
        except PluginError:
            raise
        except SimulationError as error:
            raise SceneError(
                f"the shape function '{self.shape.name}' reaches beyond the grid at the start; expected "
                "grid.lower and grid.upper two cells farther out",
                key=f"bodies.{error.body}",
            ) from error

    def hook_callers(self) -> dict[str, list[str]]:
        """Names of the plug-ins that implement each hook, in the order of the calls."""
        names = {id(plugin): name for name, plugin in self.registry.plugins.items()}
        return {hook: [names[id(plugin)] for plugin in self._callers(hook)] for hook in HOOKS}

    # -- how it runs

    def limits(self) -> list[tuple[float, str]]:
        """Every stable time step [s] with its owner, before the safety factor."""
        return self._time_step.limits(self.hook)

    def stable_step(self) -> float:
        """Length of a step [s], with the contacts of the last detection."""
        running = self if self._sleep is None else self._sleep.running
        return running._time_step.next(running.hook)

    def step(self, dt: float | None = None) -> None:
        """Take a step of ``dt`` [s], or of the stable length."""
        self._take_step(self.stable_step if dt is None else lambda: dt)

    def step_towards(self, target: float) -> None:
        """Take one of the equal steps that lead to ``target`` [s] exactly."""
        state, last = self.state, False

        def length() -> float:
            nonlocal last
            remaining = target - state.time
            steps = max(1, math.ceil(remaining / self.stable_step() - 1e-9))
            last = steps == 1
            return remaining / steps

        self._take_step(length)
        if last:
            state.time = target

    def _take_step(self, length: Callable[[], float]) -> None:
        """Take a step of ``length()``, called when the limits are known."""
        state = self.state
        time, steps = state.time, state.steps
        try:
            state.dt = self._step(state, self.hook, self.transfer, self.clock, length)
        except Diverged as error:
            advice = "; ".join(self.setup.remedies.values())
            raise state.error_at(error.index, str(error), advice=advice) from None
        state.time, state.steps = time + state.dt, steps + 1

    @contextlib.contextmanager
    def extra_plugin(self, plugin: Any) -> Iterator[None]:
        """Context in which a plug-in is registered, such as the damping of settling."""
        self.registry.register(plugin, plugin.name)
        self._bind_hooks()
        try:
            yield
        finally:
            self.registry.unregister(plugin.name)
            self._bind_hooks()

    def start(self, after_step: Callable[[], None] | None = None) -> None:
        """Settle if the scene requests it, then set the initial motion: time zero."""
        if self.started:
            return
        if self.scene.settle is not None:
            settling = self.begin_settling()
            with self.extra_plugin(settling):
                self._settled = settling.finish(self.state, self.step, after_step)
            self._settling, self.transfer = None, self.setup.exchange
            settling.end(self.state)
            self.clock.flush()
            if self.contact is not None:
                self.contact.restart()
            self.state.time, self.state.steps = 0.0, 0
            cpu = {f"settle_cpu_{stage}": self.clock.cpu[stage] for stage in STEP_STAGES}
            self._settled |= {"settle_time": sum(cpu.values()), **cpu}
        initial_velocity(self.scene, self.state, lambda: interpolate(self.state, self.hook, self.clock))
        self.started = True
        self.clock.restart()

    def begin_settling(self) -> Settling:
        """Return the settling, whose loads, sides and transfer act from now on."""
        if self._settling is None:
            self._settling = Settling(self.setup)
            self.transfer = self._settling.transfer
            self.clock.restart()
        return self._settling

    def advance(self, steps: int, write: Callable[[Frame], None] | None = None) -> None:
        """Take stable steps; ``write`` gets a frame at the start and after every step."""
        with self.clock.watching_compilation():
            self.start()
        if write is not None:
            self._output(write, 0.0)
        for _ in range(steps):
            self.step()
            if write is not None:
                self._output(write, self.state.dt)
        self._gather()
        self.clock("output")
        self.clock.flush()

    def run(
        self,
        write: Callable[[Frame], None] | None = None,
        progress: Callable[[float, int], None] | None = None,
        after_step: Callable[[], None] | None = None,
    ) -> None:
        """Run to the end; hand a frame to ``write`` at time zero and at every output.

        A restored simulation continues from its state. ``after_step`` is called after every step, also of
        settling; the simulation may be saved there."""
        state, time, last = self.state, self.scene.time, outputs_of(self.scene)
        with self.clock.watching_compilation():
            if self._next_output == 0:
                self.start(after_step)
                self._output(write, 0.0)
                self._next_output = 1
            while (number := self._next_output) <= last:
                exact = time.outputs == "exact" or number == last
                due = time.end if number == last else number * time.output_interval
                target = due if exact else time.end
                # Outputs that are not exact shorten no step: they are at the step's end that is nearest
                while state.time < target and (exact or state.time + 0.5 * state.dt <= due):
                    self.step_towards(target)
                    if progress is not None and state.steps % REPORT_EVERY == 0:
                        progress(state.time, state.steps)
                    if after_step is not None:
                        after_step()
                self._next_output += 1
                if exact or state.time not in (self._last_output, time.end):
                    points = number == last or self._recorder.points_are_due(due)
                    self._output(write, state.time - self._last_output, points=points)
                    self._last_output = state.time

    def frame(self) -> Frame:
        """Return the present arrays, as an output would have them."""
        return self._recorder.frame(0.0)

    def _output(self, write: Callable[[Frame], None] | None, interval: float, *, points: bool = True) -> None:
        self.clock.flush()  # CPU time of steps takes none of the output's
        self.clock("output")
        self._gather()
        frame = self._recorder.frame(interval, points=points)
        if self._next_output == 2 and is_settled_for_good(self.scene):
            kinetic, strain = (float(frame.series[f"{kind}_energy"].sum()) for kind in ("kinetic", "strain"))
            self._settled["settle_motion"] = kinetic / max(strain, sys.float_info.min)
        if write is not None:
            write(frame)
        self.clock.flush()

    def _gather(self) -> None:
        if self._sleep is not None:
            self._sleep.gather(self.state.time)

    # -- how it is kept

    def snapshot(self) -> dict[str, AnyArray]:
        """Return all values that determine the rest of the run."""
        self._gather()
        self.clock.flush()
        return take(self._parts())

    def restore(self, saved: Mapping[str, AnyArray]) -> None:
        """Restore values of a simulation of the same scene and methods; the run then continues with the same
        bits.

        Raise NotSaved if scene or methods differ, or if the values are not those of a simulation."""
        state = self.state
        if "simulation/_settling" not in saved and self.scene.settle is not None:
            self.begin_settling()
        try:
            if state.near is not None and state.near.restore(state, saved["state/pair_bodies"]):
                self.hook.add_pairs(state=state)
            lower, shape = (saved[f"state/grid/window_{name}"] for name in ("lower", "shape"))
            set_windows(state.grid, lower, shape, len(saved["state/grid/mass"]))
        except (LookupError, ValueError, TypeError) as error:
            raise NotSaved("it was not saved where the bodies are") from error
        put(saved, self._parts())

    def restored(self) -> None:
        """Raise NotSaved for values with which the run would never end."""
        state, most = self.state, outputs_of(self.scene) + 1
        if not (
            0.0 <= state.time <= self.scene.time.end and state.dt >= 0.0 and 0 <= self._next_output <= most
        ):
            raise NotSaved(f"time {state.time:g} s and output {self._next_output} are not within the run")
        try:
            check_state_finite(state)
        except SimulationError as error:
            raise NotSaved(str(error)) from error

    def _parts(self) -> dict[str, Any]:
        """Return every object that has values, by its name in messages."""
        others = {
            f"plug-in '{name}'": plugin
            for name, plugin in self.registry.plugins.items()
            if plugin is not self._settling  # which is registered while it steps
        }
        return {"state": self.state, **others, "simulation": self}

    # -- what it leaves

    def header(self, attributes: Mapping[str, Any] | None = None) -> RunHeader:
        """Return the header of the results, with ``attributes`` beside its own."""
        return self._recorder.header(
            {
                "title": self.scene.title or self.scene.name,
                "scene": self.scene.text,
                "contact": "" if self.contact is None else self.contact.label,
                "shape": self.shape.label,
                "scheme": self.scheme,
                "transfer": self.transfer.name,
                "transported": int(self.transfer.transported),
                "rotation": self.setup.rotations,
                "cell_size": self.state.grid.cell_size,
                "outputs": self.scene.time.outputs,
                "output_interval": self.scene.time.output_interval,
                "effects": [{"name": e.name, "on": e.on, "reason": e.reason} for e in self.effects],
                "plugins": {name: type(each).__module__ for name, each in self.registry.plugins.items()},
                **(attributes or {}),
            }
        )

    def concerns(self) -> list[str]:
        """Return warnings for a reader of the results; complete at the end."""
        of_plugins = [text for answer in self.hook.concerns() or [] for text in answer]
        return [*coarse_bodies(self.scene), *concern(self._settled), *of_plugins]

    @property
    def status(self) -> str:
        """``ok``, or ``suspect: …`` with the reasons; complete after the last step."""
        return str(self.registry.plugins["verdict"].status)

    def remarks(self) -> dict[str, list[str]]:
        """Return the warnings, and the names of time step owners."""
        watch = self.registry.plugins.get("time_step_series")
        owners = {} if watch is None else {"time_step_owners": list(watch.owners)}
        return {"warnings": self.concerns(), **owners}

    def costs(self) -> dict[str, float]:
        """Return steps, points, and seconds in all and by stage, settling apart."""
        clock, surface = self.clock, self.state.surface
        return {
            "steps": self.state.steps,
            "material_points": self.state.particles.count,
            "surface_nodes": 0 if surface is None else surface.count,
            "cpu_time": sum(clock.cpu[stage] for stage in STEP_STAGES),
            "wall_time": sum(clock.wall[stage] for stage in STEP_STAGES),
            "gap_time": clock.cpu["gap"],
            "output_time": clock.cpu["output"],
            "settle_time": 0.0,
            "compile_time": clock.compile_time,
            **self._settled,
            **{f"cpu_{stage}": clock.cpu[stage] for stage in STAGES},
            **{f"wall_{stage}": clock.wall[stage] for stage in STAGES},
        }
