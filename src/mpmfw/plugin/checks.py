"""Checks of plug-ins, and errors that name them: plug-in, distribution, place and step."""

from __future__ import annotations

import functools
import traceback
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, get_args

import numpy as np

from mpmfw.errors import MpmfwError, PluginError, SceneError
from mpmfw.plugin.discovery import KINDS, available, distribution_of
from mpmfw.state.fields import PARTICLE_FIELDS, SURFACE_FIELDS, Field, FloatArray, Group

if TYPE_CHECKING:
    from mpmfw.state.structs import State

#: Errors that need no name of a plug-in.
PASSED_ON = (MpmfwError, KeyboardInterrupt, GeneratorExit)


@contextmanager
def naming(plugin: Any, place: str, state: State | None = None) -> Iterator[None]:
    """Turn any exception of a plug-in, except mpmfw's, into that of :func:`failure`."""
    try:
        yield
    except BaseException as error:  # SystemExit among them: a plug-in may not end the program
        raise_named(error, plugin, place, state)


def raise_named(error: BaseException, plugin: Any, place: str, state: State | None = None) -> NoReturn:
    """Raise mpmfw's errors and interruptions again, of others that of :func:`failure`."""
    if isinstance(error, PASSED_ON):
        raise error
    raise failure(error, plugin, place, state) from error


def failure(error: BaseException, plugin: Any, place: str, state: State | None) -> MpmfwError:
    """Return an error that names plug-in, place, step and time."""
    text = f"{described(plugin)} failed in {place}: {cause(error)}"
    if state is None:
        return SceneError(text)
    return PluginError(text, step=state.steps, time=state.time)


def cause(error: BaseException) -> str:
    """Return an error as ``KeyError: 'x' (spring_law.py, line 12)``."""
    text = str(error)
    where = traceback.extract_tb(error.__traceback__)
    at = f" ({Path(where[-1].filename).name}, line {where[-1].lineno})" if where else ""
    return f"{type(error).__name__}{f': {text}' if text else ''}{at}"


def described(plugin: Any) -> str:
    """``plug-in 'penalty' of distribution mpmfw``, of an object or a class."""
    kind = plugin if isinstance(plugin, type) else type(plugin)
    return f"plug-in '{getattr(plugin, 'name', kind.__qualname__)}' of {distribution_text(kind)}"


def distribution_text(kind: type[Any]) -> str:
    """Return ``distribution spring_law``, or the file of a class that belongs to none."""
    package = kind.__module__.partition(".")[0]
    found = sorted(_announcing(package)) or packages_distributions().get(package, [])
    return f"distribution {found[0]}" if found else f"no distribution (module {kind.__module__})"


def bundled(kind: type[Any]) -> bool:
    """Return True if the class belongs to mpmfw."""
    return _is_bundled(kind.__module__.partition(".")[0])


@functools.cache
def _is_bundled(package: str) -> bool:
    return package == "mpmfw" or "mpmfw" in _announcing(package)


def _announcing(package: str) -> set[str]:
    """Return the distributions that announce plug-ins of a package."""
    entries = [entry for kind in KINDS for entry in available(kind).values()]
    return {distribution_of(entry) for entry in entries if entry.module.partition(".")[0] == package}


def declared_fields(answers: Iterable[tuple[Any, Iterable[Field]]]) -> tuple[Field, ...]:
    """Return all declarations of plug-ins with their answers; instances of one class may share theirs.

    Raise SceneError if a field cannot be stored, or if its name belongs to the core or another plug-in."""
    core = {(field.group, field.name) for field in (*PARTICLE_FIELDS, *SURFACE_FIELDS)}
    owners: dict[str, tuple[Any, Field]] = {}
    for plugin, answer in answers:
        with naming(plugin, "declare_fields"):
            for field in answer:
                if field.group not in get_args(Group) or np.dtype(field.dtype).kind not in "fiub":
                    raise ValueError(
                        f"field '{field.name}' of group '{field.group}' and type {field.dtype!r}; expected "
                        f"one of {', '.join(get_args(Group))}, and a type of numbers"
                    )
        for field in answer:
            first, known = owners.setdefault(field.name, (plugin, field))
            shared = first is plugin or (type(first) is type(plugin) and known == field)
            if not shared or known != field or (field.group, field.name) in core:
                owner = "the core" if shared and known == field else described(first)
                both = f"{described(plugin)} and {owner} both declare a field '{field.name}'"
                raise SceneError(f"{both}; expected another name")
    return tuple([field for _, field in owners.values()])


def of_points(method: str, material: Any, state: State, own: slice) -> FloatArray:
    """Return a material's numbers or stresses (3, 3) of the points ``own``."""
    shape = (own.stop - own.start, *((3, 3) if method == "stress_of_points" else ()))
    with naming(material, method, state):
        values = np.asarray(getattr(material, method)(state.particles.in_space, own))
        if values.shape != shape:
            raise ValueError(f"values of shape {values.shape}; expected {shape}")
    return values
