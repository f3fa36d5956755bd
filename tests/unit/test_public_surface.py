"""Every public name is documented, plug-ins need no other, and its types reach whoever installs mpmfw."""

from __future__ import annotations

import ast
import dataclasses
import importlib
import importlib.metadata
import importlib.resources
import inspect
import pkgutil
import pydoc
import re
import textwrap
from pathlib import Path
from typing import Any, NamedTuple

import pytest

import mpmfw
import mpmfw.api
from plugin_imports import foreign_imports

ROOT = Path(__file__).resolve().parents[2]
KERNELS = (
    "mpmfw.kernels",
    *(
        f"mpmfw.kernels.{module.name}"
        for module in pkgutil.iter_modules(importlib.import_module("mpmfw.kernels").__path__)
        if not module.name.startswith("_")
    ),
)
MODULES = ("mpmfw", "mpmfw.api", "mpmfw.plots", *KERNELS, "mpmfw_testing", "mpmfw_testing.shape")
PACKAGES = ("mpmfw", "mpmfw_contact", "mpmfw_load", "mpmfw_shape", "mpmfw_material")

PLUGIN_SOURCES = sorted(
    source
    for folder in (ROOT / "plugins", *ROOT.glob("docs/*-template/src"))
    for source in folder.rglob("*.py")
)

#: Objects of mpmfw and of Python whose type says what they are, wherever they are a parameter.
SPEAKING = {"Body", "Field", "Grid", "Pair", "Particles", "Setup", "State", "Stencil", "Surface"}

#: ``[kg/m^3]``, but neither ``[H17]`` nor ``h[, h]``.
UNIT = re.compile(r"\[(?:1/)?(?:m|s|Pa|N|J|kg|rad)(?![A-Za-z])[^\]]*\]")

#: Fields that are numbers without a unit; then lengths that are told by h and x_s, whose unit others have.
WITHOUT_UNIT = {"friction", "mu", "deformation_gradient", "safety", "flip", "weight", "axes"}


class Name(NamedTuple):
    """A public name and what it stands for."""

    module: str
    name: str
    value: Any


def plain(value: Any) -> Any:
    """A function without numba's wrapping."""
    return inspect.unwrap(getattr(value, "py_func", value))


def names_of(module: Any) -> list[str]:
    """What ``__all__`` lists; without one the functions of the module's own that have no underscore."""
    own = [
        name
        for name, value in vars(module).items()
        if not name.startswith("_") and getattr(plain(value), "__module__", None) == module.__name__
    ]
    return list(getattr(module, "__all__", own))


def public(*modules: str) -> list[Any]:
    """The public names of some modules, numba's wrapping taken off."""
    found = []
    for module in map(importlib.import_module, modules):
        for name in names_of(module):
            subject = Name(module.__name__, name, plain(getattr(module, name)))
            found.append(pytest.param(subject, id=f"{module.__name__}.{name}"))
    return found


def is_documented_object(value: Any) -> bool:
    """Classes, functions and modules carry a docstring; values are described by their module's."""
    return inspect.isclass(value) or inspect.isroutine(value) or inspect.ismodule(value)


def doc(value: Any) -> str:
    """The docstring that somebody wrote; dataclasses and named tuples get one from Python otherwise."""
    text = inspect.getdoc(value) or ""
    return "" if text.startswith(f"{getattr(value, '__name__', None)}(") else text


def names_in(text: str) -> set[str]:
    return set(re.findall(r"\w+", text))


def arguments_of_kernels() -> set[str]:
    """The first column of the table in the docstring of ``mpmfw.kernels``."""
    text = importlib.import_module("mpmfw.kernels").__doc__ or ""
    rows = [line[:28] for line in text.splitlines() if line.startswith("``")]
    return set(re.findall(r"``(\w+)``", " ".join(rows)))


def functions_of(value: Any) -> list[tuple[str, Any]]:
    """A function, or the public methods and properties that a class of mpmfw defines itself."""
    if inspect.isroutine(value):
        return [(value.__name__, value)]
    if not inspect.isclass(value):
        return []
    members = {name: member for name, member in vars(value).items() if not name.startswith("_")}
    plain = {
        name: getattr(member, "fget", None)
        or getattr(member, "func", None)
        or getattr(member, "__func__", member)
        for name, member in members.items()
    }
    return [
        (f"{value.__name__}.{name}", member) for name, member in plain.items() if inspect.isfunction(member)
    ]


def undescribed(function: Any, known: set[str]) -> list[str]:
    """Parameters whose meaning neither the docstring, nor one that it refers to, nor their type says."""
    text = doc(function)
    named = [function.__globals__.get(name) for name in re.findall(r":func:`(\w+)`", text)]
    described = names_in(" ".join([text, *map(doc, named)])) | known
    return [
        p.name
        for p in inspect.signature(function).parameters.values()
        if p.name not in ("self", "cls", "_typing")
        and p.name not in described
        and str(p.annotation) not in SPEAKING
    ]


