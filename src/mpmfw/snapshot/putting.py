"""Values are put into objects that were built alike, in the order in which they were taken."""

from __future__ import annotations

import sys
import types
from collections import defaultdict, deque
from collections.abc import Mapping
from typing import Any

import numpy as np

from mpmfw.fields import AnyArray
from mpmfw.plugin import PlugIn
from mpmfw.snapshot.archive import NotSaved, Snapshot
from mpmfw.snapshot.kinds import (
    DICTS,
    LISTS,
    attributes_of,
    code_name,
    from_literal,
    name_of,
)

#: Packages whose classes and functions a file may name, beside those of the objects themselves and of plug-ins that they hold.
_TRUSTED = {"mpmfw", "numpy", "scipy", "collections"}


def put(snapshot: Snapshot, roots: Mapping[str, Any]) -> None:
    """Give objects that were built alike the values of others; objects that are there keep their identity.

    Raises
    ------
    NotSaved
        They were built otherwise.
    """
    if list(snapshot.roots) != list(roots):
        raise NotSaved(f"saved were {', '.join(snapshot.roots)}; here are {', '.join(roots)}")
    putting = _Putting(snapshot, _TRUSTED.union(*map(_packages, roots.values())))
    for name, root in roots.items():
        putting.value(snapshot.roots[name], root, name)


def _packages(root: Any) -> set[str]:
    """Packages of an object's class and of those that it derives from, and of the plug-ins that it holds: detection and law."""
    held = [one for one in getattr(root, "__dict__", {}).values() if isinstance(one, PlugIn)]
    kinds = {kind for one in (root, *held) for kind in type(one).__mro__}
    return {kind.__module__.partition(".")[0] for kind in kinds} - {"builtins"}


class _Putting:
    """One pass over objects, in the order in which they were taken."""

    def __init__(self, snapshot: Snapshot, packages: set[str]) -> None:
        self.packages = packages
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
            return tuple.__new__(self._class(code["of"], old, where), items)
        if "method" in code:
            owner = old.__self__ if isinstance(old, types.MethodType) else None
            return getattr(self.value(code["of"], owner, where), code["method"])
        if "literal" in code:
            return from_literal(code["literal"])
        return self._as_built(code["code"], old, where)

    def _class(self, name: str, old: Any, where: str) -> type:
        """The class of a name: that of what is at the place, or one that is imported."""
        if name_of(type(old)) == name:
            return type(old)
        found = self._imported(name)
        if not isinstance(found, type):
            raise NotSaved(f"{where}: the plug-ins have no class {name.replace(':', '.')} here")
        return found

    def _as_built(self, said: str, old: Any, where: str) -> Any:
        """Code at its place, or found by its name."""
        if code_name(old) == said:
            return old
        found = self._imported(said)
        if found is None:
            name = said.strip("()").replace(":", ".")
            raise NotSaved(f"{where} was {name}, which a run that is built anew does not have there")
        return found

    def _imported(self, name: str) -> Any:
        """What an imported module has under a name, ``module:name``; None if nothing, or if it is none of the trusted ones."""
        module, _, path = name.partition(":")
        found: Any = sys.modules.get(module)
        for part in path.split("."):
            found = getattr(found, part, None)
        trusted = module.partition(".")[0] in self.packages
        if module == "builtins":
            trusted = isinstance(found, type)
        return found if trusted and code_name(found) == name else None  # not what another module has imported

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
        kind = next(each for each in LISTS if each.__name__ == node["of"])
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
        kind = next(each for each in DICTS if each.__name__ == node["of"])
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
        kind = self._class(node["of"], old, where)
        frozen = getattr(getattr(kind, "__dataclass_params__", None), "frozen", False)
        if type(old) is kind and not frozen and self._free(old):
            return old
        try:
            return object.__new__(kind)
        except TypeError as error:
            raise NotSaved(f"{where}: a {node['of']} cannot be made anew") from error

    def _fill_object(self, number: int, node: Any, old: Any, where: str) -> None:
        target = self._done[number] = self._object(node, old, where)
        olds = attributes_of(old) if type(old) is type(target) else {}
        if target is old:
            for name in olds.keys() - node["object"].keys():
                object.__delattr__(target, name)
        for name, part in node["object"].items():
            object.__setattr__(target, name, self.value(part, olds.get(name), f"{where}.{name}"))
