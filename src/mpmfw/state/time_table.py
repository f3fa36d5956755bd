"""Values in time: linear between the rows of a table, constant outside."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import Discriminator, Field, Strict, Tag

from mpmfw.state.fields import FloatArray
from mpmfw.units import Time


class TimeTable:
    """Rows (t, values …), (m, 1 + n), as one function of time [s]; a single row is a constant."""

    def __init__(self, rows: Sequence[Sequence[float]]) -> None:
        table = np.array(rows, dtype=float)
        self.times, self.values = table[:, 0], np.ascontiguousarray(table[:, 1:])

    @classmethod
    def constant(cls, values: Sequence[float]) -> TimeTable:
        """The same ``values`` (n,) at all times [s]."""
        return cls([(0.0, *values)])

    @classmethod
    def of(cls, given: Any) -> TimeTable:
        """Return the table of a scene's key: a number, a vector (n,), or rows of a time [s] and either."""
        if not isinstance(given, tuple):
            return cls.constant([given])
        return cls(given) if isinstance(given[0], tuple) else cls.constant(given)

    def at(self, time: float) -> FloatArray:
        """Values (n,) at a ``time`` [s]."""
        if len(self.times) == 1:
            return np.asarray(self.values[0])
        return np.array([np.interp(time, self.times, column) for column in self.values.T])


def number_in_time(quantity: Any) -> Any:
    """The annotation of a ``quantity`` (:func:`mpmfw.api.units.quantity`) that is constant, or rows (t,
    value).
    """
    rows = tuple[Annotated[tuple[Time, quantity], Strict(False)], ...]
    return Annotated[
        Annotated[quantity, Tag("single")]
        | Annotated[rows, Strict(False), Field(min_length=2), Tag("array")],
        Discriminator(array_or_single),
    ]


def vector_in_time(quantity: Any) -> Any:
    """The annotation of a vector whose components have a ``quantity``: constant, or rows (t, x, y[, z])."""
    rows = tuple[row_in_time(quantity), ...]  # type: ignore[misc, valid-type]
    vector = tuple[quantity, ...]
    return Annotated[
        Annotated[vector, Strict(False), Field(min_length=2, max_length=3), Tag("vector")]
        | Annotated[rows, Strict(False), Field(min_length=2), Tag("rows")],
        Discriminator(_vector_or_rows),
    ]


def row_in_time(quantity: Any) -> Any:
    """The annotation of one row (t, x, y[, z]) whose components have a ``quantity``."""
    return Annotated[
        Annotated[tuple[Time, quantity, quantity], Strict(False), Tag("two")]
        | Annotated[tuple[Time, quantity, quantity, quantity], Strict(False), Tag("three")],
        Discriminator(_length),
    ]


def problems_in_time(given: Any, components: int) -> Iterator[tuple[tuple[int, ...], str]]:
    """Yield what is wrong with a number, a vector or rows in time, with the row's index where it is a row's.

    Every row, or the vector, must have so many ``components``."""
    if not isinstance(given, tuple):
        return
    if not isinstance(given[0], tuple):
        if len(given) != components:
            yield (), wrong_length(len(given), components)
        return
    for index, row in enumerate(given):
        if len(row) != components + 1:
            yield (index,), f"has {len(row)} entries; expected the time and {components} components"
    for index, (before, after) in enumerate(itertools.pairwise(given)):
        if after[0] <= before[0]:
            yield (index + 1,), f"times must increase, but {after[0]:g} s follows {before[0]:g} s"


def wrong_length(given: int, dim: int) -> str:
    """``has 3 entries; expected 2, because the grid is 2D``."""
    return f"has {given} entries; expected {dim}, because the grid is {dim}D"


def array_or_single(value: Any) -> str:
    """Tag that lets one branch of a union complain, not all of them."""
    return "array" if isinstance(value, list | tuple) else "single"


def _length(value: Any) -> str:
    return "three" if isinstance(value, list | tuple) and len(value) == 4 else "two"


def _vector_or_rows(value: Any) -> str:
    rows = isinstance(value, list | tuple) and len(value) > 0 and isinstance(value[0], list | tuple)
    return "rows" if rows else "vector"
