"""Every attribute of a public class is said to readers of its page: a comment ``#:`` beside or above it, or its docstring."""

from __future__ import annotations

import ast
import inspect
import pydoc
import re
import textwrap

import pytest

import mpmfw.api

CLASSES = sorted(
    {
        base
        for name in mpmfw.api.__all__
        if isinstance(found := getattr(mpmfw.api, name), type)
        for base in found.__mro__
        if base.__module__.startswith("mpmfw")
    },
    key=lambda kind: (kind.__module__, kind.__qualname__),
)


def unsaid(kind: type) -> list[str]:
    """Annotated attributes of the class itself without a word."""
    source = textwrap.dedent(inspect.getsource(kind))
    lines, (tree,) = source.splitlines(), ast.parse(source).body
    assert isinstance(tree, ast.ClassDef)
    told = ast.get_docstring(tree) or ""
    found = []
    for node in tree.body:
        if not isinstance(node, ast.AnnAssign) or not isinstance(node.target, ast.Name):
            continue
        own = lines[node.lineno - 2 : node.end_lineno]
        commented = own[0].lstrip().startswith("#:") or any("#:" in line for line in own[1:])
        name = node.target.id
        if not (name.startswith("_") or commented or re.search(rf"^(.*, )?{name}\b", told, re.MULTILINE)):
            found.append(name)
    return found


@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.__name__)
def test_every_attribute_is_said(kind: type) -> None:
    assert unsaid(kind) == []


@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.__name__)
def test_help_shows_every_attribute(kind: type) -> None:
    shown = pydoc.plain(pydoc.render_doc(kind))
    names = [name for name in vars(kind).get("__annotations__", {}) if not name.startswith("_")]
    assert [name for name in names if not re.search(rf"\b{name}\b", shown)] == []


class Silent:
    """A class that says nothing of one."""

    told: int  #: of what there is
    untold: int


def test_a_silent_one_is_found() -> None:
    assert unsaid(Silent) == ["untold"]
