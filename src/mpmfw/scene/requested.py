"""Checks between the keys that a request sets or varies, and the methods that it runs."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import Kind, choices
from mpmfw.scene.contact_parts import PARTS
from mpmfw.scene.loading import load_scene
from mpmfw.scene.options import CORE_KEYS
from mpmfw.scene.override import parse_path
from mpmfw.scene.problem import Path
from mpmfw.scene.scene import Scene
from mpmfw.scene.specification import parse_specification

#: Tables in which options of each kind of plug-in stand.
_TABLES: dict[Kind, str] = {"contact": "contact", "shape": "shape", "friction": "contact"}


def methods_of(scene: Scene) -> dict[str, list[str]]:
    """Return the contact of a scene, ``none`` of a single body's, and its shape function."""
    contact = scene.contact.method if scene.contact else "none"
    return {"contact": [contact], "shape": [scene.shape.method]}


def check_compared(
    scene: Any, methods: Mapping[str, Sequence[Any]], shared: Mapping[str, Any], varied: Mapping[str, Any]
) -> None:
    """Refuse keys of a comparison that do not exist, choose methods, are set twice, or have no effect.

    ``methods`` are the names or strategy objects that run, by kind.
    """

    def name_of(method: Any) -> str:
        if isinstance(method, str):
            return parse_specification(method).name
        return str(getattr(method, "name", type(method).__name__))

    given = [("--set", key, _path(key, "--set")) for key in shared]
    given += [("--vary", key, _path(key, "--vary")) for key in varied]
    for said, key, path in given:
        if path in [("contact", "method"), ("shape", "method"), *(("contact", part) for part in PARTS)]:
            text = f"the methods of a comparison are chosen by --{path[0]} A,B,…"
            raise SceneError(f"{said} {key}: {text} (Python: {path[0]}=[…])")
    for (said, key, path), (above, other, around) in itertools.permutations(given, 2):
        if above == "--vary" and path[: len(around)] == around:
            raise SceneError(f"{said} {key}: {above} {other} replaces it; leave one of them out")
    names = {kind: [name_of(one) for one in chosen] for kind, chosen in methods.items()}
    names["friction"] = friction_laws(scene, shared, varied)
    check_methods_run(shared, names)
    check_methods_run(varied, names, "--vary")


def check_methods_run(keys: Iterable[str], methods: Mapping[str, Sequence[str]], said: str = "--set") -> None:
    """Refuse options of a method that does not run; ``methods`` are those that run, by kind."""
    for key in keys:
        path = _path(key, said)
        for kind, table in _TABLES.items():
            name = path[1] if path[0] == table and len(path) > 1 else None
            if not isinstance(name, str) or name in CORE_KEYS[table] or name not in choices(kind):
                continue
            running = methods.get(kind, (name,) if kind == "friction" else ())
            if name not in running:
                text = f"{said} {key}: has no effect: {kind} '{name}' does not run here"
                raise SceneError(f"{text}; those that run: {', '.join(running) or 'none'}")


def friction_laws(scene: Any, shared: Mapping[str, Any], varied: Mapping[str, Any]) -> list[str]:
    """Return the friction laws that a comparison runs: the varied ones, or the scene's."""
    if "contact.friction_law" in varied:
        return list(varied["contact.friction_law"])
    try:
        contact = load_scene(scene, set=shared).contact
    except SceneError:
        return list(choices("friction"))  # the runs will say what is wrong
    return [] if contact is None or contact.friction_law is None else [contact.friction_law]


def _path(key: str, said: str) -> Path:
    try:
        return parse_path(key)
    except ValueError as error:
        raise SceneError(f"{said} {key}: {error}") from error
