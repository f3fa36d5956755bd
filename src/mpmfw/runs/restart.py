"""Restart: now and then the values that a run keeps, in a file beside its results, from which a run that was
killed goes on.

The file is one of safetensors, a header in JSON before bare numbers, which any reader of that format opens.
It holds values by place and names no class and no function. Its sizes are compared with its length, and its
checksum is computed, before anything is used."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import math
import os
import platform
import time
import warnings
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
from llvmlite.binding import get_host_cpu_name  # type: ignore[import-untyped]
from pydantic import BaseModel, Field

from mpmfw.errors import MpmfwError, ResultsWarning, SceneError, is_complete
from mpmfw.results import RunHeader, RunWriter, check_results
from mpmfw.results.reading import is_hdf5
from mpmfw.results.replacing import abandoned, replacement, unfinished
from mpmfw.results.writers import claim, release
from mpmfw.runs.identity import code_of
from mpmfw.scene.loading import refuse_code, scene_from
from mpmfw.scene.override import parse_value
from mpmfw.scene.scene import Scene
from mpmfw.scene.sources import Source
from mpmfw.state.fields import AnyArray
from mpmfw.state.history import TYPES, Snapshot
from mpmfw.units import to_si

#: Seconds of wall time between two checkpoints.
EVERY = 600.0

#: Age of a run [s] from which its code is hashed, which takes the time of a few dozen small steps. Sources
#: that are edited later are another version.
ASKED_AFTER = 1.0

#: How a file begins, after eight bytes that hold the length of the header.
_KIND = "checkpoint 2"
_HEAD = f'{{"__metadata__": {{"mpmfw": "{_KIND}"'.encode()

#: Bytes that a header has at most.
_LONGEST = 1 << 24

#: Types of numbers, as the file calls them.
_NAMES = dict(zip(TYPES, ("F64", "F32", "I64", "I32", "I8", "U8", "BOOL"), strict=True))
_TYPES = {name: number for number, name in _NAMES.items()}

#: Places of the copy of the results, and of the checksum of all bytes before it.
RESULTS, CHECKSUM = "results.nc", "crc32"


class Facts(BaseModel):
    """Facts about the run of a checkpoint."""

    made_by: dict[str, str]  #: see :func:`dependencies_of`
    objects: dict[str, str]  #: labels of strategy objects, by kind
    scene: Source  #: where the scene came from
    frames: int = Field(ge=0)  #: outputs so far
    time: float  #: [s]
    resumed: list[float]  #: times at which the run was taken up again so far [s]
    every: float = Field(ge=0)  #: seconds of wall time between two checkpoints


def seconds_between(given: float | str) -> float:
    """Return the wall time between two checkpoints [s] of a number, or of a text such as ``"10 min"``.

    Raises
    ------
    SceneError
        It is no time, or below 0.
    """
    with contextlib.suppress(ValueError):
        seconds = to_si(parse_value(given) if isinstance(given, str) else given, "s")
        if isinstance(seconds, int | float) and seconds >= 0.0:
            return float(seconds)
    raise SceneError(
        f"checkpoint {given}: expected a time such as 600 or '10 min'; 0 is after every step, inf never"
    )


def checkpoint_path(path: str | os.PathLike[str]) -> str:
    """File of the checkpoint of the run that writes ``path``."""
    return f"{os.fspath(path)}.checkpoint"


def dependencies_of(scene: Any, objects: Mapping[str, Any]) -> dict[str, str]:
    """What the bits of a run depend on beside the ``scene``: code, libraries, interpreter and processor, by
    name.

    ``objects`` are strategy objects in place of the scene's methods, by kind.
    """
    code = code_of(scene, objects.get("contact"), objects.get("shape"))
    return {**code, "python": platform.python_version(), "processor": str(get_host_cpu_name())}


def write_snapshot(
    path: str, snapshot: Snapshot, facts: Facts | None = None, results: str | None = None
) -> None:
    """Write a file, whole or not at all.

    Parameters
    ----------
    path
        Of the file.
    snapshot, facts
        The values, and what is said of the run.
    results
        Another file, of which it has a copy.

    Raises
    ------
    MpmfwError
        It cannot be written.
    """
    check = 0
    with replacement(path) as growing, open(growing, "xb") as file:
        for block in _blocks(snapshot, facts, results):
            check = zlib.crc32(block, check)
            file.write(block)
        file.write(check.to_bytes(8, "little"))


def _blocks(snapshot: Snapshot, facts: Facts | None, results: str | None) -> Iterator[bytes]:
    """The bytes of a file but for the checksum at its end."""
    said = {
        "parts": snapshot.parts,
        "values": snapshot.values,
        "facts": facts and facts.model_dump(mode="json"),
    }
    header: dict[str, Any] = {"__metadata__": {"mpmfw": _KIND, "said": json.dumps(said)}}
    size, end = 0 if results is None else os.path.getsize(results), 0
    arrays = [(key, _NAMES[one.dtype.str], one.shape, one.nbytes) for key, one in snapshot.arrays.items()]
    for key, kind, shape, length in [*arrays, (RESULTS, "U8", (size,), size), (CHECKSUM, "I64", (1,), 8)]:
        header[key] = {"dtype": kind, "shape": shape, "data_offsets": [end, end := end + length]}
    text = json.dumps(header).encode()
    yield len(text).to_bytes(8, "little") + text
    for array in snapshot.arrays.values():
        yield array.tobytes()
    if results is not None:
        with open(results, "rb") as file:
            while block := file.read(min(size, 1 << 20)):
                size -= len(block)
                yield block


def is_foreign(path: str) -> bool:
    """Return whether something is there that is no checkpoint, whatever it is called; an empty file is
    nothing.
    """
    try:
        if not os.path.isfile(path):
            return os.path.lexists(path)
        with open(path, "rb") as file:
            head = file.read(8 + len(_HEAD))
        return bool(head) and head[8:] != _HEAD
    except OSError:
        return True


def read_snapshot(path: str) -> tuple[Snapshot, Facts | None]:
    """Read the snapshot of a file and the facts about its run; arrays stay in the file until they are copied.

    Raises
    ------
    MpmfwError
        There is no such file, another version wrote it, or it is damaged.
    """
    try:
        with open(path, "rb") as file:
            begin = 8 + int.from_bytes(file.read(8), "little")
        if is_foreign(path):
            raise MpmfwError(f"'{path}' is not a checkpoint that this version of mpmfw wrote")
        content: Any = np.asarray(np.memmap(path, np.uint8, "r"))
        if not begin <= min(len(content) - 8, _LONGEST):
            raise ValueError("the header is longer than the file")
        if zlib.crc32(content[:-8]) != int.from_bytes(content[-8:].tobytes(), "little"):
            raise ValueError("the checksum is wrong")
        header = json.loads(content[8:begin].tobytes())
        said = json.loads(header.pop("__metadata__")["said"])
        parts = [str(name) for name in said["parts"]]
        snapshot = Snapshot(parts, dict(said["values"]), dict(_arrays_in(header, content[begin:])))
        return snapshot, None if said["facts"] is None else Facts.model_validate(said["facts"])
    except OSError as error:
        raise MpmfwError(f"cannot read '{path}': {error.strerror or error}") from error
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError) as error:
        raise MpmfwError(f"'{path}' was cut short or is damaged") from error


def _arrays_in(header: Mapping[str, Any], data: AnyArray) -> Iterator[tuple[str, AnyArray]]:
    """Arrays of a file by place, as views of its ``data``, which they fill without gaps."""
    end = 0
    for key, entry in header.items():
        dtype, shape = np.dtype(_TYPES[entry["dtype"]]), entry["shape"]
        if not all(type(length) is int and length >= 0 for length in shape):
            raise ValueError(f"{key}: no shape")
        begin, end = end, end + dtype.itemsize * math.prod(shape)
        if entry["data_offsets"] != [begin, end] or end > len(data):
            raise ValueError(f"{key}: not where it is to be")
        yield key, data[begin:end].view(dtype).reshape(shape)
    if end != len(data):
        raise ValueError("the file is longer than its header says")


class Checkpoints:
    """Called after every step of a run: writes a checkpoint when it is time, or when a signal waits.

    Parameters
    ----------
    simulation, writer
        What runs, and what it writes; one in memory has no checkpoints.
    signals
        Those that stop the run: after a checkpoint.
    every
        Seconds of wall time between two; infinite for none at all.
    objects
        Strategy objects in place of the scene's methods, by kind.
    resumed
        Times at which the run was taken up again so far [s].
    """

    def __init__(
        self,
        simulation: Any,
        writer: Any,
        signals: Any,
        every: float,
        objects: dict[str, Any],
        resumed: list[float],
    ) -> None:
        self.simulation, self.writer, self.signals = simulation, writer, signals
        self.path = None if writer.path is None else checkpoint_path(writer.path)
        self.every, self.objects, self.resumed = every, objects, resumed
        self._wanted = self.path is not None and every < math.inf
        self._code: dict[str, str] = {}
        self._next = time.monotonic() + every
        #: When there is something to do: to hash the code, or to write.
        self._due = min(self._next, time.monotonic() + ASKED_AFTER) if self._wanted else math.inf

    def __call__(self) -> None:
        """A step is complete.

        Raises
        ------
        Interrupted
            A signal waited.
        """
        if self.signals.waiting is not None:
            self.write()
            self.signals.check()
        now = time.monotonic()
        if self.writer.is_due(now):  # the next output may be far away
            self.simulation.clock("output")
            self.signals.whole(self.writer.flush)()
        if now < self._due:
            return
        if now >= self._next:
            self.write()
        elif not self._code:
            self._hash_code()
        self._due = self._next

    def write(self) -> None:
        """Write one in place of the last; where that cannot be, a warning says so once and the run goes on
        without.
        """
        if self.path is None or not self._wanted:
            return
        if not self._code:
            self._hash_code()
        self.simulation.clock("output")
        try:
            self.writer.flush()
            # A kill within a sync can leave the results' file unreadable: HDF5 changes its tables in place
            write_snapshot(self.path, self.simulation.snapshot(), self._facts(), results=self.writer.path)
        except MpmfwError as error:
            self._wanted = False
            warnings.warn(f"no checkpoints are written: {error}", ResultsWarning, stacklevel=2)
        self._next = time.monotonic() + self.every

    def forget(self) -> None:
        """Remove it, and what one that was cut short has left; a file that is called so and is none stays."""
        if self.path is not None and not is_foreign(self.path):
            for path in (Path(self.path), *abandoned(self.path), *abandoned(self.writer.path)):
                with contextlib.suppress(OSError):
                    os.unlink(path)

    @property
    def written(self) -> bool:
        """Whether there is one."""
        return self.path is not None and os.path.isfile(self.path)

    def _hash_code(self) -> None:
        self.simulation.clock("output")
        self._code = dependencies_of(self.simulation.scene, self.objects)

    def _facts(self) -> Facts:
        """What is to be known before the values are read."""
        source = self.simulation.scene.source
        folder = None if source.directory is None else Path(os.path.abspath(source.directory))
        return Facts(
            made_by=self._code,
            objects={kind: method.label for kind, method in self.objects.items()},
            scene=dataclasses.replace(source, directory=folder),
            frames=self.writer.frames,
            time=self.simulation.state.time,
            resumed=self.resumed,
            every=self.every,
        )


def read_checkpoint(path: str, trust: bool) -> tuple[Snapshot, Facts, Scene]:
    """Return the checkpoint beside a run's file, the facts about the run, and its scene.

    Raises
    ------
    SceneError
        There is no run that goes on, or no checkpoint; it is damaged, of another run, or names code that is
        not trusted.
    """
    file = checkpoint_path(path)
    text = _unfinished_scene(path)
    if not os.path.isfile(file):
        raise SceneError(
            f"{path}: there is no checkpoint beside it ({os.path.basename(file)}); a run writes one every "
            "ten minutes "
            "(--checkpoint) and when it is interrupted; run it again"
        )
    try:
        snapshot, facts = read_snapshot(file)
    except MpmfwError as error:
        raise SceneError(f"{error}; run it again") from error
    if facts is None:
        raise SceneError(f"{file}: is no checkpoint of a run")
    if not trust:
        refuse_code(facts.scene)
    scene = scene_from(facts.scene, {})
    if text is not None and text != scene.text:
        raise SceneError(f"{path}: cannot go on from the checkpoint beside it: the file has another scene")
    return snapshot, facts, scene


def _unfinished_scene(path: str) -> str | None:
    """Return the scene's text in the file of a run that has not come to its end; None in a file that is
    damaged.
    """
    if not os.path.isfile(path):
        raise SceneError(f"{path}: there is no such file; expected the results of a run")
    try:
        with netCDF4.Dataset(path) as dataset:
            kind, status, scene = (str(getattr(dataset, name, "")) for name in ("kind", "status", "scene"))
    except (OSError, RuntimeError):
        if is_hdf5(path) and os.path.isfile(checkpoint_path(path)):
            return None  # killed within a sync: the checkpoint has the outputs up to it
        check_results(path)
        raise
    if kind != "run":
        raise SceneError(
            f"{path}: is no run's results, but of kind '{kind}'; give the command that made it again"
        )
    if is_complete(status):
        raise SceneError(f"{path}: the run is finished; there is nothing to go on with")
    return scene


def check_same(facts: Facts, scene: Scene, objects: Mapping[str, Any], force: bool) -> None:
    """Refuse other strategy objects than the run was given, and other code, libraries or processor unless
    ``force``.

    Raises
    ------
    SceneError
        Something differs.
    """
    labels = {kind: method.label for kind, method in objects.items()}
    for kind in {*labels, *facts.objects}:
        then, now = facts.objects.get(kind, "no object"), labels.get(kind, "none")
        if then != now:
            raise SceneError(
                f"{kind}: the run was given {then}, found {now}; mpmfw.resume(…, {kind}=…) takes the same"
            )
    current = dependencies_of(scene, objects)
    changed = [
        f"{name} ({facts.made_by.get(name, 'absent')[:8]} then, {current.get(name, 'absent')[:8]} now)"
        for name in sorted({*facts.made_by, *current})
        if facts.made_by.get(name) != current.get(name)
    ]
    if changed and not force:
        raise SceneError(
            f"another version would go on than began: {', '.join(changed)}; --force (force=True) goes on all "
            "the same, to "
            "other numbers"
        )


@contextlib.contextmanager
def rewritten(snapshot: Snapshot, path: str, frames: int, header: RunHeader) -> Iterator[RunWriter]:
    """The writer of a file that has the frames up to the checkpoint and takes the place of the old one."""
    part, copy = str(unfinished(path)), str(unfinished(checkpoint_path(path)))
    with contextlib.ExitStack() as undo:
        try:
            descriptor = claim(path)
            undo.callback(release, path, descriptor)
            undo.callback(Path(part).unlink, missing_ok=True)
            undo.callback(Path(copy).unlink, missing_ok=True)
            snapshot.arrays[RESULTS].tofile(copy)
            writer = RunWriter(part, header)
            undo.callback(writer.close)
            writer.repeat(copy, frames)
        except (MpmfwError, OSError) as error:
            raise SceneError(f"{path}: cannot go on from the checkpoint beside it: {error}") from error
        writer.take_place_of(path, descriptor)
        undo.pop_all()
        Path(copy).unlink(missing_ok=True)
    with writer:
        yield writer
