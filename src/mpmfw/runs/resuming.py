"""Go on with a run that was killed or interrupted, from its last checkpoint."""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import netCDF4

from mpmfw.errors import MpmfwError, SceneError, is_complete
from mpmfw.results import RunHeader, RunWriter, check_results
from mpmfw.results.memory import restart_peak_memory
from mpmfw.results.reading import is_hdf5
from mpmfw.results.replacing import unfinished
from mpmfw.results.writers import claim, release
from mpmfw.runs.interruption import interruptible
from mpmfw.runs.restart import (
    RESULTS,
    Checkpoints,
    Facts,
    checkpoint_path,
    dependencies_of,
    read_snapshot,
    seconds_between,
)
from mpmfw.runs.run import run_on
from mpmfw.runs.simulation import Simulation
from mpmfw.scene.loading import refuse_code, scene_from
from mpmfw.state.history import NotSaved, Snapshot

if TYPE_CHECKING:
    import xarray as xr

#: Attributes of a results' file that a run which goes on must have as well.
_SAME = ("scene", "contact", "shape", "scheme", "transfer")


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
    """Go on with a run from its last checkpoint; it ends as it would have without the interruption, to the bit.

    Parameters
    ----------
    results
        The run's file; the outputs after the checkpoint are written again.
    contact, shape
        The strategy objects that the run was given, as they were then; not those that the scene names.
    progress
        Called now and then with the simulated time [s] and the number of steps.
    force
        Go on with another version of the code, a library or the interpreter, or on another processor.
    checkpoint
        Wall time, [s] or as ``"10 min"``, between two checkpoints; as before by default.
    threads
        That share the work of each step, in place of the scene's; the results are the same to the bit.
    trust
        Whether the run may name ``module:Class``, whose code is imported; a checkpoint may be a stranger's.

    Returns
    -------
    The results, as :func:`mpmfw.run` returns them; the attribute ``resumed`` tells where it was taken up.

    Raises
    ------
    SceneError
        There is no checkpoint, it is damaged or of another run, the run is finished, or something else than then would run it.
    SimulationError, Interrupted
        As :func:`mpmfw.run`.
    """
    with _resuming(results, contact, shape, progress, force, checkpoint, threads, trust) as writer:
        return writer.results()


def resume_to_file(
    results: str | os.PathLike[str],
    progress: Callable[[float, int], None] | None = None,
    force: bool = False,
    checkpoint: float | str | None = None,
    threads: int | None = None,
    trust: bool = False,
) -> None:
    """Go on with a run and leave its results in the file; the rest is as :func:`resume` says."""
    with _resuming(results, None, None, progress, force, checkpoint, threads, trust):
        pass


@contextmanager
def _resuming(
    results: str | os.PathLike[str],
    contact: Any,
    shape: Any,
    progress: Callable[[float, int], None] | None,
    force: bool,
    checkpoint: float | str | None,
    threads: int | None,
    trust: bool,
) -> Iterator[RunWriter]:
    """The writer of a run that was taken up and has come to its end."""
    every = None if checkpoint is None else seconds_between(checkpoint)
    restart_peak_memory()
    path = os.path.abspath(results)
    _check_unfinished(path)
    snapshot, facts = _read(path, trust)
    objects = _objects(facts, contact, shape)
    resumed = [*facts.resumed, facts.time]
    simulation, header = _restored(snapshot, facts, objects, path, force, threads, resumed)
    every = facts.every if every is None else every
    with interruptible() as signals, _rewritten(snapshot, path, facts.frames, header) as writer:
        run_on(
            simulation, writer, Checkpoints(simulation, writer, signals, every, objects, resumed), progress
        )
        yield writer


def last_checkpoint(results: str | os.PathLike[str], trust: bool = False) -> tuple[float, float]:
    """Time of the checkpoint beside a run's file, and that of the run's end [s].

    Raises
    ------
    SceneError
        There is none, or it is damaged.
    """
    path = os.path.abspath(results)
    _check_unfinished(path)
    facts = _read(path, trust)[1]
    return facts.time, scene_from(facts.source, {}).time.end


def _check_unfinished(path: str) -> None:
    """Refuse what is no file of a run that has not come to its end."""
    if not os.path.isfile(path):
        raise SceneError(f"{path}: there is no such file; expected the results of a run")
    try:
        with netCDF4.Dataset(path) as dataset:
            kind, status = (str(getattr(dataset, name, "")) for name in ("kind", "status"))
    except (OSError, RuntimeError):
        if is_hdf5(path) and os.path.isfile(checkpoint_path(path)):
            return  # killed within a sync: the checkpoint has the outputs up to it
        check_results(path)
        raise
    if kind != "run":
        again = (
            "; what it still lacks is run when its command is given again"
            if kind in ("compare", "study")
            else ""
        )
        raise SceneError(f"{path}: is no run's results, but of kind '{kind}'{again}")
    if is_complete(status):
        raise SceneError(f"{path}: the run is finished; there is nothing to go on with")


