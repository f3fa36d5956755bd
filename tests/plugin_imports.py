"""What a plug-in imports of mpmfw beyond the public modules, read from its source."""

from __future__ import annotations

import ast
from collections.abc import Iterator

PUBLIC = ("mpmfw.api", "mpmfw.kernels", "mpmfw.testing")


def _imported(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Line and full name of every import of mpmfw, wherever it stands: in functions, under TYPE_CHECKING."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module is not None:
            yield from ((node.lineno, f"{node.module}.{alias.name}") for alias in node.names)


def _is_public(name: str) -> bool:
    """Whether the name is in a public module, and none of its parts is private."""
    parts = name.split(".")
    return ".".join(parts[:2]) in PUBLIC and not any(part.startswith("_") for part in parts)


def foreign_imports(source: str) -> list[str]:
    """Imports of mpmfw that a plug-in must not make, as ``line 3: mpmfw.state.Grid``."""
    found = [(line, name) for line, name in _imported(ast.parse(source)) if name.split(".")[0] == "mpmfw"]
    return [f"line {line}: {name}" for line, name in found if not _is_public(name)]
