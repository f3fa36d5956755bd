"""Run one scene and keep its results."""

from __future__ import annotations

import json
import os
import re
import signal
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from typing import TYPE_CHECKING, Any

from mpmfw.errors import Interrupted, MpmfwError, ResultsWarning, SceneError, SimulationError
from mpmfw.results import Frame, RunWriter
from mpmfw.results.provenance import peak_memory, restart_peak_memory
from mpmfw.results.replacing import check_replaceable
from mpmfw.runs.build import chosen_methods
from mpmfw.runs.interruption import interruptible, unbroken
from mpmfw.runs.limits import check_length, remarks_on_threads
from mpmfw.runs.restart import RESULTS, Checkpoints, check_same, checkpoint_path, read_checkpoint
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene, located
from mpmfw.scene.loading import refuse_code, scene_from
from mpmfw.scene.override import parse_value
from mpmfw.state.history import NotSaved
from mpmfw.units import to_si

if TYPE_CHECKING:
    import xarray as xr

#: Seconds of wall time between two checkpoints.
EVERY = 600.0


def run(
    scene: Any,
    contact: Any = None,
    shape: Any = None,
    output: str | os.PathLike[str] | None = None,
    progress: Callable[[float, int], None] | None = None,
    set: Mapping[str, Any] | None = None,
    force: bool = False,
    checkpoint: float | str | None = None,
    threads: int | None = None,
) -> xr.DataTree:
    """Run a scene.

    Parameters
    ----------
    scene
        A TOML file, the name of a shipped scene, nested mappings, or a :class:`mpmfw.scene.Scene`.
    contact, shape
        A plug-in's name or a configured strategy object, instead of the scene's.
    output
        NetCDF file to write, frame by frame; an existing file is replaced only if it is that of a run. None
        keeps the results in memory.
    progress
        Called repeatedly with the simulated time [s] and the number of steps.
    set
        Values by dotted key, which override the scene's.
    force
        Start a run that exceeds the limits of steps or frames in ``mpmfw.runs.limits``.
    checkpoint
        Wall time, [s] or as ``"10 min"``, between two files ``OUTPUT.checkpoint``, from which
        :func:`mpmfw.resume` continues; ten minutes by default, ``math.inf`` for none.
    threads
        Threads of each step, instead of the scene's; the results are the same to the bit.

    Returns
    -------
    The results: groups ``series``, ``particles/<body>``, ``surface/<body>``; costs as root attributes.

    Raises
    ------
    SceneError
        The request was wrong.
    SimulationError
        The run failed; the file and the error's attribute ``results`` have the outputs before.
    Interrupted
        Ctrl-C or SIGTERM; the file has the outputs before, and a checkpoint beside it.
    """
    with begun(scene, contact, shape, output, set, force, checkpoint, threads) as checkpoints:
        return run_on(checkpoints, progress).results()


@contextmanager
def begun(
    scene: Any,
    contact: Any = None,
    shape: Any = None,
    output: str | os.PathLike[str] | None = None,
    set: Mapping[str, Any] | None = None,
    force: bool = False,
    checkpoint: float | str | None = None,
    threads: int | None = None,
) -> Iterator[Checkpoints]:
    """Yield the checkpoints of a run before its first step."""
    if checkpoint is not None and output is None:
        raise SceneError("checkpoint: has no effect on results that are kept in memory; give an output")
    restart_peak_memory()
    every = EVERY if checkpoint is None else seconds_between(checkpoint)
    path = None if output is None else os.path.abspath(output)  # a plug-in may change the working folder
    if path is not None:
        check_replaceable(path, "run")
    loaded = load_scene(scene, set={**chosen_methods(contact, shape), **(set or {})})
    try:
        simulation = Simulation(loaded, contact=contact, shape=shape, threads=threads)
        if not force:
            check_length(simulation)
    except SceneError as error:
        raise located(error, loaded) from error
    header = simulation.header()
    for text in remarks_on_threads(simulation.threads):
        warnings.warn(text, ResultsWarning, stacklevel=4)
    with interruptible() as signals, RunWriter(path, header) as writer:
        checkpoints = Checkpoints(simulation, writer, signals, every, _objects(contact, shape))
        checkpoints.forget()  # of a run that was here before
        yield checkpoints


def _objects(contact: Any, shape: Any) -> dict[str, Any]:
    """Return strategy objects instead of the scene's methods, by kind."""
    given = {"contact": contact, "shape": shape}
    return {kind: one for kind, one in given.items() if not isinstance(one, str | None)}


def seconds_between(given: float | str) -> float:
    """Return the wall time [s] of a number, or of a text such as ``"10 min"``."""
    with suppress(ValueError):
        seconds = to_si(parse_value(given) if isinstance(given, str) else given, "s")
        if isinstance(seconds, int | float) and seconds >= 0.0:
            return float(seconds)
    raise SceneError(
        f"checkpoint {given}: expected a time such as 600 or '10 min'; 0 is after every step, inf never"
    )


