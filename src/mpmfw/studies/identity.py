"""What makes two runs the same: the scene's meaning and the code that reads it."""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import json
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any

from mpmfw.discovery import Kind, available
from mpmfw.scene import Scene
from mpmfw.scene.options import CORE_KEYS

#: Parts of the core that no number of a run depends on.
_APART = {
    *(
        "benchmark",
        "cli",
        "paraview",
        "plots",
        "reference",
        "report",
        "scenes",
        "stability",
        "studies",
        "testing",
    ),
    "validation",
}
_APART_FILES = {
    *(
        "analysis.py",
        "comparison.py",
        "domains.py",
        "joining.py",
        "notebook.py",
        "outputs.py",
        "point_fields.py",
    ),
    "references.py",
}
_LIBRARIES = ("numpy", "numba", "scipy", "shapely")


def key_of(scene: Scene) -> str:
    """A name for the run of a scene: the same for the same tables, mesh files, code and libraries."""
    return _digest(json.dumps(_meaning(scene), sort_keys=True, default=str), code_of(scene))


def code_of(scene: Scene) -> str:
    """Hash of the core, of the plug-ins that the scene names, and of the versions of what they compute with."""
    methods: list[tuple[Kind, str]] = [("shape", scene.shape.method)]
    if scene.contact is not None:
        methods.append(("contact", scene.contact.method))
    methods += [("material", material.model) for material in scene.materials.values()]
    packages = {_home(kind, name) for kind, name in methods}
    return _digest(_core(), *(_package(name) for name in sorted(packages)), *_versions())


@functools.cache
def _home(kind: Kind, name: str) -> str:
    """Top package of a plug-in."""
    return available(kind)[name].module.partition(".")[0]


def _meaning(scene: Scene) -> dict[str, Any]:
    """The scene's tables without those of methods that do not run, so that they make no difference."""
    tables = scene.to_mapping()
    tables.pop("title", None)
    for kind in ("contact", "shape"):
        table = tables.get(kind, {})
        chosen = (*CORE_KEYS[kind], table.get("method"))
        if table:
            tables[kind] = {key: value for key, value in table.items() if key in chosen}
    meshes = {
        name: hashlib.sha256(Path(path).read_bytes()).hexdigest()
        for name, body in scene.bodies.items()
        if (path := getattr(body.geometry, "path", None)) is not None and Path(path).is_file()
    }
    return {"tables": tables, "meshes": meshes}


def _digest(*texts: str) -> str:
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:32]


@functools.cache
def _core() -> str:
    folder = Path(__file__).parents[1]
    return _sources(
        path
        for path in folder.rglob("*.py")
        if path.relative_to(folder).parts[0] not in _APART | _APART_FILES
    )


@functools.cache
def _package(name: str) -> str:
    """Hash of the sources of a plug-in's package, which is not imported."""
    spec = importlib.util.find_spec(name)
    places = [Path(place) for place in (spec.submodule_search_locations or ())] if spec else []
    if not places and spec and spec.origin:
        return _sources(iter([Path(spec.origin)]))
    return _sources(path for place in places for path in place.rglob("*.py"))


def _sources(paths: Iterator[Path]) -> str:
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


@functools.cache
def _versions() -> tuple[str, ...]:
    return tuple(f"{name} {version(name)}" for name in _LIBRARIES)
