"""Finished runs in a folder, one pair of files each, from which an interrupted campaign continues."""

from __future__ import annotations

import json
import os
import re
import shutil
import tempfile
import time
import weakref
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import xarray as xr
from pydantic import TypeAdapter

from mpmfw.errors import MpmfwError, SceneError
from mpmfw.results.reading import read_run
from mpmfw.results.replacing import replace_bytes
from mpmfw.state.fields import COSTS as RUN_COSTS

#: Root attributes of a run that are its costs: name, unit, meaning.
COSTS: tuple[tuple[str, str, str], ...] = (*RUN_COSTS, ("settle_steps", "1", "time steps of settling"))


@dataclass(frozen=True)
class Cost:
    """The cost of one repeat of a run."""

    timing: str  #: ``exclusive`` if nothing else of the campaign ran meanwhile, else ``shared cores``
    values: dict[str, float]  #: root attributes of the run, by the names of :data:`COSTS`
    stages: dict[str, float]  #: CPU time of the steps by stage [s]
    settling: dict[str, float]  #: CPU time of settling by stage [s]; 0 where the scene does not settle
    #: mean number of cores that other processes kept busy; NaN where it is not known
    others: float = field(default=float("nan"), compare=False)
    machine: str = ""  #: model of the processor


@dataclass(frozen=True)
class Outcome:
    """The outcome of a run."""

    key: str  #: of :func:`mpmfw.runs.identity.key_of`
    status: str  #: ``ok``, ``suspect: …``, or why there is no complete result
    name: str = ""  #: what ran, in words
    scene: str = ""  #: the scene's text, for a reader of the store
    digest: str = ""  #: of the series, which every repeat must give again; empty without results
    notes: tuple[str, ...] = ()  #: remarks on the run
    costs: tuple[Cost, ...] = ()  #: one for each repeat
    values: Mapping[str, Any] = field(default_factory=dict)  #: read off the run, where it has no results
    code: Mapping[str, str] = field(default_factory=dict)  #: hashes of packages, versions of libraries
    #: whether running it again would end in the same way
    lasting: bool = field(default=True, compare=False)


@dataclass(frozen=True)
class Finished:
    """The outcome of a task, and the file that it wrote, if any."""

    outcome: Outcome
    results: bytes | None = None


_OUTCOME = TypeAdapter(Outcome)

#: Seconds after which a file that is still being written is taken to be left by a process that was killed.
_ABANDONED = 3600.0


class Store:
    """A folder of finished runs: ``<key>.nc`` with the results, then ``<key>.json``, which completes them.

    Files are whole, so that campaigns may share a folder. Without one outcomes live as long as this object.
    """

    def __init__(self, folder: str | os.PathLike[str] | None = None) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="mpmfw-store-") if folder is None else folder)
        #: Whether outcomes stay when the process ends.
        self.lasts = folder is not None
        if not self.lasts:
            weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
        self._known: dict[str, Outcome | None] = {}

    def outcome(self, key: str) -> Outcome | None:
        """Return the outcome of a run, or None."""
        if key not in self._known:
            self._known[key] = self._read(key)
        return self._known[key]

    def results(self, key: str) -> xr.DataTree | None:
        """Return the results of a run, or None."""
        path = self._path(key, "nc")
        return read_run(path) if path.is_file() else None

    def put(self, outcome: Outcome, results: bytes | None = None) -> None:
        """Store an outcome and its file; an outcome that is not ``lasting`` stays in memory."""
        self._known[outcome.key] = outcome
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise MpmfwError(f"cannot write '{self.folder}': {error.strerror or error}") from error
        if results is not None:
            replace_bytes(results, self._path(outcome.key, "nc"))
        if outcome.lasting:
            fields = asdict(outcome)
            fields.pop("lasting")
            replace_bytes(json.dumps(fields, indent=1).encode(), self._path(outcome.key, "json"))

    def forget(self, key: str) -> None:
        """Drop the outcome of a run, so that it is run again."""
        self._known.pop(key, None)
        for ending in ("json", "nc"):
            self._path(key, ending).unlink(missing_ok=True)

    def prune(self, takes: Callable[[Mapping[str, str]], bool]) -> tuple[int, int, int]:
        """Remove runs whose code ``takes`` rejects, and files that killed processes left.

        Return the numbers of removed and kept runs, and the bytes freed. A SceneError refuses folders without
        finished runs.
        """
        try:
            own, long_ago = own_files(self.folder), time.time() - _ABANDONED
            if not own and any(self.folder.iterdir()):
                raise SceneError(f"{self.folder}: holds no finished runs; expected one such as FILE.nc.runs")
            known = {key for path, key in own.items() if path.suffix == ".json"} - {""}
            found = {key: self._read(key) for key in known}
            keep = {key for key, one in found.items() if one is not None and takes(one.code)}
            past = {
                path: path.stat().st_size
                for path, key in own.items()
                if (key not in keep if key in known else path.stat().st_mtime < long_ago)
            }
            for path in past:
                path.unlink(missing_ok=True)
        except OSError as error:
            name = error.filename or self.folder
            raise MpmfwError(f"cannot prune '{name}': {error.strerror or error}") from error
        self._known.clear()
        return len(known - keep), len(keep), sum(past.values())

    def _path(self, key: str, ending: str) -> Path:
        return self.folder / f"{key}.{ending}"

    def _read(self, key: str) -> Outcome | None:
        try:
            found = _OUTCOME.validate_json(self._path(key, "json").read_bytes())
            complete = found.key == key and (not found.digest or self.results(key) is not None)
        except (OSError, ValueError, MpmfwError):
            return None
        return found if complete else None


def store_of(output: str | os.PathLike[str] | None) -> Path | None:
    """The folder of finished runs beside an output; none without."""
    return None if output is None else Path(f"{os.fspath(output)}.runs")


#: Names of a store's files, whole or half written.
_NAME = re.compile(r"(?:([0-9a-f]{32})|\.[0-9a-f]{32}\.[0-9a-f]{32}\.part)\.(?:json|nc)")


def own_files(folder: Path) -> dict[Path, str]:
    """Return the files of a store, each with its key, "" for a half-written one; links are left out."""
    named = ((path, _NAME.fullmatch(path.name)) for path in sorted(folder.iterdir()))
    return {path: name[1] or "" for path, name in named if name and path.is_file() and not path.is_symlink()}
