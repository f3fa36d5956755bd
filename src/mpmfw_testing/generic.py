"""Properties of every kind: the same bits again, and no change to other arrays."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from mpmfw.state.fields import AnyArray
from mpmfw_testing.check import Picture, Violation

Values = Iterable[tuple[str, AnyArray]]


def require_repeatable(values: Callable[[], Values], case: Mapping[str, object] | None = None) -> None:
    """Raise a violation unless two calls, each with a fresh object, give the same bits; none infinite."""
    second = dict(values())
    for name, found in values():
        if np.isinf(found).any():
            raise Violation("a value is infinite", {"value": name, **(case or {})})
        if not np.array_equal(found, second[name], equal_nan=True):
            raise Violation("a second object gives other values", {"value": name, **(case or {})})


@contextmanager
def unchanged(
    who: str, *owners: Any, but: Collection[str] = (), picture: Picture | None = None, **case: object
) -> Iterator[None]:
    """Raise a violation if the block changes a bit of the owners' arrays, ``but`` those of some names."""

    def arrays() -> dict[str, AnyArray]:
        found: dict[str, AnyArray] = {}
        for owner in owners:
            held = owner.arrays() if hasattr(owner, "arrays") else vars(owner)
            own = {f"{type(owner).__name__}.{name}": each for name, each in held.items() if name not in but}
            found |= {name: each for name, each in own.items() if isinstance(each, np.ndarray)}
        return found

    before = {name: array.copy() for name, array in arrays().items()}
    yield
    changed = [k for k, array in arrays().items() if not np.array_equal(array, before[k], equal_nan=True)]
    if changed:
        raise Violation(f"{who} changes {', '.join(changed)}", case, picture)
