"""Restart: now and then the values that a run keeps, in a file beside its results, from which a run that was
killed goes on.

The file is one of safetensors, a header in JSON before bare numbers, which any reader of that format opens.
It holds arrays by place and names no class and no function. Its sizes are compared with its length, and its
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
from collections.abc import Iterator, Mapping, Sequence
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
from mpmfw.scene.scene import Scene
from mpmfw.scene.sources import Source
from mpmfw.state.fields import AnyArray
from mpmfw.state.history import TYPES

#: How a file begins, after eight bytes that hold the length of the header.
_KIND = "checkpoint 3"
_HEAD = f'{{"__metadata__": {{"mpmfw": "{_KIND}"'.encode()

#: Bytes that a header has at most.
_LONGEST = 1 << 24

#: Types of numbers, as the file calls them.
_NAMES = dict(zip(TYPES, ("F64", "F32", "I64", "I32", "I8", "U8", "BOOL"), strict=True))
_TYPES = {name: number for number, name in _NAMES.items()}

#: Places of the copy of the results, and of the checksum of all bytes before it.
RESULTS, CHECKSUM = "results.nc", "crc32"

#: Root attributes that the results, their copy in the checkpoint and the run that goes on have in common.
_SAME = ("scene", "contact", "shape", "scheme", "transfer")


class Facts(BaseModel):
    """Facts about the run of a checkpoint; others are in its copy of the results."""

    made_by: dict[str, str]  #: code, libraries, interpreter and processor, by name
    scene: Source  #: where the scene came from
    times: list[float]  #: of this checkpoint, after those from which the run was taken up so far [s]
    every: float = Field(ge=0)  #: seconds of wall time between two checkpoints


def checkpoint_path(path: str | os.PathLike[str]) -> str:
    """Return the file of the checkpoint of the run that writes ``path``."""
    return f"{os.fspath(path)}.checkpoint"


def write_snapshot(path: str, saved: Mapping[str, AnyArray], facts: Facts | None = None) -> None:
    """Write arrays by place and the facts about their run, whole or not at all.

    Raises
    ------
    MpmfwError
        The file cannot be written.
    """
    said = json.dumps(None if facts is None else facts.model_dump(mode="json"))
    header: dict[str, Any] = {"__metadata__": {"mpmfw": _KIND, "facts": said}}
    end = 0
    for key, array in {**saved, CHECKSUM: np.zeros(1, dtype=np.int64)}.items():
        offsets = [end, end := end + array.nbytes]
        header[key] = {"dtype": _NAMES[array.dtype.str], "shape": array.shape, "data_offsets": offsets}
    text, check = json.dumps(header).encode(), 0
    with replacement(path) as growing, open(growing, "xb") as file:
        arrays = (np.ascontiguousarray(array).view(np.uint8) for array in saved.values())
        block: Any
        for block in (len(text).to_bytes(8, "little"), text, *arrays):
            check = zlib.crc32(block, check)
            file.write(block)
        file.write(check.to_bytes(8, "little"))


def is_foreign(path: str) -> bool:
    """Return whether something is there that is not a checkpoint; an empty file is nothing."""
    try:
        if not os.path.isfile(path):
            return os.path.lexists(path)
        with open(path, "rb") as file:
            head = file.read(8 + len(_HEAD))
        return bool(head) and head[8:] != _HEAD
    except OSError:
        return True


def read_snapshot(path: str) -> tuple[dict[str, AnyArray], Facts | None]:
    """Read arrays by place, which stay in the file until they are copied, and the facts about their run.

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
        content: Any = _bytes_of(path)
        if not begin <= min(len(content) - 8, _LONGEST):
            raise ValueError("the header is longer than the file")
        if zlib.crc32(content[:-8]) != int.from_bytes(content[-8:].tobytes(), "little"):
            raise ValueError("the checksum is wrong")
        header = json.loads(content[8:begin].tobytes())
        said = json.loads(header.pop("__metadata__")["facts"])
        saved = dict(_arrays_in(header, content[begin:]))
        saved.pop(CHECKSUM)
        return saved, None if said is None else Facts.model_validate(said)
    except OSError as error:
        raise MpmfwError(f"cannot read '{path}': {error.strerror or error}") from error
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError) as error:
        raise MpmfwError(f"'{path}' was cut short or is damaged") from error


