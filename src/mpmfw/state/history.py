"""Declared history: the values that a run keeps from step to step, saved by place, ``PART/NAME``, or copied
between simulations that have some bodies in common.

A class names them, ``history = ("work", "gained")``, beside those of its bases: numbers, arrays, dictionaries
of either, parts with a history, and tuples of parts. None is a number that is not known yet. All else is
built anew from the scene. Saved values have the type and shape of those that were built. A part's method
``restored`` is called when all values are there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmfw.errors import MpmfwError
from mpmfw.state.fields import AnyArray, IntArray
from mpmfw.state.structs import Particles, State, Surface

#: Types of numbers that may be saved.
TYPES = ("<f8", "<f4", "<i8", "<i4", "|i1", "|u1", "|b1")


class NotSaved(MpmfwError):
    """Values that cannot be saved, or do not fit the simulation."""


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
            if isinstance(value, tuple) and None not in map(history_of, value):
                yield from _places({f"{place}/{name}/{k}": one for k, one in enumerate(value)}, visited)
            elif history_of(value) is None:
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


@dataclass(frozen=True)
class IndexMap:
    """Index here of everything that another simulation has, −1 of what is not here."""

    body: IntArray  #: (n_bodies,)
    particle: IntArray  #: (n,) material points
    surface_node: IntArray  #: (n_s,)
    facet: IntArray  #: (n_f,)
    pair: IntArray  #: (n_pairs,) pairs that are listed in both

    @classmethod
    def between(cls, other: State, own: State) -> IndexMap:
        """Return the map of bodies that have the same names."""
        index = {body.name: body.index for body in own.bodies}
        body = np.array([index.get(each.name, -1) for each in other.bodies], dtype=np.int64)
        shared = [(each, own.bodies[b]) for each, b in zip(other.bodies, body, strict=True) if b >= 0]
        listed = {(pair.first, pair.second): pair.index for pair in own.pairs}
        pair = [listed.get((int(body[p.first]), int(body[p.second])), -1) for p in other.pairs]
        points = [(theirs.particles, ours.particles) for theirs, ours in shared]
        nodes, facets, n_nodes, n_facets = [], [], 0, 0
        if (here := own.surface) is not None and (there := other.surface) is not None:
            nodes = [(there.of(theirs.index), here.of(ours.index)) for theirs, ours in shared]
            facets = [(there.facets_of(theirs.index), here.facets_of(ours.index)) for theirs, ours in shared]
            n_nodes, n_facets = there.count, len(there.facets)
        return cls(
            body=body,
            particle=_indices(other.particles.count, points),
            surface_node=_indices(n_nodes, nodes),
            facet=_indices(n_facets, facets),
            pair=np.array(pair, dtype=np.int64),
        )


def _indices(count: int, slices: Sequence[tuple[slice, slice]]) -> IntArray:
    found = np.full(count, -1, dtype=np.int64)
    for theirs, ours in slices:
        found[theirs] = np.arange(ours.start, ours.stop)
    return found


def copy_history(own: State, other: State, index_map: IndexMap) -> None:
    """Copy declared history and declared arrays of the bodies that both have."""

    def copy(dim: str, ours: AnyArray | None, theirs: Any) -> None:
        if ours is not None and ours.shape[1:] == theirs.shape[1:]:  # else scratch for so many bodies
            index = getattr(index_map, dim)
            ours[index[index >= 0]] = theirs[index >= 0]

    for name in Particles.history:
        copy("particle", getattr(own.particles, name), getattr(other.particles, name))
    if own.surface is not None and other.surface is not None:
        for name in Surface.history:
            copy("surface_node", getattr(own.surface, name), getattr(other.surface, name))
    for key, array in own.kept_arrays.items():
        if key in other.arrays:
            copy(own.dims[key][0], array, other.arrays[key])
