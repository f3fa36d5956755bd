"""Declared history: the values that a run keeps from step to step, as arrays by place, ``PART/NAME``.

A class names them, ``history = ("work", "gained")``, beside those of its bases: numbers, arrays, dictionaries
of either, and parts with a history. None is a number that is not known yet. All else is built anew from the
scene. Saved values have the type and shape of those that were built. A part's method ``restored`` is called
when all values are there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from mpmfw.errors import MpmfwError
from mpmfw.state.fields import AnyArray

#: Types of numbers that may be saved.
TYPES = ("<f8", "<f4", "<i8", "<i4", "|i1", "|u1", "|b1")


class NotSaved(MpmfwError):
    """What cannot be saved, or does not fit what was built."""


def history_of(part: Any) -> tuple[str, ...] | None:
    """Return the names that an object's classes declare; None without any."""
    declared = [vars(kind)["history"] for kind in reversed(type(part).__mro__) if "history" in vars(kind)]
    return tuple(dict.fromkeys(name for names in declared for name in names)) if declared else None


def take(parts: Mapping[str, Any]) -> dict[str, AnyArray]:
    """Copy the values of parts, by place. A number is an array without dimensions, None an empty one.

    Raise NotSaved if a history names something that does not exist or cannot be saved."""
    saved = {}
    for holder, name, place in _places(parts, []):
        value = getattr(holder, name)
        values = value if isinstance(value, dict) else {None: value}
        for key, one in values.items():
            plain = isinstance(one, int | float | np.generic | np.ndarray)
            array = np.zeros(0) if one is None else np.array(one if plain else None)
            if array.dtype.str not in TYPES or not isinstance(key, str | None):
                raise NotSaved(
                    f"{place} is a {type(value).__name__} that holds {one!r:.60}; expected numbers, arrays "
                    f"of {', '.join(TYPES)}, dictionaries of these, or an object whose class has a history"
                )
            saved[place if key is None else f"{place}/{key}"] = array
    return saved


def put(saved: Mapping[str, AnyArray], parts: Mapping[str, Any]) -> None:
    """Give values to parts that were built alike, in place where possible."""
    left, visited = dict(saved), list[Any]()
    for holder, name, place in _places(parts, visited):
        old = getattr(holder, name)
        new: Any
        if isinstance(old, dict):
            keys = dict.fromkeys(old)
            if not any(isinstance(one, np.ndarray) for one in old.values()):  # numbers may join later
                keys |= dict.fromkeys(key[len(place) + 1 :] for key in left if key.startswith(f"{place}/"))
            new = {k: _fitting(f"{place}/{k}", left.pop(f"{place}/{k}", None), old.get(k)) for k in keys}
        else:
            new = _fitting(place, left.pop(place, None), old)
        _assign(holder, name, old, new)
    if left:
        raise NotSaved(f"{next(iter(left))} has no place in what was built")
    for part in visited:
        if hasattr(part, "restored"):
            part.restored()


def check_indices(count: int, **arrays: AnyArray) -> None:
    """Raise NotSaved for arrays with numbers that are neither −1 nor indices of ``count`` things.

    Kernels would read beyond the end."""
    for name, array in arrays.items():
        if array.size and not (array.min() >= -1 and array.max() < count):
            raise NotSaved(f"{name} has an index that is not from -1 to {count - 1}")


def _places(parts: Mapping[str, Any], visited: list[Any]) -> Iterator[tuple[Any, str, str]]:
    """Yield holder, attribute and place of every value; list all parts."""
    for place, part in parts.items():
        visited.append(part)
        for name in history_of(part) or ():
            if not hasattr(part, name):
                raise NotSaved(f"{place}: its history names '{name}', which it does not have")
            value = getattr(part, name)
            if history_of(value) is None:
                yield part, name, f"{place}/{name}"
            else:
                yield from _places({f"{place}/{name}": value}, visited)


def _fitting(place: str, new: AnyArray | None, old: Any) -> Any:
    """Return the saved value; an empty array takes any length."""
    if new is None:
        raise NotSaved(f"{place} was not saved")
    here = np.zeros(0) if old is None else np.asarray(old)
    free = here.shape[:1] == (0,)
    alike = new.dtype == here.dtype and new.ndim == here.ndim and new.shape[free:] == here.shape[free:]
    if not (new.shape in ((), (0,)) if old is None else alike):
        found = f"found {new.dtype} {new.shape}, here is {here.dtype} {here.shape}"
        raise NotSaved(f"{place} does not fit: {found}")
    if isinstance(old, np.ndarray):
        return new.copy()
    return new.item() if new.ndim == 0 else None


def _assign(holder: Any, name: str, old: Any, new: Any) -> None:
    if getattr(getattr(type(holder), name, None), "fset", None) is not None:
        setattr(holder, name, new)
    elif isinstance(old, dict):
        for key, value in new.items():
            if isinstance(value, np.ndarray) and value.shape == old[key].shape:
                old[key][...] = value
            else:
                old[key] = value
    elif isinstance(old, np.ndarray) and old.shape == new.shape:
        old[...] = new
    else:
        setattr(holder, name, new)
