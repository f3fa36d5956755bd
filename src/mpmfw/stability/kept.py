"""Points of a map that is not finished, in a file beside it, so that one that was broken off goes on from there."""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import json
import os
from collections.abc import Iterator
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from mpmfw.discovery import available
from mpmfw.results.replacing import replace_bytes
from mpmfw.scene import Scene
from mpmfw.stability.outcome import Outcome

#: What is kept of an outcome: all but arrays.
_FIELDS = tuple(field.name for field in fields(Outcome) if field.name != "travel")


def kept_file(output: str | os.PathLike[str]) -> Path:
    """Where the points of an unfinished map are."""
    path = Path(output)
    return path.with_name(f"{path.name}.points")


class Kept:
    """Outcomes by what was run; kept in memory alone without an output.

    Parameters
    ----------
    output
        File of the map.
    """

    def __init__(self, output: str | os.PathLike[str] | None) -> None:
        self.path = None if output is None else kept_file(output)
        self.points: dict[str, dict[str, Any]] = {}
        if self.path is not None and self.path.is_file():
            self.points = _read(self.path)

    def get(self, key: str) -> Outcome | None:
        """The outcome of a run; None if it is still to be done."""
        found = self.points.get(key)
        return None if found is None else Outcome(**found)

    def put(self, key: str, outcome: Outcome) -> None:
        """Keep the outcome of a run, at once.

        Raises
        ------
        MpmfwError
            The file cannot be written.
        """
        self.points[key] = {name: value for name, value in asdict(outcome).items() if name in _FIELDS}
        if self.path is not None:
            replace_bytes(json.dumps(self.points).encode(), self.path)

    def finish(self) -> None:
        """The map is written: its points are not needed any more."""
        if self.path is not None:
            self.path.unlink(missing_ok=True)


def _read(path: Path) -> dict[str, dict[str, Any]]:
    """Points of an earlier start; none if the file is damaged."""
    try:
        points = json.loads(path.read_bytes())
        return {key: point for key, point in points.items() if set(point) == set(_FIELDS)}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}


def key_of(scene: Scene, steps: int) -> str:
    """A name for a run: the same for the same tables, mesh files, steps and code."""
    meshes = [getattr(body.geometry, "path", None) for body in scene.bodies.values()]
    contents = [hashlib.sha256(Path(mesh).read_bytes()).hexdigest() for mesh in meshes if mesh is not None]
    plugins = [available("shape")[scene.shape.method].module]
    if scene.contact is not None:
        plugins.append(available("contact")[scene.contact.method].module)
    plugins += [available("material")[material.model].module for material in scene.materials.values()]
    code = [_code(package) for package in sorted({"mpmfw", *(name.partition(".")[0] for name in plugins)})]
    tables = json.dumps([scene.to_mapping(), steps, contents, code], sort_keys=True, default=str)
    return hashlib.sha256(tables.encode()).hexdigest()[:32]


@functools.cache
def _code(package: str) -> str:
    """Hash of a package's sources."""
    spec = importlib.util.find_spec(package)
    digest = hashlib.sha256()
    for path in sorted(_sources(spec.submodule_search_locations or [])) if spec is not None else []:
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _sources(folders: Any) -> Iterator[Path]:
    for folder in folders:
        yield from Path(folder).rglob("*.py")
