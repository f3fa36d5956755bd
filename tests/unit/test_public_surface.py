"""The public names are listed and documented, plug-ins import nothing else, and packages are typed."""

from __future__ import annotations

import ast
import importlib
import importlib.metadata
import importlib.resources
import inspect
import pkgutil
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
KERNELS = [
    f"mpmfw.kernels.{module.name}"
    for module in pkgutil.iter_modules(importlib.import_module("mpmfw.kernels").__path__)
    if not module.name.startswith("_")
]
MODULES = (
    "mpmfw",
    "mpmfw.api",
    *(
        f"mpmfw.api.{kind}"
        for kind in ("contact", "geometry", "load", "material", "results", "shape", "types", "units")
    ),
    "mpmfw.plots",
    "mpmfw.kernels",
    *KERNELS,
    "mpmfw_testing",
    "mpmfw_testing.shape",
)
PACKAGES = ("mpmfw", "mpmfw_testing", "mpmfw_contact", "mpmfw_load", "mpmfw_shape", "mpmfw_material")
#: What a plug-in may import.
OPEN = re.compile(
    r"mpmfw\.(api|kernels|contact\.(nodes|shared_nodes|springs|surfaces))(\.(?!_)|$)|mpmfw_testing(\.|$)"
)


def public_names(module: Any) -> Iterator[tuple[str, Any]]:
    """Yield what ``__all__`` lists, else the module's own functions without an underscore."""
    own = [
        n for n, v in vars(module).items() if getattr(v, "__module__", "") == module.__name__ and n[0] != "_"
    ]
    for name in getattr(module, "__all__", own):
        value = getattr(module, name)
        yield name, inspect.unwrap(getattr(value, "py_func", value))


def functions_of(value: Any) -> Iterator[Any]:
    """Yield a function, or the public methods that a class defines itself."""
    members = vars(value).values() if inspect.isclass(value) else [value]
    yield from (each for each in members if inspect.isfunction(each) and each.__name__[0] != "_")


def raised_names(function: Any) -> set[str]:
    """Names of the errors that a function itself raises."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    calls = [
        node.exc.func
        for node in ast.walk(tree)
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call)
    ]
    return {call.id for call in calls if isinstance(call, ast.Name) and call.id.endswith("Error")}


@pytest.mark.parametrize("name", MODULES)
def test_public_names_have_docstrings_that_say_which_errors_they_raise(name: str) -> None:
    module, problems = importlib.import_module(name), []
    for label, value in public_names(module):
        if inspect.isclass(value) or inspect.isroutine(value):
            if not inspect.getdoc(value):
                problems.append(label)
            for function in functions_of(value):
                said = (inspect.getdoc(function) or "") + (inspect.getdoc(value) or "")
                problems += [f"{label}: {error}" for error in raised_names(function) if error not in said]
    assert [each for each in problems if "NotImplementedError" not in each] == []


def imports(source: str) -> Iterator[str]:
    """Yield the full name of every import, wherever it stands."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_plugins_and_templates_import_the_public_modules_alone() -> None:
    folders = [ROOT / "plugins", *ROOT.glob("docs/*-template/src")]
    sources = [source for folder in folders for source in folder.rglob("*.py")]
    foreign = {
        f"{source.relative_to(ROOT)}: {name}"
        for source in sources
        for name in imports(source.read_text(encoding="utf-8"))
        if name.split(".")[0] == "mpmfw" and not OPEN.match(name)
    }
    assert foreign == set()
    assert list(imports("if x:\n    from mpmfw.state.structs import Grid")) == ["mpmfw.state.structs.Grid"]


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_are_typed(package: str) -> None:
    assert importlib.resources.files(package).joinpath("py.typed").is_file()
    installed = [str(file) for file in importlib.metadata.files("mpmfw") or ()]
    if "mpmfw/__init__.py" in installed:  # a wheel, not an editable installation
        assert f"{package}/py.typed" in installed