def _bytes_of(path: str) -> AnyArray:
    """Return a file's bytes, which are read when they are used.

    Raises
    ------
    MpmfwError
        The file cannot be read.
    """
    try:
        return np.asarray(np.memmap(path, np.uint8, "r"))
    except OSError as error:
        raise MpmfwError(f"cannot read '{path}': {error.strerror or error}") from error


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
        Of the run; results in memory have no checkpoints.
    signals
        Those that stop the run, after a checkpoint.
    every
        Seconds of wall time between two; infinite for none at all.
    objects
        Strategy objects instead of the scene's methods, by kind.
    resumed
        Times at which the run was taken up so far [s].
    """

    def __init__(
        self, simulation: Any, writer: RunWriter, signals: Any, every: float, objects: Mapping[str, Any],
        resumed: Sequence[float] = (),
    ) -> None:  # fmt: skip
        self.simulation, self.writer, self.signals, self.objects = simulation, writer, signals, objects
        self.path = None if writer.path is None else checkpoint_path(writer.path)
        #: Wall time of the next one; infinite where none is wanted or the last could not be written.
        self._next = math.inf if self.path is None else time.monotonic() + every
        if self._next < math.inf:  # now: sources that are edited later are another version
            source = simulation.scene.source
            folder = None if source.directory is None else Path(os.path.abspath(source.directory))
            code = _dependencies(simulation.scene, objects)
            scene = dataclasses.replace(source, directory=folder)
            self._facts = Facts(made_by=code, scene=scene, times=[*resumed, 0.0], every=every)

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
        if now >= self._next:
            self.write()

    def write(self) -> None:
        """Replace the last one; where that fails, a warning says so once and the run goes on without."""
        if self.path is None or self._next == math.inf:
            return
        self.simulation.clock("output")
        try:
            self.writer.flush()
            # A kill within a sync can leave the results' file unreadable: HDF5 changes its tables in place
            results = _bytes_of(str(self.writer.path))
            self._facts.times[-1] = self.simulation.state.time
            write_snapshot(self.path, {**self.simulation.snapshot(), RESULTS: results}, self._facts)
            self._next = time.monotonic() + self._facts.every
        except MpmfwError as error:
            self._next = math.inf
            warnings.warn(f"no checkpoints are written: {error}", ResultsWarning, stacklevel=2)

    def forget(self) -> None:
        """Remove the checkpoint and what unfinished writing left; a foreign file of its name stays."""
        if self.path is not None and not is_foreign(self.path):
            for path in (Path(self.path), *abandoned(self.path), *abandoned(str(self.writer.path))):
                with contextlib.suppress(OSError):
                    path.unlink()


@dataclasses.dataclass(frozen=True)
class Checkpoint:
    """The checkpoint beside the file of a run that did not end."""

    saved: dict[str, AnyArray]  #: by place
    results: AnyArray  #: bytes of the results' file
    made_with: dict[str, str]  #: root attributes of the results
    facts: Facts


def read_checkpoint(path: str) -> Checkpoint:
    """Read the checkpoint beside a run's file.

    Raises
    ------
    SceneError
        The run ended, or is another one; there is no checkpoint, or it is damaged.
    """
    file = checkpoint_path(path)
    if not os.path.isfile(path):
        raise SceneError(f"{path}: there is no such file; expected the results of a run")
    try:
        found = _attributes(path)
    except OSError:
        if not is_hdf5(path) or not os.path.isfile(file):
            check_results(path)
            raise
        found = None  # killed within a sync: the checkpoint has the outputs up to it
    if found and found["kind"] != "run":
        raise SceneError(
            f"{path}: holds no run but results of kind '{found['kind']}'; give the command that made it again"
        )
    if found and is_complete(found["status"]):
        raise SceneError(f"{path}: the run is finished; there is nothing to go on with")
    if not os.path.isfile(file):
        raise SceneError(
            f"{path}: there is no checkpoint beside it ({os.path.basename(file)}); a run writes one every "
            "ten minutes (--checkpoint) and when it is interrupted; run it again"
        )
    try:
        saved, facts = read_snapshot(file)
        if facts is None or RESULTS not in saved:
            raise SceneError(f"{file}: is not a checkpoint of a run")
        results = saved.pop(RESULTS)
        made_with = _attributes("results.nc", results)
    except (MpmfwError, OSError) as error:
        raise SceneError(f"{error}; run it again") from error
    other = [name for name in _SAME if found and found[name] != made_with[name]]
    if other:
        raise SceneError(
            f"{path}: cannot go on from the checkpoint beside it: the file has another {' and '.join(other)}"
        )
    return Checkpoint(saved, results, made_with, facts)


def _attributes(path: str, content: Any = None) -> dict[str, str]:
    """Root attributes of results, as texts."""
    try:
        with netCDF4.Dataset(path, memory=content) as dataset:
            return {name: str(getattr(dataset, name, "")) for name in ("kind", "status", *_SAME)}
    except RuntimeError as error:
        raise OSError(str(error)) from error


def check_same(
    last: Checkpoint, header: RunHeader, scene: Scene, objects: Mapping[str, Any], force: bool
) -> None:
    """Refuse other methods than the run had, and other code, libraries or processor unless ``force``.

    Raises
    ------
    SceneError
        Something differs.
    """
    for kind in _SAME:
        then, now = last.made_with[kind], str(header.attributes[kind])
        if then != now:
            raise SceneError(
                f"{kind}: the run had {then or 'none'}, found {now or 'none'}; mpmfw.resume takes the "
                "strategy objects that the run was given"
            )
    made_by, current = last.facts.made_by, _dependencies(scene, objects)
    changed = [
        f"{name} ({made_by.get(name, 'absent')[:8]} then, {current.get(name, 'absent')[:8]} now)"
        for name in sorted({*made_by, *current})
        if made_by.get(name) != current.get(name)
    ]
    if changed and not force:
        raise SceneError(
            f"another version would go on than began: {', '.join(changed)}; --force (force=True) goes on all "
            "the same, to other numbers"
        )


def _dependencies(scene: Scene, objects: Mapping[str, Any]) -> dict[str, str]:
    """Versions of all on which the bits of a run depend beside its scene, by name."""
    code = code_of(scene, objects.get("contact"), objects.get("shape"))
    return {**code, "python": platform.python_version(), "processor": str(get_host_cpu_name())}


@contextlib.contextmanager
def rewritten(path: str, checkpoint: Checkpoint, header: RunHeader) -> Iterator[RunWriter]:
    """Context of the writer of a new file of results, which has the outputs up to the checkpoint and
    replaces the old one.

    Raises
    ------
    SceneError
        The outputs are damaged, or another run writes the file.
    """
    part = str(unfinished(path))
    with contextlib.ExitStack() as undo:
        try:
            descriptor = claim(path)
            undo.callback(release, path, descriptor)
            undo.callback(Path(part).unlink, missing_ok=True)
            writer = RunWriter(part, header)
            undo.callback(writer.close)
            writer.repeat(checkpoint.results)
        except (MpmfwError, OSError) as error:
            raise SceneError(f"{path}: cannot go on from the checkpoint beside it: {error}") from error
        writer.take_place_of(path, descriptor)
        undo.pop_all()
    with writer:
        yield writer
