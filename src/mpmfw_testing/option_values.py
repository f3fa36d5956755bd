"""Values to try of an option: its field's examples, and what its type and bounds let one make up."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo


def candidates(field: FieldInfo) -> list[Any]:
    """Values to try of an option: the field's examples, then what its type lets one make up.

    Numbers keep the field's bounds; a value may still be refused by a validator of the model. An example may
    be the value that the plug-in under test was given, so that examples alone would leave nothing to compare
    it with.
    """
    default = field.get_default(call_default_factory=True)
    tried: list[Any] = []
    for value in [*(field.examples or ()), *_generated(field.annotation, default, field.metadata)]:
        if value not in tried:  # no set: values need not be hashable
            tried.append(value)
    return tried


def choices(annotation: Any) -> list[Any]:
    """All values of a type that has a few: a ``Literal`` or bool."""
    if annotation is bool:
        return [False, True]
    if get_origin(annotation) is Literal:
        return list(get_args(annotation))
    return []


def _generated(annotation: Any, default: Any, metadata: Sequence[Any]) -> Iterator[Any]:
    if get_origin(annotation) is Annotated:
        inner, *more = get_args(annotation)
        yield from _generated(inner, default, [*metadata, *more])
    elif get_origin(annotation) in (Union, type(int | str)):
        for part in get_args(annotation):
            yield from _generated(part, default, metadata)
    elif choices(annotation):
        yield from choices(annotation)
    elif annotation is float or annotation is int:
        yield from _numbers(annotation, default, metadata)
    elif annotation is str:
        yield from ("second", "first")
    elif get_origin(annotation) in (tuple, list) and set(get_args(annotation)) <= {float, int, ...}:
        yield from ((1.0, 0.0), (0.0, 1.0), (0.0, 0.0, 1.0))


def _numbers(kind: type[float | int], default: Any, metadata: Sequence[Any]) -> Iterator[float]:
    """Numbers within the bounds: round the default, a few plain ones, some near the bounds."""
    constraints = list(itertools.chain.from_iterable(getattr(each, "metadata", [each]) for each in metadata))
    least, above = _bound(constraints, "ge", max, -math.inf), _bound(constraints, "gt", max, -math.inf)
    most, below = _bound(constraints, "le", min, math.inf), _bound(constraints, "lt", min, math.inf)
    start = default if isinstance(default, int | float) and not isinstance(default, bool) else 0
    tried: list[float] = [2 * start, start / 2 if kind is float else start // 2] if start else []
    tried += [1, 0, 2] if kind is int else [0.01, 1.0, 0.1]
    low, high = max(least, above), min(most, below)
    if math.isfinite(low) and math.isfinite(high):
        tried += [low + (high - low) * share for share in (0.25, 0.75)]
    if math.isfinite(low):
        tried += [low + 1, low]
    if math.isfinite(high):
        tried += [high - 1, high]
    whole = (math.floor(value) if kind is int else value for value in tried)
    yield from (value for value in dict.fromkeys(whole) if least <= value <= most and above < value < below)


def _bound(constraints: Sequence[Any], name: str, strictest: Any, none: float) -> float:
    """The strictest of the bounds of one name, as pydantic keeps them; ``none`` without any."""
    return float(
        strictest([getattr(each, name) for each in constraints if hasattr(each, name)], default=none)
    )
