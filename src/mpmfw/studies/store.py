"""Finished runs in a folder, one pair of files each, so that a study goes on where it stopped."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import xarray as xr

from mpmfw.errors import MpmfwError
from mpmfw.joining import COSTS as RUN_COSTS
from mpmfw.results.reading import read as open_results
from mpmfw.results.replacing import replace_bytes

#: Root attributes of a run that are its costs: name, unit, meaning.
COSTS: tuple[tuple[str, str, str], ...] = (*RUN_COSTS, ("settle_steps", "1", "time steps of settling"))


@dataclass(frozen=True)
class Cost:
    """What one repeat of a run took.

    Attributes
    ----------
    timing
        ``exclusive`` if nothing else of the study ran at the same time, else ``shared cores``.
    values
        Root attributes of the run, by the names of :data:`COSTS`.
    stages
        CPU time of the steps by stage [s].
    settling
        CPU time of settling by stage [s]; 0 where the scene does not settle.
    """

    timing: str
    values: dict[str, float]
    stages: dict[str, float]
    settling: dict[str, float]


@dataclass(frozen=True)
class Record:
    """How a run went.

    Attributes
    ----------
    key
        Of :func:`mpmfw.studies.identity.key_of`.
    status
        ``ok``, or why there is no complete result.
    name, scene
        What ran, for a reader of the folder: in words, and the scene's text.
    digest
        Of the series, which every repeat must give again; empty without results.
    notes
        What the run's reader must know.
    costs
        One for each repeat.
    lasting
        Whether running it again would end in the same way.
    """

    key: str
    status: str
    name: str = ""
    scene: str = ""
    digest: str = ""
    notes: tuple[str, ...] = ()
    costs: tuple[Cost, ...] = ()
    lasting: bool = field(default=True, compare=False)


class Store:
    """A folder of finished runs: ``<key>.nc`` with the results, then ``<key>.json`` with the rest.

    The second file says that the run is complete. Both get their names only when they are whole, so that several
    studies may share a folder and a kill at any moment leaves none half written.

    Parameters
    ----------
    folder
        Made at the first run that is stored.

    Raises
    ------
    MpmfwError
        A file cannot be written.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        self._known: dict[str, Record | None] = {}

    def record(self, key: str) -> Record | None:
        """The record of a run; None if it is not there, or not readable, and has to be run."""
        if key not in self._known:
            self._known[key] = self._read(key)
        return self._known[key]

    def results(self, key: str) -> xr.DataTree | None:
        """What a run wrote; None if it wrote nothing."""
        path = self._path(key, "nc")
        return open_results(path) if path.is_file() else None

    def put(self, record: Record, results: bytes | None = None) -> None:
        """Keep a record, and the file that the run wrote if it is new; what would not last is kept in memory."""
        self._known[record.key] = record
        if results is not None:
            self._write(self._path(record.key, "nc"), results)
        if record.lasting:
            fields = asdict(record)
            fields.pop("lasting")
            self._write(self._path(record.key, "json"), json.dumps(fields, indent=1).encode())

    def _path(self, key: str, ending: str) -> Path:
        return self.folder / f"{key}.{ending}"

    def _read(self, key: str) -> Record | None:
        try:
            fields: dict[str, Any] = json.loads(self._path(key, "json").read_bytes())
            costs = tuple(Cost(**cost) for cost in fields.pop("costs"))
            record = Record(**{**fields, "notes": tuple(fields["notes"])}, costs=costs)
            complete = not record.digest or self.results(key) is not None
        except (OSError, ValueError, TypeError, KeyError, MpmfwError):
            return None
        return record if complete else None

    def _write(self, path: Path, content: bytes) -> None:
        try:
            self.folder.mkdir(exist_ok=True)
        except OSError as error:
            raise MpmfwError(f"cannot write '{path}': {error.strerror or error}") from error
        replace_bytes(content, path)