def raised_names(function: Any) -> set[str]:
    """Errors that the function itself raises, by name."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    raised = [node.exc for node in ast.walk(tree) if isinstance(node, ast.Raise)]
    calls = [error.func for error in raised if isinstance(error, ast.Call)]
    return {call.id for call in calls if isinstance(call, ast.Name) and call.id.endswith(("Error", "Grid"))}


@pytest.mark.parametrize("subject", public(*MODULES))
def test_every_public_name_has_a_docstring(subject):
    if is_documented_object(subject.value):
        assert doc(subject.value)
    else:
        assert subject.name in names_in(importlib.import_module(subject.module).__doc__ or "")


def test_what_is_promised_of_the_library_is_all_of_it():
    page = (ROOT / "docs/guide/versions.md").read_text(encoding="utf-8")
    (row,) = [line for line in page.splitlines() if line.startswith("| `mpmfw`: ")]
    assert sorted(re.findall(r"`mpmfw\.(\w+)`", row)) == sorted(mpmfw.__all__)


@pytest.mark.parametrize("subject", public(*MODULES))
def test_every_parameter_and_error_of_a_public_function_is_described(subject):
    in_kernels = subject.module in KERNELS
    known = arguments_of_kernels() if in_kernels else names_in(doc(subject.value))
    for label, function in functions_of(subject.value):
        assert doc(function), f"{label} has no docstring"
        assert undescribed(function, known) == [], f"{label}: what are these?"
        assert raised_names(function) - names_in(doc(function)) - {"NotImplementedError"} == set(), label


def field_comments(cls: type) -> dict[str, str]:
    """The line of each field of a class, with the comment on it."""
    return {
        line.split(":")[0].strip(): line
        for line in inspect.getsource(cls).splitlines()
        if re.match(r" {4}\w+:", line)
    }


@pytest.mark.parametrize("subject", public("mpmfw.api", "mpmfw_testing"))
def test_every_field_of_a_public_class_is_described_and_arrays_have_a_shape(subject):
    value = subject.value
    fields = [f.name for f in dataclasses.fields(value)] if dataclasses.is_dataclass(value) else []
    fields += list(getattr(value, "_fields", ()))
    for field in fields:
        line = field_comments(value)[field]
        annotation = line.split(":", 1)[1].split("#")[0].split("=")[0].strip()
        assert "#:" in line or field in names_in(doc(value)) or annotation in SPEAKING, (
            f"{subject.name}.{field}"
        )
        if annotation in ("FloatArray", "IntArray", "IndexArray"):
            assert re.search(r"#: .*\(\w+[^)]*,[^)]*\)", line), f"{subject.name}.{field}: shape?"


@pytest.mark.parametrize("subject", public("mpmfw.api"))
def test_arrays_of_public_functions_have_a_shape(subject):
    for label, function in functions_of(subject.value):
        arrays = [str(a) for a in inspect.get_annotations(function).values()]
        if any("FloatArray" in a for a in arrays):
            assert re.search(r"\(\w+,[^)]*\)", doc(function)), f"{label}: shape?"


@pytest.mark.parametrize("subject", public("mpmfw.api"))
def test_quantities_of_the_public_surface_have_a_unit(subject):
    value = subject.value
    lines = field_comments(value) if dataclasses.is_dataclass(value) else {}
    for field, line in lines.items():
        if re.search(r"\bfloat\b|FloatArray", line.split("#")[0]) and field not in WITHOUT_UNIT:
            assert UNIT.search(line), f"{subject.name}.{field}: unit?"
    for label, function in functions_of(value):
        exempt = label.rpartition(".")[2] in WITHOUT_UNIT
        if re.search(r"\bfloat\b|FloatArray", str(inspect.get_annotations(function))) and not exempt:
            assert UNIT.search(doc(function)), f"{label}: unit?"


def test_the_table_of_arguments_names_no_argument_that_no_kernel_has():
    kernels = [subject.values[0].value for subject in public(*KERNELS)]
    used = {name for one in kernels if inspect.isfunction(one) for name in inspect.signature(one).parameters}
    assert arguments_of_kernels() - used == set()


def left_out(given: int, missing: int) -> None:
    """Take what is ``given``."""
    if missing:
        raise ValueError(given)


def test_what_a_docstring_leaves_out_is_found():
    assert undescribed(left_out, set()) == ["missing"]
    assert raised_names(left_out) == {"ValueError"}
    assert doc(dataclasses.make_dataclass("Bare", ["x"])) == ""


@pytest.mark.parametrize("source", PLUGIN_SOURCES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_plugins_reach_for_nothing_but_the_public_modules(source):
    assert foreign_imports(source.read_text(encoding="utf-8")) == []


def test_the_bundled_plugins_and_both_templates_are_looked_at():
    tops = {source.relative_to(ROOT).parts[:2] for source in PLUGIN_SOURCES}
    bundled = {("plugins", package) for package in PACKAGES[1:]}
    assert {("docs", "plugin-template"), ("docs", "shape-template")} | bundled == tops


@pytest.mark.parametrize("package", PACKAGES)
def test_every_package_says_that_it_is_typed(package):
    assert importlib.resources.files(package).joinpath("py.typed").is_file()
    installed = [str(file) for file in importlib.metadata.files("mpmfw") or ()]
    if "mpmfw/__init__.py" in installed:  # a wheel, not an editable installation
        assert f"{package}/py.typed" in installed


@pytest.mark.parametrize(
    "name", [each for each in mpmfw.api.__all__ if inspect.isclass(getattr(mpmfw.api, each))]
)
def test_help_names_every_attribute_of_a_class(name: str) -> None:
    own = getattr(mpmfw.api, name)
    annotated = {
        attribute
        for base in own.__mro__
        if base.__module__.startswith("mpmfw")
        for attribute in vars(base).get("__annotations__", {})
        if not attribute.startswith("_")
    }
    shown = pydoc.render_doc(own, renderer=pydoc.plaintext)
    assert [attribute for attribute in sorted(annotated) if not re.search(rf"\b{attribute}\b", shown)] == []
