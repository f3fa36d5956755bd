"""Plug-ins by name, or by ``module:Class``; nothing is imported but the plug-ins that a scene names."""

from __future__ import annotations

import difflib
import functools
import inspect
import os
import re
import sys
from collections.abc import Callable, Iterable, Sequence
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Literal, TypeAlias, get_args

from mpmfw.errors import SceneError

Kind: TypeAlias = Literal[
    "contact", "detection", "law", "friction", "shape", "material", "load", "boundary", "output", "geometry",
    "measure", "reference", "code",
]  # fmt: skip
KINDS: tuple[Kind, ...] = get_args(Kind)

#: Version of the plug-in interface; it moves when a plug-in written for it no longer works.
INTERFACE = 1


def nearest(name: str, valid: Iterable[str]) -> str | None:
    """Return the valid name that is closest to ``name``, or None if none is close."""
    by_lower = {candidate.lower(): candidate for candidate in valid}
    found = difflib.get_close_matches(name.lower(), by_lower, n=1, cutoff=0.6)
    return by_lower[found[0]] if found else None


def did_you_mean(name: str, valid: Iterable[str]) -> str:
    """Return the nearest name if one is close, and all valid names."""
    names = sorted(valid)
    names = [one for one in names if "+" in one and "+" in name] or names
    close = nearest(name, names)
    listed = one_of(names) if names else "none is installed"
    return f"did you mean '{close}'? ({listed})" if close else listed


def one_of(names: Sequence[str]) -> str:
    """Return ``one of a, b``, and for joined names how they are made."""
    whole = [name for name in names if "+" not in name]
    if names and not whole:
        parts = (sorted(set(part)) for part in zip(*(name.split("+") for name in names), strict=True))
        return "DETECTION+LAW, one of " + ", and one of ".join(map(", ".join, parts))
    joined = ", or DETECTION+LAW" if len(whole) < len(names) else ""
    return f"one of {', '.join(whole)}{joined}"


@functools.cache
def distribution_of(entry: EntryPoint) -> str:
    """Return the distribution that announces the plug-in."""
    return "unknown distribution" if entry.dist is None else entry.dist.name


_PLACE = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_][\w.]*")
#: A detection and a law, one of which is a place, or both.
_JOINED = re.compile(rf"{_PLACE.pattern}|[\w.:]+\+{_PLACE.pattern}|{_PLACE.pattern}\+[\w.]+")


def names_code(text: str) -> bool:
    """Return True if a plug-in's name contains ``module:Class``."""
    return any(_PLACE.fullmatch(part.strip()) for part in text.partition("(")[0].split("+"))


class Available(dict[str, EntryPoint]):
    """Installed plug-ins by name, and any ``module:Class``, which is not listed."""

    place = _PLACE

    def __contains__(self, name: object) -> bool:
        return dict.__contains__(self, name) or (isinstance(name, str) and bool(self.place.fullmatch(name)))

    def __missing__(self, name: str) -> EntryPoint:
        if name not in self:
            raise KeyError(name)
        return EntryPoint(name, next(part for part in name.split("+") if ":" in part), "mpmfw")

    def get(self, name: str, default: Any = None) -> Any:
        """Return the plug-in, or the default if there is none."""
        return self[name] if name in self else default  # noqa: SIM401


def available(kind: Kind) -> Available:
    """Return the installed plug-ins of a kind by name, sorted."""
    announced = _announced(kind, entry_points, tuple(sys.path))
    return Available({name: entries[0] for name, entries in announced.items()})


#: Kinds of references that mpmfw brings along.
REFERENCES = ("rolling-cylinder", "rolling-sphere", "sliding-block", "pressed-blocks", "colliding-rings")


def only_bundled(kind: Kind, name: str) -> bool:
    """Return True if mpmfw alone brings a plug-in of this name."""
    entries = _announced(kind, entry_points, tuple(sys.path)).get(name, [])
    return [distribution_of(entry) for entry in entries] == ["mpmfw"]


def choices(kind: Kind) -> Available:
    """Return the plug-ins of a kind, and contacts ``DETECTION+LAW``."""
    found = available(kind)
    if kind == "contact":
        found.place, laws = _JOINED, available("law").items()
        found.update({f"{each}+{name}": law for each in available("detection") for name, law in laws})
    return found


