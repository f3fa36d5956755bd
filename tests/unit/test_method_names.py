"""No module of the core names a bundled contact method: what it must know of one, the method declares."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import mpmfw
from mpmfw.discovery import available, distribution_of

PACKAGE = Path(mpmfw.__file__).parent
#: The validation cases are bundled with an installed package, and compare methods by name.
SOURCES = sorted(path for path in PACKAGE.rglob("*.py") if path.relative_to(PACKAGE).parts[0] != "cases")
BUNDLED = [name for name, entry in available("contact").items() if distribution_of(entry) == "mpmfw"]
#: Also words of messages ("none is installed"), of output groups ("particles") and of records ("impulse"), which no grep can
#: tell from the method.
WORDS = ("none", "particles", "impulse")


def docstrings(tree: ast.AST) -> set[int]:
    """Where docstrings stand."""
    holders = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    first = [node.body[0] for node in ast.walk(tree) if isinstance(node, holders) and node.body]
    return {id(statement.value) for statement in first if isinstance(statement, ast.Expr)}


def names_in(source: str) -> list[str]:
    """Strings outside docstrings that are the name of a bundled contact, or a key of its options."""
    tree = ast.parse(source)
    apart = docstrings(tree)
    texts = [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in apart
    ]
    named = [name for name in BUNDLED if name not in WORDS]
    return [text for text in texts if text in named or any(f"contact.{name}" in text for name in BUNDLED)]


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.name)
def test_no_module_names_a_bundled_contact(path):
    assert names_in(path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("name", BUNDLED)
def test_a_planted_name_is_found(name):
    planted = f'"""Of {name}."""\nADVICE = "try contact.{name}.option"\ndef chosen():\n    """{name}"""\n    return "{name}"\n'
    expected = [f"try contact.{name}.option"] + [name] * (name not in WORDS)
    assert sorted(names_in(planted)) == sorted(expected)
