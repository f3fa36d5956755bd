"""Nothing is silently ignored: every option changes a result somewhere, and is refused where it could not.

The options are found in the models themselves: one without an entry in ``options_table`` fails here.
"""

from __future__ import annotations

import hashlib
import warnings
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from pydantic import BaseModel

import mpmfw
from mpmfw.discovery import KINDS, available, distribution_of, load
from mpmfw.errors import SceneError
from mpmfw.scene.tables import Tables
from options_table import CORE, PLUGINS, REFUSED, Acts, mesh_file
from scenes_for_tests import with_changes

pytestmark = pytest.mark.effects

#: Fields that choose a model of a union (an unknown one is refused below), or hold what was validated elsewhere.
NO_OPTIONS = {"type", "options"}


def models_of(annotation: Any) -> set[type[BaseModel]]:
    """All models that an annotation names, however deep."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return {annotation}
    return set().union(*(models_of(part) for part in get_args(annotation)))


def core_options() -> set[str]:
    """``Table.field`` of all tables that can be reached from a scene."""
    found: set[str] = set()
    seen: set[type[BaseModel]] = set()
    todo: list[type[BaseModel]] = [Tables]
    while todo:
        model = todo.pop()
        if model in seen or model is BaseModel:
            continue
        seen.add(model)
        for name, field in model.model_fields.items():
            if name not in NO_OPTIONS:
                found.add(f"{model.__name__}.{name}")
            todo += models_of(field.rebuild_annotation())
    return found


def plugin_options() -> set[str]:
    """``kind.plug-in.option`` of all plug-ins of this distribution."""
    found = set()
    for kind in KINDS:
        for name, entry in available(kind).items():
            model = getattr(load(kind, name), "Options", None)
            if distribution_of(entry) == "mpmfw" and model is not None:
                found |= {f"{kind}.{name}.{option}" for option in model.model_fields}
    return found


def test_no_option_of_a_table_is_forgotten() -> None:
    assert core_options() == set(CORE) | {"MeshFile.path"}


def test_no_option_of_a_plugin_is_forgotten() -> None:
    assert plugin_options() == set(PLUGINS)


def outcome(scene: dict[str, Any]) -> str:
    """Digest of all that a run records of the motion, or the words of its refusal."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # settling that is cut short says so
            tree = mpmfw.run(scene)
    except SceneError as error:
        return f"refused: {error}"
    digest = hashlib.sha256(str(tree.attrs["title"]).encode())
    for group in tree.subtree:
        for name, variable in sorted(group.variables.items(), key=lambda item: str(item[0])):
            values = np.asarray(variable.values)
            content = values.tobytes() if values.dtype.kind in "fiub" else str(values.tolist()).encode()
            digest.update(f"{group.path}/{name}{values.shape}".encode() + content)
    return digest.hexdigest()


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


def test_the_path_of_a_mesh_changes_the_result(tmp_path: Path) -> None:
    check_acts(mesh_file(tmp_path))


def test_the_same_scene_has_the_same_outcome() -> None:
    entry = PLUGINS["contact.penalty.kappa"]
    assert outcome(entry.scene) == outcome(entry.scene)


@pytest.mark.parametrize("name", REFUSED)
def test_an_option_without_effect_is_refused(name: str) -> None:
    scene, changes, word = REFUSED[name]
    assert not outcome(scene).startswith("refused")
    said = outcome(with_changes(scene, **changes))
    assert said.startswith("refused")
    assert word in said
