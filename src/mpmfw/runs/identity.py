"""Identity of a run: the scene's meaning, the code that reads it, and the libraries that it computes with."""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import json
import sys
import uuid
from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from mpmfw.plugin.discovery import KINDS, Kind, available, choices
from mpmfw.scene import Scene
from mpmfw.scene.options import NAMED

#: Parts of the core that the numbers of a run depend on; the values of a scene are in its key themselves.
_COUNTED = (
    "codes", "contact", "effects", "geometry", "kernels", "plugin", "runs", "state", "step",
    "scene/bodies.py", "scene/scene.py", "scene/tables.py",
)  # fmt: skip
_LIBRARIES = ("numpy", "numba", "scipy", "shapely")


def key_of(scene: Scene, contact: Any = None, shape: Any = None, what: str = "") -> str:
    """Return a key of a scene's run, equal for the same meaning, code and libraries.

    A strategy object that another process cannot identify gives a new key each time. ``what`` is what is done
    with the scene, other than to run it."""
    objects = {
        kind: _of_object(one) for kind, one in (("contact", contact), ("shape", shape)) if one is not None
    }
    meaning = json.dumps(meaning_of(scene, objects), sort_keys=True, default=str)
    return digest(what, meaning, *(f"{k} {v}" for k, v in sorted(code_of(scene, contact, shape).items())))


def code_of(scene: Scene, contact: Any = None, shape: Any = None) -> dict[str, str]:
    """Return hashes and versions of what computes the run, by name."""
    methods = [(kind, each.model) for group, kind in NAMED.items() for each in getattr(scene, group).values()]
    if shape is None:
        methods.append(("shape", scene.shape.method))
    if scene.contact is not None and contact is None:
        methods.append(("contact", scene.contact.method))
    if scene.contact is not None:
        methods += [("contact", pair.method) for pair in scene.contact.pairs if pair.method]
    if scene.contact is not None and scene.contact.friction_law is not None:
        methods.append(("friction", scene.contact.friction_law))
    packages = {_home(kind, name) for kind, name in methods}
    others = [contact, shape, *(body.geometry for body in scene.bodies.values())]
    packages |= {type(one).__module__.partition(".")[0] for one in others if one is not None}
    return {name: current(name) for name in sorted({"mpmfw", *packages, *_LIBRARIES})}


def code_of_plugins() -> dict[str, str]:
    """Return :func:`code_of` for all installed plug-ins."""
    packages = {_home(kind, name) for kind in KINDS for name in available(kind)}
    return {name: current(name) for name in sorted({"mpmfw", *packages, *_LIBRARIES})}


def current(name: str) -> str:
    """Return the hash of a package's sources as they are, or a library's version."""
    if name in _LIBRARIES:
        return version(name)
    return _core() if name == "mpmfw" else package(name)


def is_current(code: Mapping[str, str]) -> bool:
    """Return True if an outcome's code is the present one."""
    try:
        return bool(code) and all(current(name) == known for name, known in code.items())
    except (PackageNotFoundError, ValueError, ImportError):
        return False


@functools.cache
def _home(kind: Kind, name: str) -> str:
    return choices(kind)[name].module.partition(".")[0]


def meaning_of(scene: Scene, objects: Mapping[str, Any]) -> dict[str, Any]:
    """Return the scene's tables and hashes of its meshes; of plug-ins the options of those that run."""
    tables = scene.model_dump(exclude={"title", "reference", "threads"})
    for kind, chosen in (("contact", scene.contact), ("shape", scene.shape)):
        if tables.get(kind) is not None and chosen is not None:
            options = None if chosen.options is None else chosen.options.model_dump()
            own = {"method": "an object"} if kind in objects else {"options": options}
            tables[kind] = {**tables[kind], **own}
    if scene.contact is not None and scene.contact.friction_options is not None:
        tables["contact"]["friction_options"] = scene.contact.friction_options.model_dump()
    for index, pair in enumerate(() if scene.contact is None else scene.contact.pairs):
        if pair.options is not None:
            tables["contact"]["pairs"][index]["options"] = pair.options.model_dump()
    for group in NAMED:
        for name, table in getattr(scene, group).items():
            if table.options is not None:
                tables[group][name] |= {"options": table.options.model_dump()}
    meshes = {
        name: hashlib.sha256(Path(path).read_bytes()).hexdigest()
        for name, body in scene.bodies.items()
        if (path := getattr(body.geometry, "path", None)) is not None and Path(path).is_file()
    }
    for name in meshes:
        tables["bodies"][name]["geometry"].pop("path", None)
    return {"tables": _rounded(tables), "meshes": meshes, **objects}


def _rounded(value: Any) -> Any:
    """Numbers to 15 digits, which every way of writing a quantity agrees on."""
    if isinstance(value, float):
        return float(f"{value:.15g}")
    if isinstance(value, Mapping):
        return {str(key): _rounded(one) for key, one in value.items()}
    return [_rounded(one) for one in value] if isinstance(value, list | tuple) else value


def _of_object(plugin: Any, known: frozenset[int] = frozenset()) -> list[str]:
    """Return class, options and state of an object and of its parts; ``known`` are its holders."""
    kind, state = type(plugin), dict(vars(plugin)) if hasattr(plugin, "__dict__") else {}
    options = state.pop("options", None)
    given = options.model_dump() if hasattr(options, "model_dump") else repr(options)
    message = [
        f"{kind.__module__}.{kind.__qualname__}",
        json.dumps(_rounded(given), sort_keys=True, default=str),
    ]
    for name, value in sorted(state.items()):
        for part in value if isinstance(value, list | tuple) else [value]:
            message.append(f"{name}=")
            if id(part) in known:
                continue
            held = " at 0x" in repr(part) and hasattr(part, "__dict__") and not isinstance(part, type)
            message += _of_object(part, known | {id(plugin)}) if held else [repr(part)]
    lasting = package(kind.__module__.partition(".")[0]) and not any(" at 0x" in text for text in message)
    return message if lasting else [*message, uuid.uuid4().hex]


def digest(*texts: str) -> str:
    """Hash of texts."""
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:32]


@functools.cache
def _core() -> str:
    return sources(counted(Path(__file__).parent.parent))


def counted(folder: Path) -> list[Path]:
    """Return the files of mpmfw in a folder that numbers of a run depend on."""
    parts = (folder / part for part in _COUNTED)
    return [path for part in parts for path in (part.rglob("*.py") if part.is_dir() else [part])]


@functools.cache
def package(name: str) -> str:
    """Hash of a package's sources and tables; empty where there are none."""
    if name == "__main__":
        file = getattr(sys.modules["__main__"], "__file__", None)
        return sources([Path(file)]) if file is not None and Path(file).is_file() else ""
    spec = importlib.util.find_spec(name)
    places = [Path(place) for place in (spec.submodule_search_locations or ())] if spec else []
    if not places and spec and spec.origin:
        return sources([Path(spec.origin)])
    found = (path for place in places for path in place.rglob("*"))
    return sources(path for path in found if path.suffix in (".py", ".toml", ".csv"))


def sources(paths: Iterable[Path] | Iterator[Path]) -> str:
    """Hash of files, by name and content; empty of none."""
    found, total = sorted(paths), hashlib.sha256()
    for path in found:
        total.update(path.name.encode())
        total.update(path.read_bytes())
    return total.hexdigest() if found else ""
