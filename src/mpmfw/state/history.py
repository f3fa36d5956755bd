"""Declared history: the values that a run keeps from step to step, by place.

A class names them, ``history = ("work", "gained")``, beside those that its bases name. They are numbers,
texts, arrays, lists of texts, dictionaries of numbers or of arrays, and parts with a history of their own.
All else is built anew from the scene. Saved values take the places of those that were built and are of their
type and shape: they name no class and no function. A part may have a method ``restored``, which is called
when all values are there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmfw.errors import MpmfwError
from mpmfw.state.fields import AnyArray

#: Types of numbers that arrays may have.
TYPES = ("<f8", "<f4", "<i8", "<i4", "|i1", "|u1", "|b1")


class NotSaved(MpmfwError):
    """A history holds something that cannot be saved, or what was saved does not fit."""


@dataclass
class Snapshot:
    """What a simulation keeps from step to step.

    Attributes
    ----------
    parts
        Names of the parts, as messages have them.
    values, arrays
        By place, ``PART/NAME``.
    """

    parts: list[str]
    values: dict[str, Any]
    arrays: dict[str, AnyArray]


def history_of(part: Any) -> tuple[str, ...] | None:
    """Names that the classes of an object declare, those of its bases first; None if none of them declares
    any.
    """
    declared = [vars(kind)["history"] for kind in reversed(type(part).__mro__) if "history" in vars(kind)]
    return tuple(dict.fromkeys(name for names in declared for name in names)) if declared else None


def take(parts: Mapping[str, Any]) -> Snapshot:
    """Copy the values of parts, by their names.

    Raises
    ------
    NotSaved
        A history names something that there is not, or that cannot be saved.
    """
    snapshot = Snapshot(list(parts), {}, {})
    for holder, name, place in _places(parts, []):
        value = getattr(holder, name)
        arrays = _arrays_of(value, place)
        for key, array in arrays.items():
            if array.dtype.str not in TYPES:
                raise NotSaved(f"{key} has numbers of type {array.dtype}; expected one of {', '.join(TYPES)}")
            snapshot.arrays[key] = array.copy()
        if not arrays:
            snapshot.values[place] = value.item() if isinstance(value, np.generic) else value
            if not _is_plain(snapshot.values[place]):
                raise NotSaved(
                    f"{place} is a {type(value).__name__}; expected numbers, texts, arrays, lists of texts, "
                    "dictionaries of "
                    "numbers or of arrays, or an object whose class has a history"
                )
    return snapshot


def put(snapshot: Snapshot, parts: Mapping[str, Any]) -> None:
    """Give values to parts that were built alike; arrays of an unchanged shape are filled in place.

    Raises
    ------
    NotSaved
        They were built otherwise.
    """
    if snapshot.parts != list(parts):
        raise NotSaved(f"saved were {', '.join(snapshot.parts)}; here are {', '.join(parts)}")
    visited: list[Any] = []
    for holder, name, place in _places(parts, visited):
        old = getattr(holder, name)
        if place in snapshot.values:
            if not _fits(snapshot.values[place], old):
                raise NotSaved(
                    f"{place} does not fit: found {snapshot.values[place]!r:.60}, here is {old!r:.60}"
                )
            if isinstance(old, dict):
                old.clear()
                old.update(snapshot.values[place])
            else:
                setattr(holder, name, snapshot.values[place])
            continue
        here = _arrays_of(old, place)
        there = {key: _fitting(key, snapshot.arrays.get(key), array) for key, array in here.items()}
        if not here:
            raise NotSaved(f"{place} was not saved")
        by_setter = getattr(getattr(type(holder), name, None), "fset", None) is not None
        if not by_setter and all(array.shape == there[key].shape for key, array in here.items()):
            for key, array in here.items():
                array[...] = there[key]
        else:
            copies = {key.removeprefix(f"{place}/"): array.copy() for key, array in there.items()}
            setattr(holder, name, copies if isinstance(old, dict) else copies[place])
    for part in visited:
        if hasattr(part, "restored"):
            part.restored()


def check_indices(count: int, **arrays: AnyArray) -> None:
    """Refuse numbers in ``arrays`` that are no indices of ``count`` things, and not −1 for none.

    Raises
    ------
    NotSaved
        There are some: kernels would read beyond the end.
    """
    for name, array in arrays.items():
        if array.size and not (array.min() >= -1 and array.max() < count):
            raise NotSaved(f"{name} has an index that is not from -1 to {count - 1}")


def _places(parts: Mapping[str, Any], visited: list[Any]) -> Iterator[tuple[Any, str, str]]:
    """Holder, attribute and place of every value of parts and of the parts that they keep, which are
    ``visited``.
    """
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


def _arrays_of(value: Any, place: str) -> dict[str, AnyArray]:
    """Arrays that a value is or has, by place; nothing of any other value."""
    if isinstance(value, np.ndarray):
        return {place: value}
    if isinstance(value, dict) and all(isinstance(one, np.ndarray) for one in value.values()):
        return {f"{place}/{key}": one for key, one in value.items()}
    return {}


def _is_number(value: Any) -> bool:
    return isinstance(value, float) or (isinstance(value, int) and -(2**63) <= value < 2**63)


def _is_plain(value: Any) -> bool:
    """Whether JSON has the value as it is."""
    if isinstance(value, list):
        return all(isinstance(one, str) for one in value)
    if isinstance(value, dict):
        return all(isinstance(key, str) and _is_number(one) for key, one in value.items())
    return value is None or isinstance(value, str) or _is_number(value)


def _fits(new: Any, old: Any) -> bool:
    """Whether a value that was read may take the place of one that was built."""
    old = old.item() if isinstance(old, np.generic) else old
    if not _is_plain(new) or (isinstance(old, dict) and isinstance(new, dict) and old.keys() - new.keys()):
        return False
    return type(new) is type(old) or (old is None and _is_number(new))


def _fitting(place: str, new: AnyArray | None, old: AnyArray) -> AnyArray:
    """The saved array of a place; the length is that of the one there, any if that is empty."""
    if new is None:
        raise NotSaved(f"{place} was not saved")
    length = old.shape[:1] if old.shape[:1] != (0,) else new.shape[:1]
    if (new.dtype, new.shape) != (old.dtype, (*length, *old.shape[1:])):
        raise NotSaved(
            f"{place} does not fit: found {new.dtype} {new.shape}, here is {old.dtype} {old.shape}"
        )
    return new
