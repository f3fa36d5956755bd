"""The public names are listed, plug-ins import nothing else, and packages are typed."""

import ast
import importlib
import importlib.metadata
import importlib.resources
import re
from pathlib import Path

import pytest
import typer

import mpmfw
from mpmfw.cli import app
from mpmfw.cli.tables import Format
from mpmfw.effects.constraint import FIELDS
from mpmfw.plugin.discovery import available
from mpmfw.scene import json_schema, shipped_scenes

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


#: Names that other people's scenes, scripts and plug-ins rely on, by kind.
SCENES = (
    "rolling-cylinder-slip rolling-cylinder-no-slip rolling-sphere-slip rolling-sphere-no-slip "
    "rolling-cylinder-slip-rigid rolling-cylinder-no-slip-rigid rolling-sphere-slip-rigid "
    "rolling-sphere-no-slip-rigid colliding-rings footing roller taylor-bar column-collapse"
)
COMMANDS = (
    "run compare study validate stability plot animate export explain schema plugins check resume choose "
    "rank new report view warm-up benchmark store"
)
BUNDLED: dict[str, str] = {
    "contact": "none separate bardenhagen nairn penalty hamad2017 hybrid impulse lcp barrier midplane "
    "particles adhesion tied",
    "detection": "nodes surfaces midplane points logistic",
    "shape": "linear gimp cpdi cpdi2 bspline ck cubic_bspline",
    "material": "neo_hookean linear_elastic j2 drucker_prager mohr_coulomb",
    "law": "impulse penalty lcp",
}


def test_names_that_others_rely_on_are_there():
    assert set(SCENES.split()) <= set(shipped_scenes())
    assert set(COMMANDS.split()) <= set(typer.main.get_command(app).commands)
    for kind, names in BUNDLED.items():
        assert set(names.split()) <= set(available(kind)), kind
    types = json_schema()["$defs"]
    assert {"HalfSpace", "Union", "Difference"} <= set(types)
    assert [form.value for form in Format] == ["text", "csv", "json"]
    fields = {field.name: field.dims for field in FIELDS}
    assert fields["side_reaction"] == ("side", "axis")


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
