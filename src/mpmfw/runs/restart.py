"""Restart: checkpoints of a run, files beside its results from which it can continue.

The file is an archive of NumPy (``.npz``) of arrays by place, with checksums. It names no class and no
function."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import math
import os
import platform
import time
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
from llvmlite.binding import get_host_cpu_name  # type: ignore[import-untyped]
from pydantic import BaseModel, Field

from mpmfw.errors import Interrupted, MpmfwError, ResultsWarning, SceneError, is_complete
from mpmfw.results import RunHeader, RunWriter, check_results
from mpmfw.results.reading import is_hdf5
from mpmfw.results.replacing import abandoned, replacement
from mpmfw.runs.identity import code_of
from mpmfw.runs.interruption import unbroken
from mpmfw.scene.scene import Scene
from mpmfw.scene.sources import Source
from mpmfw.state.fields import AnyArray
from mpmfw.state.history import TYPES

#: First array of a file: the number of the others and the facts, as JSON. Its name begins at byte 30 of the
#: archive and names the format.
_FACTS = "mpmfw checkpoint 5"

#: Place of the copy of the results.
RESULTS = "results.nc"

#: Root attributes that the results, the checkpoint and the run that goes on have in common.
_SAME = ("scene", "contact", "shape", "scheme", "transfer")


class Facts(BaseModel):
    """Facts about the run of a checkpoint."""

    same: dict[str, str]  #: the attributes ``_SAME``
    made_by: dict[str, str]  #: code, libraries, interpreter and processor, by name
    scene: Source  #: where the scene came from
    times: list[float]  #: of this checkpoint, after those from which the run was taken up so far [s]
    every: float = Field(ge=0)  #: seconds of wall time between two checkpoints


def checkpoint_path(path: str | os.PathLike[str]) -> str:
    """Return the file of the checkpoint of the run that writes ``path``."""
    return f"{os.fspath(path)}.checkpoint"


def write_snapshot(path: str, saved: Mapping[str, AnyArray], facts: Facts | None = None) -> None:
    """Write arrays by place and the facts about their run, whole or not at all."""
    text = json.dumps([len(saved), None if facts is None else facts.model_dump(mode="json")])
    arrays: dict[str, Any] = {_FACTS: np.frombuffer(text.encode(), np.uint8), **saved}
    with replacement(path) as growing, open(growing, "xb") as file:
        np.savez(file, **arrays)


def is_foreign(path: str) -> bool:
    """Return whether something is there that is not a checkpoint."""
    try:
        if not os.path.isfile(path):
            return os.path.lexists(path)
        with open(path, "rb") as file:
            head = file.read(30 + len(_FACTS))
        return bool(head) and head[30:] != _FACTS.encode()
    except OSError:
        return True


def read_snapshot(path: str) -> tuple[dict[str, AnyArray], Facts | None]:
    """Read arrays by place, and the facts about their run.

    Raise MpmfwError if there is no such file, another version wrote it, or it is damaged."""
    if is_foreign(path):
        raise MpmfwError(f"'{path}' is not a checkpoint that this version of mpmfw wrote")
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as archive:
            if sum(member.file_size for member in archive.zip.infolist()) > os.path.getsize(path):
                raise ValueError("members are compressed or overlap")
            if (wrong := archive.zip.testzip()) is not None:  # a damaged length may end the reading before it
                raise ValueError(f"{wrong}: the checksum is wrong")
            saved = {place: archive[place] for place in archive.files}
        count, facts = json.loads(saved.pop(_FACTS).tobytes())
        if len(saved) != count or not all(array.dtype.str in TYPES for array in saved.values()):
            raise ValueError("arrays are missing, or of another type")
        return saved, None if facts is None else Facts.model_validate(facts)
    except Exception as error:  # a damaged archive may raise anything
        if isinstance(error, OSError) and error.filename is not None:
            raise MpmfwError(f"cannot read '{path}': {error.strerror}") from error
        raise MpmfwError(f"'{path}' was cut short or is damaged") from error


class Checkpoints:
    """Called after every step: writes a checkpoint ``every`` so many seconds, or when a signal waits.

    ``objects`` are strategy objects instead of the scene's methods. The run was ``resumed`` at these times
    [s] so far."""

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
            self._facts = Facts(
                same={name: str(writer.header.attributes[name]) for name in _SAME},
                made_by=_dependencies(simulation.scene, objects),
                scene=dataclasses.replace(source, directory=folder),
                times=[*resumed, 0.0],
                every=every,
            )

    def __call__(self) -> None:
        """End a step; raise Interrupted if a signal waits."""
        if self.signals.waiting is not None:
            self.write()
            raise Interrupted(self.signals.waiting)
        now = time.monotonic()
        if self.writer.is_due(now):  # the next output may be far away
            self.simulation.clock("output")
            with unbroken():
                self.writer.flush()
        if now >= self._next:
            self.write()

    def write(self) -> None:
        """Replace the last one; where that fails, warn and write no more."""
        if self.path is None or self._next == math.inf:
            return
        self.simulation.clock("output")
        try:
            self.writer.flush()
            # A kill within a sync can leave the results' file unreadable: HDF5 changes its tables in place
            results = np.memmap(str(self.writer.path), np.uint8, "r")
            self._facts.times[-1] = self.simulation.state.time
            write_snapshot(self.path, {**self.simulation.snapshot(), RESULTS: results}, self._facts)
            self._next = time.monotonic() + self._facts.every
        except (MpmfwError, OSError) as error:
            self._next = math.inf
            warnings.warn(f"no checkpoints are written: {error}", ResultsWarning, stacklevel=2)

    def forget(self) -> None:
        """Remove the checkpoint and unfinished files; a foreign file stays."""
        if self.path is not None and not is_foreign(self.path):
            for path in (Path(self.path), *abandoned(self.path), *abandoned(str(self.writer.path))):
                with contextlib.suppress(OSError):
                    path.unlink()


def read_checkpoint(path: str) -> tuple[dict[str, AnyArray], Facts]:
    """Read arrays by place, the copy of the results too, and the facts, from beside a run's file.

    Raise SceneError if the run ended, or if the checkpoint is missing, damaged, or of another run."""
    file, there = checkpoint_path(path), {"kind": "run", "status": "running"}
    if not os.path.isfile(path):
        raise SceneError(f"{path}: there is no such file; expected the results of a run")
    try:
        with netCDF4.Dataset(path) as results:
            there = {name: str(getattr(results, name, "")) for name in ("kind", "status", *_SAME)}
    except (OSError, RuntimeError) as error:  # killed within a sync: the checkpoint has the outputs up to it
        if not is_hdf5(path) or not os.path.isfile(file):
            check_results(path)
            raise OSError(str(error)) from error
    if there["kind"] != "run":
        text = f"{path}: holds not a run but results of kind '{there['kind']}'"
        raise SceneError(f"{text}; give the command that made it again")
    if is_complete(there["status"]):
        raise SceneError(f"{path}: the run is finished; there is nothing to continue")
    if not os.path.isfile(file):
        raise SceneError(
            f"{path}: there is no checkpoint beside it ({os.path.basename(file)}); a run writes one every "
            "ten minutes (--checkpoint) and when it is interrupted; run it again"
        )
    try:
        saved, facts = read_snapshot(file)
    except MpmfwError as error:
        raise SceneError(f"{error}; run it again") from error
    if facts is None or RESULTS not in saved or facts.same.keys() != set(_SAME):
        raise SceneError(f"{file}: is not a checkpoint of a run; run it again")
    if other := [name for name in _SAME if there.get(name, facts.same[name]) != facts.same[name]]:
        raise SceneError(
            f"{path}: cannot continue from its checkpoint: the file has another {' and '.join(other)}"
        )
    return saved, facts


def check_same(
    facts: Facts, header: RunHeader, scene: Scene, objects: Mapping[str, Any], force: bool
) -> None:
    """Refuse other methods, and unless ``force`` other code or processor."""
    for kind, then in facts.same.items():
        if then != (now := str(header.attributes[kind])):
            raise SceneError(
                f"{kind}: the run had {then or 'none'}, found {now or 'none'}; mpmfw.resume takes the "
                "strategy objects that the run was given"
            )
    made_by, current = facts.made_by, _dependencies(scene, objects)
    changed = [
        f"{name} ({made_by.get(name, 'absent')[:8]} then, {current.get(name, 'absent')[:8]} now)"
        for name in sorted({*made_by, *current})
        if made_by.get(name) != current.get(name)
    ]
    if changed and not force:
        raise SceneError(
            f"the run began with other code: {', '.join(changed)}; --force (force=True) continues "
            "anyway, and results may differ"
        )


def _dependencies(scene: Scene, objects: Mapping[str, Any]) -> dict[str, str]:
    code = code_of(scene, objects.get("contact"), objects.get("shape"))
    return {**code, "python": platform.python_version(), "processor": str(get_host_cpu_name())}