@functools.lru_cache(maxsize=16)
def _announced(
    kind: Kind,
    look_up: Callable[..., Iterable[EntryPoint]],
    folders: tuple[str, ...],  # noqa: ARG001
) -> dict[str, list[EntryPoint]]:
    """Read what is installed, once for each search path."""
    found: dict[str, list[EntryPoint]] = {}
    for entry in sorted(look_up(group=f"mpmfw.{kind}"), key=lambda entry: entry.name):
        # The same distribution may be seen twice on the search path (an installation and its source tree)
        known = {(other.value, distribution_of(other)) for other in found.get(entry.name, ())}
        if (entry.value, distribution_of(entry)) not in known:
            found.setdefault(entry.name, []).append(entry)
    return found


def load(kind: Kind, name: str) -> type[Any]:
    """Import the plug-in ``name`` and no other; of a joined contact, its detection and its law.

    Raise SceneError if it is unknown, announced twice, not importable or refused."""
    entries = choices(kind)
    if name not in entries:
        raise SceneError(f"unknown {kind} plug-in '{name}'; {did_you_mean(name, entries)}")
    if kind == "contact" and "+" in name:
        detection, _, law = name.partition("+")
        try:
            return load("law", law).joined_with(load("detection", detection))  # type: ignore[no-any-return]
        except SceneError as error:
            raise SceneError(f"contact '{name}': {error}") from error
    entry, *others = _announced(kind, entry_points, tuple(sys.path)).get(name, [entries[name]])
    if others:
        announced = " and ".join(f"{distribution_of(each)} ({each.value})" for each in (entry, *others))
        raise SceneError(
            f"two distributions announce a {kind} plug-in '{name}': {announced}; uninstall one of them"
        )
    by_place = ":" in name
    text = f"{kind} plug-in '{name}'" + ("" if by_place else f" of distribution {distribution_of(entry)}")
    try:
        if by_place and (folder := os.getcwd()) not in sys.path:
            sys.path.append(folder)  # plug-ins that are not installed lie where their author works
        plugin = entry.load()
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a stranger's module may raise anything, SystemExit included
        raise SceneError(
            f"{text} cannot be imported from {entry.value}: {type(error).__name__}: {error}"
        ) from error
    if not isinstance(plugin, type):
        raise SceneError(f"{text}: {entry.value} is not a class")
    try:
        refuse_class(plugin)
    except SceneError as error:
        raise SceneError(f"{text}: {error}") from error
    own: str = plugin.name  # type: ignore[attr-defined]
    if not by_place and own != name:
        raise SceneError(
            f"{text}: {entry.value} has the name '{own}'; expected the same as the entry point's"
        )
    return plugin


def refuse_class(plugin: type[Any]) -> None:
    """Refuse a class without a name, of another interface, or with other arguments."""
    refuse_nameless(plugin)
    if (version := getattr(plugin, "interface", 1)) != INTERFACE:
        raise SceneError(
            f"{full_name(plugin)} is written for version {version} of the plug-in interface; expected "
            f"{INTERFACE}, that of this mpmfw"
        )
    options = options_of(plugin)
    try:
        inspect.signature(plugin).bind(**options)
    except TypeError as error:
        raise SceneError(
            f"{full_name(plugin)}(…) must be made from its options alone, given as keywords "
            f"({', '.join(options) or 'it has none'}): {error}"
        ) from error


def refuse_nameless(plugin: type[Any]) -> None:
    """Refuse a class whose ``name`` is missing, empty or not a string."""
    name = getattr(plugin, "name", None)
    if not isinstance(name, str) or not name:
        raise SceneError(
            f"{full_name(plugin)}: expected a class attribute 'name', which is what scenes call it; found "
            f"{name!r}"
        )


def options_of(plugin: Any) -> dict[str, Any]:
    """Return the fields of a plug-in's options, by name."""
    return dict(getattr(getattr(plugin, "Options", plugin), "model_fields", {}))


def object_of(given: Any) -> Any:
    """Return an object of a class, made without options; anything else as it is."""
    if not isinstance(given, type):
        return given
    refuse_class(given)
    return given()


def full_name(plugin: type[Any]) -> str:
    """Module and name of a class, for messages."""
    return f"{plugin.__module__}.{plugin.__qualname__}"
