"""Nothing is silently ignored: every option changes a result somewhere, and is refused where it could not.

The options are found in the models themselves: one without an entry in ``options_table`` fails here.
"""

from __future__ import annotations

from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest

from mpmfw.plugin import discovery
from mpmfw.plugin.discovery import Kind, available, load
from options_found import NO_OPTIONS, option_models, outcome
from options_table import ASKED_BY_THE_KIT, CORE, PLUGINS, REFUSED, Acts, mesh_file, pair, surface_mesh
from scenes_for_tests import with_changes

SURFACE_MESH = ("path", "unit", "angles", "shift")

OWN = {
    "mpmfw.boundary": ("shaken", "faulty_plugins.small.other_kinds:Shaken"),
    "mpmfw.output": ("fastest", "faulty_plugins.small.other_kinds:Fastest"),
}

pytestmark = pytest.mark.effects


@pytest.fixture(autouse=True)
def announced(monkeypatch: pytest.MonkeyPatch) -> None:
    """Announce a boundary condition and an output, since no bundled plug-in is one."""
    known = discovery.entry_points

    def found(**select: str) -> list[EntryPoint]:
        group = select.get("group", "")
        own = [EntryPoint(*OWN[group], group)] if group in OWN else []
        return [*known(**select), *own]

    monkeypatch.setattr(discovery, "entry_points", found)


def test_no_option_is_forgotten() -> None:
    found = {
        f"{table}.{option}"
        for table, model in option_models().items()
        if not table.startswith(ASKED_BY_THE_KIT)
        for option in model.model_fields
    }
    found = {option for option in found if option.rpartition(".")[2] not in NO_OPTIONS}
    assert found == set(CORE) | set(PLUGINS) | {
        "MeshFile.path",
        *(f"SurfaceMesh.{key}" for key in SURFACE_MESH),
    }


@pytest.mark.parametrize("kind", ["detection", "law"])
def test_options_of_detections_and_laws_are_those_of_contacts(kind: Kind) -> None:
    of_contacts = [
        model.model_fields for table, model in option_models().items() if table.startswith("contact.")
    ]
    for name in available(kind):
        options = getattr(load(kind, name), "Options", None)
        for option in () if options is None else options.model_fields:
            assert any(option in fields for fields in of_contacts), f"{kind}.{name}.{option}"


def check_acts(entry: Acts) -> None:
    first, second = (outcome(with_changes(entry.scene, **changes)) for changes in (entry.first, entry.second))
    assert first != second
    assert not (first.startswith("refused") and second.startswith("refused")), (first, second)


@pytest.mark.parametrize("option", CORE)
def test_an_option_of_a_table_changes_the_result(option: str) -> None:
    check_acts(CORE[option])


@pytest.mark.parametrize("option", PLUGINS)
def test_an_option_of_a_plugin_changes_the_result(option: str) -> None:
    check_acts(PLUGINS[option])


@pytest.mark.parametrize(
    ("method", "tables"),
    [
        ("bardenhagen", [{"criterion": word} for word in ("velocity", "position")]),
        (
            "bardenhagen",
            [
                {"normal": "averaged"},
                {"normal": "master"},
                {"normal": "specified", "direction": [0.8, 0.6]},
            ],
        ),
        ("penalty", [{"map": word} for word in ("plain", "mass_weighted")]),
    ],
    ids=["criterion", "normal", "map"],
)
def test_every_word_of_a_contact_s_option_has_its_own_result(method: str, tables: list[Any]) -> None:
    """The kit is content with two words that differ."""
    found = [outcome(with_changes(pair(method), **{f"contact__{method}": table})) for table in tables]
    assert not any(each.startswith("refused") for each in found), found
    assert len(set(found)) == len(tables)


def test_the_path_of_a_mesh_changes_the_result(tmp_path: Path) -> None:
    check_acts(mesh_file(tmp_path))


@pytest.mark.parametrize("key", SURFACE_MESH)
def test_a_key_of_a_surface_mesh_changes_the_result(tmp_path: Path, key: str) -> None:
    check_acts(surface_mesh(tmp_path, key))


def test_the_same_scene_has_the_same_outcome() -> None:
    entry = CORE["Contact.method"]
    assert outcome(entry.scene) == outcome(entry.scene)


@pytest.mark.parametrize("name", REFUSED)
def test_an_option_without_effect_is_refused(name: str) -> None:
    scene, changes, word = REFUSED[name]
    assert not outcome(scene).startswith("refused")
    said = outcome(with_changes(scene, **changes))
    assert said.startswith("refused")
    assert word in said
