"""Which objects are values, which are code, and what both are called."""

from __future__ import annotations

import io
import logging
import pathlib
import re
import types
from collections import Counter, OrderedDict, defaultdict, deque
from enum import Enum
from functools import partial
from typing import Any

import numpy as np
from pydantic import BaseModel

from mpmfw.hooks import BoundHooks

#: What stays as it was built.
CODE = (
    type, types.ModuleType, types.FunctionType, types.BuiltinFunctionType, partial, BaseModel, logging.Logger, re.Pattern,
    pathlib.PurePath, np.dtype, np.ufunc, Enum, BoundHooks,
)  # fmt: skip
#: Values whose classes a stranger may have derived from; what they hold is no attribute.
OPAQUE = (
    io.IOBase,
    BaseException,
    np.ndarray,
    list,
    deque,
    dict,
    set,
    frozenset,
    str,
    int,
    float,
    complex,
    bytes,
)
#: Whose objects are code.
LIBRARIES = ("numba", "pluggy", "pint")
#: Values that JSON has.
PLAIN = (bool, int, float, str, type(None))
#: Collections, each by itself and not what is derived from it.
DICTS = (dict, OrderedDict, Counter, defaultdict)
LISTS = (list, deque, set, frozenset)


def name_of(kind: type) -> str:
    """Module and name of a class."""
    return f"{kind.__module__}:{kind.__qualname__}"


def code_name(value: Any) -> str:
    """What a piece of code is called: a function or class by itself, anything else by its class."""
    if isinstance(value, Enum):
        return f"{name_of(type(value))}.{value.name}"
    if isinstance(value, types.ModuleType):
        return f"{value.__name__}:"
    if isinstance(value, type | types.FunctionType | types.BuiltinFunctionType):
        return f"{value.__module__}:{value.__qualname__}"
    return f"{name_of(type(value))}()"


def literal_of(value: Any) -> Any:
    """A small value as JSON has it."""
    if isinstance(value, complex):
        return ["complex", value.real, value.imag]
    if isinstance(value, bytes):
        return ["bytes", value.hex()]
    return [type(value).__name__, value.start, value.stop, value.step]


def from_literal(literal: Any) -> Any:
    """The value again."""
    makers = {"complex": complex, "bytes": bytes.fromhex, "slice": slice, "range": range}
    return makers[literal[0]](*literal[1:])  # type: ignore[operator]


def is_opaque(value: Any) -> bool:
    """Whether an object's values are not its attributes."""
    if isinstance(value, OPAQUE) or hasattr(value, "__next__"):
        return True
    slots = any("__slots__" in vars(kind) for kind in type(value).__mro__)
    return not slots and not hasattr(value, "__dict__")


def attributes_of(value: Any) -> dict[str, Any]:
    """Attributes of the object itself, those in slots as well; none that its class has among ``unsaved``."""
    found = dict(getattr(value, "__dict__", {}))
    for kind in type(value).__mro__:
        slots = vars(kind).get("__slots__", ())
        for slot in (slots,) if isinstance(slots, str) else slots:
            name = (
                f"_{kind.__name__.lstrip('_')}{slot}"
                if slot.startswith("__") and not slot.endswith("__")
                else slot
            )
            if name not in ("__dict__", "__weakref__") and hasattr(value, name):
                found[name] = getattr(value, name)
    return {name: part for name, part in found.items() if name not in getattr(type(value), "unsaved", ())}