def _read(path: str, trust: bool) -> tuple[Snapshot, Facts]:
    file = checkpoint_path(path)
    if not os.path.isfile(file):
        raise SceneError(
            f"{path}: there is no checkpoint beside it ({os.path.basename(file)}); a run writes one every ten minutes "
            "(--checkpoint) and when it is interrupted; run it again"
        )
    try:
        snapshot, facts = read_snapshot(file)
    except MpmfwError as error:
        raise SceneError(f"{error}; run it again") from error
    if facts is None:
        raise SceneError(f"{file}: is no checkpoint of a run")
    if not trust:
        refuse_code(facts.source)
    return snapshot, facts


def _objects(facts: Facts, contact: Any, shape: Any) -> dict[str, Any]:
    """The strategy objects, if they are those that the run was given."""
    given = {kind: one for kind, one in (("contact", contact), ("shape", shape)) if one is not None}
    for kind, label in facts.objects.items():
        if kind not in given:
            raise SceneError(
                f"the run was given a {kind} object, {label}, which no file holds; give it again: "
                f"mpmfw.resume(…, {kind}=…)"
            )
        if given[kind].label != label:
            raise SceneError(f"{kind}: the run was given {label}, and not {given[kind].label}")
    for kind in given:
        if kind not in facts.objects:
            raise SceneError(f"{kind}: the run was given no object; the scene names its {kind}")
    return given


def _restored(
    snapshot: Snapshot, facts: Facts, objects: dict[str, Any], path: str, force: bool, threads: int | None, resumed: list[float]
) -> tuple[Simulation, RunHeader]:  # fmt: skip
    """The simulation as it was, and the header of its results."""
    scene = scene_from(facts.source, {})
    then, now = facts.made_by, dependencies_of(scene, objects)
    changed = [
        f"{name} ({_short(then.get(name))} then, {_short(now.get(name))} now)"
        for name in sorted({*then, *now})
        if then.get(name) != now.get(name)
    ]
    if changed and not force:
        raise SceneError(
            f"{path}: another version would go on than began: {', '.join(changed)}; --force (force=True) goes on all the "
            "same, to other numbers"
        )
    simulation = Simulation(
        scene, contact=objects.get("contact"), shape=objects.get("shape"), threads=threads
    )
    header = simulation.header({"resumed": json.dumps(resumed)})  # names the pairs that its first output has
    _check_same(path, header.attributes)
    try:
        simulation.restore(snapshot)
    except NotSaved as error:
        raise SceneError(
            f"{checkpoint_path(path)}: does not fit what is built from its scene: {error}"
        ) from error
    return simulation, header


def _short(what: str | None) -> str:
    """A version as it is, a hash by its beginning."""
    return "absent" if what is None else what[:8] if len(what) > 40 else what


@contextmanager
def _rewritten(snapshot: Snapshot, path: str, frames: int, header: RunHeader) -> Iterator[RunWriter]:
    """The writer of a file that has the frames up to the checkpoint and takes the place of the old one."""
    part, copy = str(unfinished(path)), str(unfinished(checkpoint_path(path)))
    with contextlib.ExitStack() as undo:
        try:
            descriptor = claim(path)
            undo.callback(release, path, descriptor)
            undo.callback(_unlink, part)
            undo.callback(_unlink, copy)
            snapshot.arrays[RESULTS].tofile(copy)
            writer = RunWriter(part, header)
            undo.callback(writer.close)
            writer.repeat(copy, frames)
        except (MpmfwError, OSError) as error:
            raise SceneError(f"{path}: cannot go on from the checkpoint beside it: {error}") from error
        writer.take_place_of(path, descriptor)
        undo.pop_all()
        _unlink(copy)
    with writer:
        yield writer


def _unlink(path: str) -> None:
    with contextlib.suppress(OSError):
        os.unlink(path)


def _check_same(path: str, attributes: Any) -> None:
    """Refuse a file of another run than the checkpoint's, if it can be read."""
    try:
        with netCDF4.Dataset(path) as dataset:
            other = [name for name in _SAME if str(getattr(dataset, name, "")) != str(attributes[name])]
    except (OSError, RuntimeError):
        return
    if other:
        raise SceneError(
            f"{path}: cannot go on from the checkpoint beside it: the file has another {' and '.join(other)}"
        )
