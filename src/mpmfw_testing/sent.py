"""Whether a plug-in's object can be sent to another process, as campaigns send those that they are given."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np

from mpmfw_testing.check import Violation
from mpmfw_testing.subject import Subject


def sent(subject: Subject) -> None:
    """An object can be sent to another process, and is the same there.

    A fresh object that is pickled and read again has the same class, options and attributes, arrays to the
    bit.
    """
    made = subject.make()
    try:
        other = pickle.loads(pickle.dumps(made))
    except Exception as error:
        attributes = ", ".join(name for name, value in vars(made).items() if not _is_sent(value))
        text = f"an object cannot be sent to another process: {error}"
        raise Violation(text, {"attributes that cannot": attributes} if attributes else {}) from error
    lost = sorted({name for name in {*vars(made), *vars(other)} if not _alike(made, other, name)})
    if type(other) is not type(made) or lost:
        raise Violation(
            "an object that was sent to another process is another one", {"lost or changed": ", ".join(lost)}
        )


def _is_sent(value: Any) -> bool:
    try:
        pickle.dumps(value)
    except Exception:
        return False
    return True


def _alike(one: Any, other: Any, name: str) -> bool:
    """Whether an attribute is there in both; of values that can be compared, whether it is the same."""
    if not (hasattr(one, name) and hasattr(other, name)):
        return False
    first, second = getattr(one, name), getattr(other, name)
    if isinstance(first, np.ndarray):
        return bool(np.array_equal(first, second, equal_nan=first.dtype.kind == "f"))
    plain = name == "options" or isinstance(first, bool | int | float | str | tuple | None)
    return not plain or bool(first == second)
