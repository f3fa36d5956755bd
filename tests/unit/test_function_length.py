"""No function is longer than a page: its body, without signature and docstring."""

import ast
import importlib
from pathlib import Path

LONGEST = 50  #: lines


def bodies(source):
    """Lines of every function's body from its first statement on, by name."""
    lengths = {}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            body = node.body[1:] if ast.get_docstring(node) else node.body
            if body:
                lengths[node.name] = (node.end_lineno or 0) - body[0].lineno + 1
    return lengths


def test_no_function_is_longer_than_a_page():
    long = []
    for package in ("mpmfw", "mpmfw_contact", "mpmfw_load", "mpmfw_shape", "mpmfw_material", "mpmfw_code"):
        folder = Path(str(importlib.import_module(package).__file__)).parent
        for path in sorted(folder.rglob("*.py")):
            found = bodies(path.read_text(encoding="utf-8"))
            long += [
                f"{path.name}: {name}, {lines} lines" for name, lines in found.items() if lines > LONGEST
            ]
    assert long == []
