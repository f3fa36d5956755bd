"""Every constant that contact and effects have is tested by its name."""

import ast
import importlib
import re
from pathlib import Path

import pytest

PACKAGES = ("mpmfw_contact", "mpmfw.contact", "mpmfw.effects", "mpmfw.kernels")

#: Not a choice: an index that is none.
NO_CHOICE = {"OUTSIDE", "FULL"}


def constants():
    """Module and name of every number that a module of these packages sets at its top."""
    found = []
    for package in PACKAGES:
        folder = Path(str(importlib.import_module(package).__file__)).parent
        for source in sorted(folder.rglob("*.py")):
            module = ".".join([package, *source.relative_to(folder).with_suffix("").parts])
            for node in ast.parse(source.read_text(encoding="utf-8")).body:
                if isinstance(node, ast.Assign):
                    found += [(module, name) for name, value in named(node) if is_number(value)]
    return found


def named(node):
    """Names and values of an assignment, those of ``A, B = 1, 2`` one by one."""
    target, value = node.targets[0], node.value
    if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        return [(ast.unparse(one), part) for one, part in zip(target.elts, value.elts, strict=True)]
    return [(ast.unparse(target), value)]


def is_number(value):
    """Return True if it is a number, or a sum or product of some."""
    return re.fullmatch(r"[-+*/ 0-9.e]+", ast.unparse(value)) is not None


TESTS = [
    source.read_text(encoding="utf-8")
    for source in sorted(Path(__file__).parents[1].rglob("test_*.py"))
    if source != Path(__file__)
]


def test_the_constants_are_found():
    assert {("mpmfw.contact.surfaces.outline", "FLUSH"), ("mpmfw_contact.lcp", "FACING")} <= set(constants())
    assert len(constants()) > 25


@pytest.mark.parametrize(("module", "name"), constants())
def test_each_has_a_test(module, name):
    """In a file that names its module or folder too: others have constants of the same name."""
    own = module.removeprefix("mpmfw.").split(".")[1:]
    tested = any(
        re.search(rf"\b{name}\b", text) and re.search(rf"\b({'|'.join(own)})\b", text) for text in TESTS
    )
    assert name in NO_CHOICE or tested, f"{module}.{name} is in no test"
