"""What a plug-in reaches for in mpmfw beyond the public modules, read from its source."""

from __future__ import annotations

import ast
from collections.abc import Iterator

PUBLIC = ("mpmfw.api", "mpmfw.kernels", "mpmfw_testing")

#: Functions that import what their first argument names.
IMPORTERS = ("import_module", "__import__")


def _imported(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Line and full name of every import, wherever it stands: in functions, under TYPE_CHECKING."""
    bound = _bound(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module is not None:
            yield from ((node.lineno, f"{node.module}.{alias.name}") for alias in node.names)
        elif isinstance(node, ast.Call) and _last_name(node.func, bound) in IMPORTERS and node.args:
            argument = node.args[0]
            if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
                yield node.lineno, argument.value


def _last_name(node: ast.expr, bound: dict[str, str]) -> str:
    """``import_module`` of ``importlib.import_module``, and of what was imported from there by another name."""
    if isinstance(node, ast.Name):
        return bound.get(node.id, node.id).rpartition(".")[2]
    return node.attr if isinstance(node, ast.Attribute) else ""


def _bound(tree: ast.Module) -> dict[str, str]:
    """Names that imports bind, with what they stand for; ``import mpmfw.api`` binds ``mpmfw``."""
    names = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                top = alias.name.split(".")[0]
                names[alias.asname or top] = alias.name if alias.asname else top
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module is not None:
            names |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
    return names


def _reached(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Line and full name of every attribute of an imported name, ``mpmfw.state.Grid`` after ``import mpmfw.api``."""
    bound = _bound(tree)
    inner = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    for node in ast.walk(tree):
        if not isinstance(node, ast.Attribute) or id(node) in inner:
            continue
        parts: list[str] = []
        value: ast.expr = node
        while isinstance(value, ast.Attribute):
            parts.insert(0, value.attr)
            value = value.value
        if isinstance(value, ast.Name) and value.id in bound:
            yield node.lineno, ".".join([bound[value.id], *parts])


def is_public(name: str) -> bool:
    """Whether the name is in a public module, and none of its parts is private; ``__name__`` and its like are not."""
    parts = name.split(".")
    private = [part for part in parts if part.startswith("_") and not part.endswith("__")]
    return ".".join(parts[:2]) in PUBLIC and not private


def foreign_imports(source: str) -> list[str]:
    """What a plug-in must not import or reach for in mpmfw, as ``line 3: mpmfw.state.Grid``."""
    tree = ast.parse(source)
    found = dict.fromkeys([*_imported(tree), *_reached(tree)])
    ours = [(line, name) for line, name in sorted(found) if name.split(".")[0] == "mpmfw"]
    return [f"line {line}: {name}" for line, name in ours if not is_public(name)]
