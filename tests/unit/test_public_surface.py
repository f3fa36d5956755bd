"""The public names are listed, plug-ins import nothing else, and packages are typed."""

import ast
import importlib
import importlib.metadata
import importlib.resources
import re
from pathlib import Path

import pytest

import mpmfw

ROOT = Path(__file__).resolve().parents[2]
PLUGINS = ("mpmfw_code", "mpmfw_contact", "mpmfw_load", "mpmfw_shape", "mpmfw_material")
PACKAGES = ("mpmfw", "mpmfw_testing", *PLUGINS)
#: What a plug-in may import.
OPEN = re.compile(
    r"mpmfw\.(api|kernels|contact\.(nodes|shared_nodes|springs|surfaces))(\.(?!_)|$)|mpmfw_testing(\.|$)"
)


def test_the_page_of_versions_lists_the_names_of_the_library():
    page = (ROOT / "docs/guide/versions.md").read_text(encoding="utf-8")
    (row,) = [line for line in page.splitlines() if line.startswith("| `mpmfw`: ")]
    assert sorted(re.findall(r"`mpmfw\.(\w+)`", row)) == sorted(mpmfw.__all__)


def imports(source):
    """Yield the full name of every import, wherever it stands."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_plugins_and_templates_import_the_public_modules_alone():
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
def test_packages_are_typed(package):
    assert importlib.resources.files(package).joinpath("py.typed").is_file()
    installed = [str(file) for file in importlib.metadata.files("mpmfw") or ()]
    if "mpmfw/__init__.py" in installed:  # a wheel, not an editable installation
        assert f"{package}/py.typed" in installed
