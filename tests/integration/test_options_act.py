"""Nothing is silently ignored: every option, and every word of an option, changes a result somewhere, and is
refused where it could not.

The options are found in the models themselves: one without an entry in ``options_table`` fails here.
"""

import itertools
from typing import Literal, get_args, get_origin

import pytest
from pydantic import BaseModel

from mpmfw.plugin.discovery import available, load
from options_found import NO_OPTIONS, REFUSED_BY_RIGID, option_models, outcome
from options_table import (
    ASKED_BY_THE_KIT,
    CORE,
    EACH,
    PLUGINS,
    REFUSED,
    mesh_file,
    surface_mesh,
)
from scenes_for_tests import with_changes

SURFACE_MESH = ("path", "unit", "angles", "shift")

pytestmark = pytest.mark.effects


@pytest.fixture(autouse=True)
def announced(announce):
    """Announce a boundary condition and an output, since no bundled plug-in is one."""
    announce("boundary", "shaken", "faulty_plugins.small.other_kinds:Shaken")
    announce("output", "fastest", "faulty_plugins.small.other_kinds:Fastest")


def test_no_option_is_forgotten():
    found = {
        f"{table}.{option}"
        for table, model in option_models().items()
        if not table.startswith(ASKED_BY_THE_KIT)
        for option in model.model_fields
    }
    found = {option for option in found - REFUSED_BY_RIGID if option.rpartition(".")[2] not in NO_OPTIONS}
    assert found == set(CORE) | set(PLUGINS) | {
        "MeshFile.path",
        *(f"SurfaceMesh.{key}" for key in SURFACE_MESH),
    }


@pytest.mark.parametrize("kind", ["detection", "law"])
def test_options_of_detections_and_laws_are_those_of_contacts(kind):
    of_contacts = [
        model.model_fields for table, model in option_models().items() if table.startswith("contact.")
    ]
    for name in available(kind):
        options = getattr(load(kind, name), "Options", None)
        for option in () if options is None else options.model_fields:
            assert any(option in fields for fields in of_contacts), f"{kind}.{name}.{option}"


def check_acts(entry):
    first, second = (outcome(with_changes(entry.scene, **changes)) for changes in (entry.first, entry.second))
    assert first != second
    assert not (first.startswith("refused") and second.startswith("refused")), (first, second)


@pytest.mark.parametrize("option", [*CORE, *PLUGINS])
def test_an_option_changes_the_result(option):
    check_acts({**CORE, **PLUGINS}[option])


@pytest.mark.parametrize("key", [*SURFACE_MESH, "MeshFile.path"])
def test_a_key_of_a_mesh_changes_the_result(tmp_path, key):
    check_acts(surface_mesh(tmp_path, key) if key in SURFACE_MESH else mesh_file(tmp_path))


@pytest.mark.parametrize("name", REFUSED)
def test_an_option_without_effect_is_refused(name):
    scene, changes, word = REFUSED[name]
    assert not outcome(scene).startswith("refused")
    said = outcome(with_changes(scene, **changes))
    assert said.startswith("refused")
    assert word in said


def words_of(annotation):
    """Words that an annotation allows, however deep."""
    if get_origin(annotation) is Literal:
        return {word for word in get_args(annotation) if isinstance(word, str)}
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return set()
    return set().union(*(words_of(part) for part in get_args(annotation)))


WORDS = {
    f"{table}.{name}": words
    for table, model in option_models().items()
    if not table.startswith(ASKED_BY_THE_KIT)
    for name, field in model.model_fields.items()
    if name not in NO_OPTIONS and (words := words_of(field.rebuild_annotation()))
}


def tried(entry):
    """Every word that an entry of the table of two values tries."""
    return set(itertools.chain(*(words_in(value) for value in (entry.first, entry.second))))


def words_in(value):
    """Every text in nested tables."""
    if isinstance(value, str):
        return {value}
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list | tuple) else ()
    return set().union(*map(words_in, parts))


@pytest.mark.parametrize("option", WORDS)
def test_every_word_is_tried(option):
    found = set(EACH[option].changes) if option in EACH else tried({**CORE, **PLUGINS}[option])
    assert found >= WORDS[option]
    assert option in EACH or len(WORDS[option]) <= 2  # two that differ are told by the table of two values


@pytest.mark.parametrize("option", EACH)
def test_every_word_acts_as_none_other(option):
    entry = EACH[option]
    found = {word: outcome(with_changes(entry.scene, **changes)) for word, changes in entry.changes.items()}
    assert not any(one.startswith("refused") for one in found.values()), found
    if entry.auto is not None:
        assert found.pop("auto") == found[entry.auto]
    same = [pair for pair in itertools.combinations(found, 2) if found[pair[0]] == found[pair[1]]]
    assert same == []
