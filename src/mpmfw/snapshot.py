"""The values of objects by their place: taken from one simulation, put into another that was built alike.

Nothing has to be declared: whatever hangs on a plug-in's attributes is its history. Numbers, texts, arrays (views of one array
stay views of one), lists, dictionaries, sets, tuples and objects of Python classes are walked through, and each of them is
written once, however many hold it. What is code or was given (functions, classes, options) stays as it was built; a class whose
attributes are not its values says what they are by Python's own ``__getstate__`` and ``__setstate__``. All else (files,
iterators, objects of compiled libraries) is refused with its place. Reading runs no code of the file's: classes are looked up
among those that are imported, and made without their constructors.
"""

from __future__ import annotations

import contextlib
import io
import json
import logging
import os
import pathlib
import re
import sys
import types
import zipfile
from collections import Counter, OrderedDict, defaultdict, deque
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from functools import partial
from typing import Any, BinaryIO

import numpy as np
from pydantic import BaseModel

from mpmfw.errors import MpmfwError
from mpmfw.fields import AnyArray
from mpmfw.hooks import BoundHooks

#: What stays as it was built.
_CODE = (
    type, types.ModuleType, types.FunctionType, types.BuiltinFunctionType, partial, BaseModel, logging.Logger, re.Pattern,
    pathlib.PurePath, np.dtype, np.ufunc, Enum, BoundHooks,
)  # fmt: skip
_OPAQUE = (
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
_LIBRARIES = ("numba", "pluggy", "pint")
_PLAIN = (bool, int, float, str, type(None))
_DICTS = (dict, OrderedDict, Counter, defaultdict)
_LISTS = (list, deque, set, frozenset)


class NotSaved(MpmfwError):
    """An object holds something that cannot be saved, or what was saved does not fit the object."""


@dataclass
class Snapshot:
    """Values by place.

    Parameters
    ----------
    roots
        What the outermost objects were, by name.
    nodes
        Everything that has an identity, each once; others refer to it by its number.
    arrays
        Those of the nodes.
    """

    roots: dict[str, Any]
    nodes: list[Any]
    arrays: list[AnyArray]

    def write(self, file: BinaryIO, facts: Mapping[str, Any]) -> None:
        """Write it, with ``facts`` for whoever reads it, as a zip archive of JSON and NumPy arrays."""
        with zipfile.ZipFile(file, "w") as archive:
            for k, array in enumerate(self.arrays):
                with archive.open(f"{k}.npy", "w", force_zip64=True) as member:
                    np.lib.format.write_array(member, array, allow_pickle=False)
            archive.writestr("values.json", json.dumps([self.roots, self.nodes]))
            archive.writestr("facts.json", json.dumps(facts))

    @classmethod
    def read(cls, file: BinaryIO) -> tuple[Snapshot, dict[str, Any]]:
        """Read it, and the facts."""
        with zipfile.ZipFile(file) as archive:
            roots, nodes = json.loads(archive.read("values.json"))
            count = sum(name.endswith(".npy") for name in archive.namelist())
            arrays = []
            for k in range(count):
                with archive.open(f"{k}.npy") as member:
                    arrays.append(np.lib.format.read_array(member, allow_pickle=False))
            return cls(roots, nodes, arrays), json.loads(archive.read("facts.json"))


def write_snapshot(path: str | os.PathLike[str], snapshot: Snapshot, facts: Mapping[str, Any]) -> None:
    """Write a snapshot and ``facts`` about it to a file in one step: who reads it sees the one before or this one, whole.

    Raises
    ------
    MpmfwError
        It cannot be written.
    """
    growing = f"{os.fspath(path)}.part"
    try:
        with open(growing, "wb") as file:
            snapshot.write(file, facts)
            file.flush()
            os.fsync(file.fileno())
        os.replace(growing, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            os.unlink(growing)
        raise MpmfwError(f"cannot write '{os.fspath(path)}': {error.strerror or error}") from error


def read_snapshot(path: str | os.PathLike[str]) -> tuple[Snapshot, dict[str, Any]]:
    """The snapshot of a file and the facts about it.

    Raises
    ------
    MpmfwError
        There is no such file, or it is damaged.
    """
    try:
        with open(path, "rb") as file:
            return Snapshot.read(file)
    except OSError as error:
        raise MpmfwError(f"cannot read '{os.fspath(path)}': {error.strerror or error}") from error
    except (zipfile.BadZipFile, KeyError, ValueError, EOFError) as error:
        raise MpmfwError(f"'{os.fspath(path)}' was cut short or is damaged") from error


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


def put(snapshot: Snapshot, roots: Mapping[str, Any]) -> None:
    """Give objects that were built alike the values of others; objects that are there keep their identity.

    Raises
    ------
    NotSaved
        They were built otherwise.
    """
    if list(snapshot.roots) != list(roots):
        raise NotSaved(f"saved were {', '.join(snapshot.roots)}; here are {', '.join(roots)}")
    putting = _Putting(snapshot)
    for name, root in roots.items():
        putting.value(snapshot.roots[name], root, name)


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
        if kind in _PLAIN:
            return value
        if isinstance(value, np.generic):
            return {"number": self._array(np.asarray(value))}
        if isinstance(value, tuple):
            items = [self.code(item, f"{where}[{k}]") for k, item in enumerate(value)]
            return {"tuple": items, "of": _name(kind)}
        if kind in (complex, bytes, slice, range):
            return {"literal": _literal(value)}
        if kind is types.MethodType:
            return {"method": value.__name__, "of": self.code(value.__self__, where)}
        if isinstance(value, _CODE) or kind is object or kind.__module__.partition(".")[0] in _LIBRARIES:
            return {"code": _said(value)}
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
        if kind in _LISTS:
            more = {"most": value.maxlen} if kind is deque else {}
            return {"list": [self.code(item, f"{where}[…]") for item in value], "of": kind.__name__, **more}
        if kind in _DICTS:
            items = [
                [self.code(key, f"{where} keys"), self.code(item, f"{where}[{key!r}]")]
                for key, item in value.items()
            ]
            made_by = {"factory": self.code(value.default_factory, where)} if kind is defaultdict else {}
            return {"dict": items, "of": kind.__name__, **made_by}
        if isinstance(value, np.random.Generator):
            return {"random": self.code(value.bit_generator.state, where)}
        if hasattr(value, "__setstate__") and any("__getstate__" in vars(base) for base in kind.__mro__[:-1]):
            return {"state": self.code(value.__getstate__(), where), "of": _name(kind)}
        if _is_opaque(value):
            raise NotSaved(
                f"{where} is a {_name(kind).replace(':', '.')}, which cannot be saved; expected numbers, arrays, texts, lists, "
                "dictionaries or objects of these, or __getstate__ and __setstate__"
            )
        parts = {name: self.code(part, f"{where}.{name}") for name, part in _attributes(value).items()}
        return {"object": parts, "of": _name(kind)}

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


class _Putting:
    """One pass over objects, in the order in which they were taken."""

    def __init__(self, snapshot: Snapshot) -> None:
        self.nodes, self.arrays = snapshot.nodes, snapshot.arrays
        self._done: dict[int, Any] = {}
        self._used: dict[
            int, Any
        ] = {}  # by id: one that stands for two places would have the values of the last

    def value(self, code: Any, old: Any, where: str) -> Any:
        """The value that a code stands for; ``old`` is what is at its place."""
        if not isinstance(code, dict):
            return code
        if "at" in code:
            number = code["at"]
            if number not in self._done:
                self._make(number, old, where)
            return self._done[number]
        if "number" in code:
            return self.arrays[code["number"]][()]
        if "tuple" in code:
            olds = (
                old
                if isinstance(old, tuple) and len(old) == len(code["tuple"])
                else [None] * len(code["tuple"])
            )
            items = [
                self.value(item, each, f"{where}[{k}]")
                for k, (item, each) in enumerate(zip(code["tuple"], olds, strict=True))
            ]
            return tuple.__new__(_class(code["of"], old, where), items)
        if "method" in code:
            owner = old.__self__ if isinstance(old, types.MethodType) else None
            return getattr(self.value(code["of"], owner, where), code["method"])
        if "literal" in code:
            return _from_literal(code["literal"])
        return _as_built(code["code"], old, where)

    def _make(self, number: int, old: Any, where: str) -> None:
        node = self.nodes[number]
        if "array" in node or "view" in node:
            self._done[number] = self._ndarray(node, old, where)
        elif "list" in node:
            self._fill_list(number, node, old, where)
        elif "dict" in node:
            self._fill_dict(number, node, old, where)
        elif "random" in node:
            if not isinstance(old, np.random.Generator):
                raise NotSaved(f"{where}: expected a random generator where there was one")
            self._done[number] = old
            old.bit_generator.state = self.value(node["random"], None, where)
        elif "state" in node:
            target = self._done[number] = self._object(node, old, where)
            before = old.__getstate__() if type(old) is type(target) else None
            target.__setstate__(self.value(node["state"], before, where))
        else:
            self._fill_object(number, node, old, where)

    def _free(self, old: Any) -> bool:
        """Whether the object at a place may be filled; from now on it may not."""
        if id(old) in self._used:
            return False
        self._used[id(old)] = old
        return True

    def _ndarray(self, node: Any, old: Any, where: str) -> AnyArray:
        if "view" in node:
            dtype, shape, strides, start, writeable = node["view"]
            base = self.value(node["of"], getattr(old, "base", None), where)
            buffer = base if base.flags.c_contiguous else base.T
            view: AnyArray = np.ndarray(tuple(shape), dtype, buffer, start, tuple(strides))
            view.flags.writeable = writeable
            return view
        array: AnyArray = self.arrays[node["array"]]
        if type(old) is not np.ndarray or old.base is not None or not old.flags.writeable:
            return array.copy(order="K")
        alike = (old.shape, old.dtype, old.strides) == (array.shape, array.dtype, array.strides)
        if not alike or not self._free(old):
            return array.copy(order="K")
        old[...] = array
        return old

    def _fill_list(self, number: int, node: Any, old: Any, where: str) -> None:
        kind = next(each for each in _LISTS if each.__name__ == node["of"])
        olds = (
            list(old) if type(old) is kind and len(old) == len(node["list"]) else [None] * len(node["list"])
        )
        if kind is frozenset:
            self._done[number] = frozenset(self.value(item, None, where) for item in node["list"])
            return
        reused = type(old) is kind and getattr(old, "maxlen", None) == node.get("most") and self._free(old)
        made: Any = deque(maxlen=node["most"]) if kind is deque else kind()
        target = self._done[number] = old if reused else made
        items = [self.value(item, each, f"{where}[…]") for item, each in zip(node["list"], olds, strict=True)]
        target.clear()
        (target.update if kind is set else target.extend)(items)

    def _fill_dict(self, number: int, node: Any, old: Any, where: str) -> None:
        kind = next(each for each in _DICTS if each.__name__ == node["of"])
        olds = dict(old) if isinstance(old, dict) else {}
        target: Any = old if type(old) is kind and self._free(old) else kind()
        self._done[number] = target
        items = []
        for code, item in node["dict"]:
            key = self.value(code, None, f"{where} keys")
            items.append((key, self.value(item, olds.get(key), f"{where}[{key!r}]")))
        if kind is defaultdict:
            target.default_factory = self.value(node["factory"], getattr(old, "default_factory", None), where)
        target.clear()
        for key, item in items:
            target[key] = item

    def _object(self, node: Any, old: Any, where: str) -> Any:
        """The object at the place if it is of the class and free; a new one if not. One that is frozen may belong to others."""
        kind = _class(node["of"], old, where)
        frozen = getattr(getattr(kind, "__dataclass_params__", None), "frozen", False)
        if type(old) is kind and not frozen and self._free(old):
            return old
        try:
            return object.__new__(kind)
        except TypeError as error:
            raise NotSaved(f"{where}: a {node['of']} cannot be made anew") from error

    def _fill_object(self, number: int, node: Any, old: Any, where: str) -> None:
        target = self._done[number] = self._object(node, old, where)
        olds = _attributes(old) if type(old) is type(target) else {}
        if target is old:
            for name in olds.keys() - node["object"].keys():
                object.__delattr__(target, name)
        for name, part in node["object"].items():
            object.__setattr__(target, name, self.value(part, olds.get(name), f"{where}.{name}"))


def _name(kind: type) -> str:
    return f"{kind.__module__}:{kind.__qualname__}"


def _class(name: str, old: Any, where: str) -> type:
    """The class of a name: that of what is at the place, or one that is imported."""
    if _name(type(old)) == name:
        return type(old)
    found = _found(name)
    if not isinstance(found, type):
        raise NotSaved(f"{where}: there is no class {name.replace(':', '.')} here")
    return found


def _found(name: str) -> Any:
    """What an imported module has under a name, ``module:name``; None if nothing."""
    module, _, path = name.partition(":")
    found: Any = sys.modules.get(module)
    for part in path.split("."):
        found = getattr(found, part, None)
    return found


def _said(value: Any) -> str:
    """What a piece of code is called: a function or class by itself, anything else by its class."""
    if isinstance(value, Enum):
        return f"{_name(type(value))}.{value.name}"
    if isinstance(value, types.ModuleType):
        return f"{value.__name__}:"
    if isinstance(value, type | types.FunctionType | types.BuiltinFunctionType):
        return f"{value.__module__}:{value.__qualname__}"
    return f"{_name(type(value))}()"


def _as_built(said: str, old: Any, where: str) -> Any:
    """Code at its place, or found by its name."""
    if _said(old) == said:
        return old
    found = _found(said)
    if found is None:
        raise NotSaved(
            f"{where} was {said.strip('()').replace(':', '.')}, which a run that is built anew does not have there"
        )
    return found


def _literal(value: Any) -> Any:
    if isinstance(value, complex):
        return ["complex", value.real, value.imag]
    if isinstance(value, bytes):
        return ["bytes", value.hex()]
    return [type(value).__name__, value.start, value.stop, value.step]


def _from_literal(literal: Any) -> Any:
    makers = {"complex": complex, "bytes": bytes.fromhex, "slice": slice, "range": range}
    return makers[literal[0]](*literal[1:])  # type: ignore[operator]


def _is_opaque(value: Any) -> bool:
    """Whether an object's values are not its attributes."""
    if isinstance(value, _OPAQUE) or hasattr(value, "__next__"):
        return True
    slots = any("__slots__" in vars(kind) for kind in type(value).__mro__)
    return not slots and not hasattr(value, "__dict__")


def _attributes(value: Any) -> dict[str, Any]:
    """Attributes of the object itself, those in slots as well."""
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
    return found
