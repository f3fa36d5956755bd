"""Values are taken: one pass over objects, each of which is written once."""

from __future__ import annotations

import types
from collections import defaultdict, deque
from collections.abc import Mapping
from typing import Any

import numpy as np

from mpmfw.fields import AnyArray
from mpmfw.snapshot.archive import NotSaved, Snapshot
from mpmfw.snapshot.kinds import (
    CODE,
    DICTS,
    LIBRARIES,
    LISTS,
    PLAIN,
    attributes_of,
    code_name,
    is_opaque,
    literal_of,
    name_of,
)


def take(roots: Mapping[str, Any]) -> Snapshot:
    """The values of all that hangs on some objects, by the names that messages have for them.

    Raises
    ------
    NotSaved
        Something there is neither a value nor code.
    """
    taking = _Taking()
    return Snapshot(
        {name: taking.code(root, name) for name, root in roots.items()}, taking.nodes, taking.arrays
    )


class _Taking:
    """One pass over objects."""

    def __init__(self) -> None:
        self.nodes: list[Any] = []
        self.arrays: list[AnyArray] = []
        self._number: dict[int, int] = {}
        self._held: list[Any] = []  # an object that ended meanwhile would leave its id to another

    def code(self, value: Any, where: str) -> Any:
        """What stands for a value: itself, or a table of one key that says how it is made."""
        kind = type(value)
        if kind in PLAIN:
            return value
        if isinstance(value, np.generic):
            return {"number": self._array(np.asarray(value))}
        if isinstance(value, tuple):
            items = [self.code(item, f"{where}[{k}]") for k, item in enumerate(value)]
            return {"tuple": items, "of": name_of(kind)}
        if kind in (complex, bytes, slice, range):
            return {"literal": literal_of(value)}
        if kind is types.MethodType:
            return {"method": value.__name__, "of": self.code(value.__self__, where)}
        if isinstance(value, CODE) or kind is object or kind.__module__.partition(".")[0] in LIBRARIES:
            return {"code": code_name(value)}
        if id(value) not in self._number:
            number = self._number[id(value)] = len(self.nodes)
            self._held.append(value)
            self.nodes.append(None)
            self.nodes[number] = self._node(value, where)
        return {"at": self._number[id(value)]}

    def _node(self, value: Any, where: str) -> Any:
        kind = type(value)
        if kind is np.ndarray and value.dtype.hasobject is False:
            return self._ndarray(value, where)
        if kind in LISTS:
            more = {"most": value.maxlen} if kind is deque else {}
            return {"list": [self.code(item, f"{where}[…]") for item in value], "of": kind.__name__, **more}
        if kind in DICTS:
            items = [
                [self.code(key, f"{where} keys"), self.code(item, f"{where}[{key!r}]")]
                for key, item in value.items()
            ]
            dependencies_of = (
                {"factory": self.code(value.default_factory, where)} if kind is defaultdict else {}
            )
            return {"dict": items, "of": kind.__name__, **dependencies_of}
        if isinstance(value, np.random.Generator):
            return {"random": self.code(value.bit_generator.state, where)}
        if hasattr(value, "__setstate__") and any("__getstate__" in vars(base) for base in kind.__mro__[:-1]):
            return {"state": self.code(value.__getstate__(), where), "of": name_of(kind)}
        if is_opaque(value):
            raise NotSaved(
                f"{where} is a {name_of(kind).replace(':', '.')}, which cannot be saved; expected numbers, arrays, texts, lists, "
                "dictionaries or objects of these, or __getstate__ and __setstate__"
            )
        parts = {name: self.code(part, f"{where}.{name}") for name, part in attributes_of(value).items()}
        return {"object": parts, "of": name_of(kind)}

    def _ndarray(self, array: AnyArray, where: str) -> Any:
        """An array that owns its numbers, or the place of a view in the one that does."""
        base = array.base
        if type(base) is not np.ndarray or base.base is not None or not array.size or array.dtype.names:
            return {"array": self._array(array)}
        start = array.__array_interface__["data"][0] - base.__array_interface__["data"][0]
        layout = [array.dtype.str, list(array.shape), list(array.strides), start, array.flags.writeable]
        return {"view": layout, "of": self.code(base, where)}

    def _array(self, array: AnyArray) -> int:
        self.arrays.append(array.copy(order="K"))
        return len(self.arrays) - 1
