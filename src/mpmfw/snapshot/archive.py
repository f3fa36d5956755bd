"""A snapshot, and its file."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np

from mpmfw.errors import MpmfwError
from mpmfw.fields import AnyArray
from mpmfw.results.replacing import replacement

#: Name in the archive of the file that lay beside.
_BESIDE = "beside"


class NotSaved(MpmfwError):
    """An object holds something that cannot be saved, or what was saved does not fit the object."""


@dataclass
class Snapshot:
    """Values by place.

    Parameters
    ----------
    roots
        What the outermost objects were, by name.
    nodes
        Everything that has an identity, each once; others refer to it by its number.
    arrays
        Those of the nodes.
    """

    roots: dict[str, Any]
    nodes: list[Any]
    arrays: list[AnyArray]

    def write(self, file: BinaryIO, facts: Mapping[str, Any], beside: str | None = None) -> None:
        """Write it, with ``facts`` for whoever reads it and a copy of the file ``beside``, as a zip archive."""
        with zipfile.ZipFile(file, "w") as archive:
            if beside is not None:
                archive.write(beside, _BESIDE)
            for k, array in enumerate(self.arrays):
                with archive.open(f"{k}.npy", "w", force_zip64=True) as member:
                    np.lib.format.write_array(member, array, allow_pickle=False)
            archive.writestr("values.json", json.dumps([self.roots, self.nodes]))
            archive.writestr("facts.json", json.dumps(facts))

    @classmethod
    def read(cls, file: BinaryIO) -> tuple[Snapshot, dict[str, Any]]:
        """Read it, and the facts."""
        with zipfile.ZipFile(file) as archive:
            roots, nodes = json.loads(archive.read("values.json"))
            count = sum(name.endswith(".npy") for name in archive.namelist())
            arrays = []
            for k in range(count):
                with archive.open(f"{k}.npy") as member:
                    arrays.append(np.lib.format.read_array(member, allow_pickle=False))
            facts = json.loads(archive.read("facts.json"))
            if not isinstance(facts, dict):
                raise ValueError("facts.json: expected a table")
            return cls(roots, nodes, arrays), facts


def write_snapshot(
    path: str | os.PathLike[str], snapshot: Snapshot, facts: Mapping[str, Any], beside: str | None = None
) -> None:
    """Write a snapshot to a file in one step: who reads it sees the one before or this one, whole.

    Parameters
    ----------
    path
        Of the file.
    snapshot, facts
        What is saved, and what is said of it.
    beside
        Another file, of which a copy is kept with it; :func:`extract_beside` gives it back.

    Raises
    ------
    MpmfwError
        It cannot be written.
    """
    with replacement(path) as growing, open(growing, "xb") as file:
        snapshot.write(file, facts, beside)


def read_snapshot(path: str | os.PathLike[str]) -> tuple[Snapshot, dict[str, Any]]:
    """The snapshot of a file and the facts about it.

    Raises
    ------
    MpmfwError
        There is no such file, or it is damaged.
    """
    with _readable(path), open(path, "rb") as file:
        return Snapshot.read(file)


def extract_beside(path: str | os.PathLike[str], target: str) -> None:
    """Write the file that a snapshot was written with to ``target``.

    Raises
    ------
    MpmfwError
        There is no such snapshot, it is damaged, or there is no room.
    """
    with (
        _readable(path),
        zipfile.ZipFile(path) as archive,
        archive.open(_BESIDE) as member,
        open(target, "wb") as file,
    ):
        shutil.copyfileobj(member, file, 1 << 20)


@contextlib.contextmanager
def _readable(path: str | os.PathLike[str]) -> Iterator[None]:
    """Say what keeps a file from being read."""
    try:
        yield
    except OSError as error:
        raise MpmfwError(f"cannot read '{os.fspath(path)}': {error.strerror or error}") from error
    except (zipfile.BadZipFile, KeyError, ValueError, EOFError) as error:
        raise MpmfwError(f"'{os.fspath(path)}' was cut short or is damaged") from error
