"""Every constant that contact and effects have is tested by its name: nobody need ask what it is for, or what breaks."""

from __future__ import annotations

import ast
import importlib
import re
from pathlib import Path

import pytest

PACKAGES = ("mpmfw_contact", "mpmfw.contact", "mpmfw.effects", "mpmfw.kernels")

#: What is no choice: the length of a vector register of two doubles, and an index that is none.
NO_CHOICE = {"VECTOR", "TOO_MANY"}


def constants() -> list[tuple[str, str]]:
    """Module and name of every number that a module of these packages sets at its top."""
    found = []
    for package in PACKAGES:
        folder = Path(str(importlib.import_module(package).__file__)).parent
        for source in sorted(folder.rglob("*.py")):
            module = ".".join([package, *source.relative_to(folder).with_suffix("").parts])
            for node in ast.parse(source.read_text(encoding="utf-8")).body:
                if isinstance(node, ast.Assign) and re.fullmatch(r"[-+*/ 0-9.e]+", ast.unparse(node.value)):
                    found += [(module, ast.unparse(target)) for target in node.targets]
    return found


TESTS = "\n".join(
    source.read_text(encoding="utf-8")
    for source in sorted(Path(__file__).parents[1].rglob("test_*.py"))
    if source != Path(__file__)
)


def test_the_constants_are_found() -> None:
    assert ("mpmfw_contact.surfaces.facing", "FLUSH") in constants()
    assert len(constants()) > 25


@pytest.mark.parametrize(("module", "name"), constants())
def test_each_has_a_test(module: str, name: str) -> None:
    assert name in NO_CHOICE or re.search(rf"\b{name}\b", TESTS), f"{module}.{name} is in no test"