def resume(
    results: str | os.PathLike[str],
    contact: Any = None,
    shape: Any = None,
    progress: Callable[[float, int], None] | None = None,
    force: bool = False,
    checkpoint: float | str | None = None,
    threads: int | None = None,
    trust: bool = False,
) -> xr.DataTree:
    """Continue a run from its last checkpoint, with the same bits as without the interruption.

    Parameters
    ----------
    results
        The run's file; the outputs after the checkpoint are written again.
    contact, shape
        The strategy objects of the first call, unchanged.
    force
        Continue with another version of the code, a library or the interpreter, or on another processor.
    trust
        Whether the run may name ``module:Class``, whose code is imported.
    progress, checkpoint, threads
        As in :func:`mpmfw.run`; by default checkpoints are as frequent as before.

    Returns
    -------
    The results, as :func:`mpmfw.run` returns them; ``resumed`` lists the times of resumption.

    Raises
    ------
    SceneError
        The checkpoint is missing, damaged or of another run or version, or the run is finished.
    SimulationError, Interrupted
        As :func:`mpmfw.run`.
    """
    with resumed(results, contact, shape, force, checkpoint, threads, trust) as checkpoints:
        return run_on(checkpoints, progress).results()


@contextmanager
def resumed(
    results: str | os.PathLike[str],
    contact: Any = None,
    shape: Any = None,
    force: bool = False,
    checkpoint: float | str | None = None,
    threads: int | None = None,
    trust: bool = False,
) -> Iterator[Checkpoints]:
    """Yield the checkpoints of a resumed run."""
    restart_peak_memory()
    every = None if checkpoint is None else seconds_between(checkpoint)
    path = os.path.abspath(results)
    saved, facts = read_checkpoint(path)
    if not trust:
        refuse_code(facts.scene)
    scene, content = scene_from(facts.scene, {}), saved.pop(RESULTS)
    simulation = Simulation(scene, contact=contact, shape=shape, threads=threads)
    header = simulation.header({"resumed": json.dumps(facts.times)})  # names the pairs of its start
    check_same(facts, header, scene, _objects(contact, shape), force)
    with interruptible() as signals, ExitStack() as stack:
        try:
            simulation.restore(saved)
            writer = stack.enter_context(RunWriter(path, header, content))
        except NotSaved as error:
            text = f"{checkpoint_path(path)}: does not fit what is built from its scene: {error}"
            raise SceneError(text) from error
        except (MpmfwError, OSError) as error:
            raise SceneError(f"{path}: cannot continue from its checkpoint: {error}") from error
        every = facts.every if every is None else every
        yield Checkpoints(simulation, writer, signals, every, _objects(contact, shape), facts.times)


def run_on(checkpoints: Checkpoints, progress: Callable[[float, int], None] | None) -> RunWriter:
    """Run to the end, or to the end of the step in which a signal comes; return the writer."""
    simulation, writer, signals = checkpoints.simulation, checkpoints.writer, checkpoints.signals

    def write(frame: Frame) -> None:
        with unbroken():
            writer.write(frame)

    try:
        signals.deferring = True
        simulation.run(write, progress, checkpoints)
        attributes = _end(simulation, simulation.status)
        with unbroken():
            writer.finish(attributes)
    except SimulationError as error:
        writer.finish(_end(simulation, f"failed: {error}"))
        error.results = writer.results()
        if signals.waiting is not None:
            raise Interrupted(signals.waiting, f"interrupted; the run had failed: {error}") from error
        raise
    except (MpmfwError, OSError) as error:
        if signals.waiting is not None:
            raise Interrupted(signals.waiting, f"interrupted; the run had failed: {error}") from error
        raise
    except KeyboardInterrupt as error:
        writer.finish(_end(simulation, "interrupted"))
        text = _how_to_go_on(checkpoints)
        raise Interrupted(getattr(error, "number", signal.SIGINT), text) from None
    finally:
        signals.deferring = False
    checkpoints.forget()
    if signals.waiting is not None:
        raise Interrupted(
            signals.waiting, f"interrupted after the last step: {writer.path or 'the run'} is complete"
        )
    for concern in condensed(simulation.concerns()):
        warnings.warn(concern, ResultsWarning, stacklevel=3)
    return writer


def condensed(concerns: list[str]) -> list[str]:
    """Return the first of concerns that differ in label and numbers alone, with the number of the others."""
    alike: dict[str, list[str]] = {}
    for text in concerns:
        alike.setdefault(re.sub(r"^[\w-]+: |[\d.]+(e[+-]\d+)?", "", text), []).append(text)
    return [first + (f" ({len(rest)} more alike)" if rest else "") for first, *rest in alike.values()]


def moment(simulation: Simulation) -> str:
    """Return where a run is, in words: its time is that of the motion, after settling."""
    if simulation.scene.settle is not None and not simulation.started:
        return "in settling, before time zero"
    return f"at {simulation.state.time:.6g} s of {simulation.scene.time.end:g} s"


def _how_to_go_on(checkpoints: Checkpoints) -> str:
    simulation, writer = checkpoints.simulation, checkpoints.writer
    text = f"interrupted {moment(simulation)}"
    how = "run it again for the rest"
    if checkpoints.path is not None and os.path.isfile(checkpoints.path):
        objects = f"mpmfw.resume({writer.path!r}, contact= or shape= as before)"
        how = f"{objects if checkpoints.objects else f'mpmfw resume {writer.path}'} continues it"
    elif writer.path is None or not writer.frames:
        return f"{text}: nothing is kept; run it again"
    return f"{text}: {writer.path} keeps {writer.frames} outputs; {how}"


def _end(simulation: Simulation, status: str) -> dict[str, Any]:
    """Return the attributes of the end; a failed run may have no remarks."""
    remarks: dict[str, list[str]] = {}
    with suppress(MpmfwError) if status.startswith("failed") else nullcontext():
        remarks = simulation.remarks()
    text = {name: json.dumps(words) for name, words in remarks.items() if words}
    return {**simulation.costs(), **text, "peak_memory": peak_memory(), "status": status}
