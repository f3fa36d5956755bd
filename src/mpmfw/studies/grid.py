"""The combinations of a study: each a scene to run, or why it cannot be run."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from mpmfw.errors import SceneError
from mpmfw.scene import Scene, load_scene
from mpmfw.scene.loading import plain
from mpmfw.scene.toml_text import value_text
from mpmfw.studies.keys import dimension_names, is_numerical, overrides_of, written_alike
from mpmfw.studies.loading import Study
from mpmfw.studies.measures import MEASURES

Index = tuple[int, ...]


@dataclass(frozen=True)
class Combination:
    """One cell of the grid.

    Attributes
    ----------
    labels
        Its place in words, by dimension.
    scene
        What runs; None if the scene refuses the combination.
    refusal
        Why it is refused, as the scene says it.
    """

    labels: Mapping[str, Any]
    scene: Scene | None
    refusal: str = ""

    @property
    def name(self) -> str:
        """``penalty, cpdi, cell_size 0.4``."""
        bare = ("scene", "contact", "shape", "scheme", "transfer")
        return (
            ", ".join(str(v) if dim in bare else f"{dim} {v}" for dim, v in self.labels.items()) or "the run"
        )

    @property
    def why(self) -> str:
        """Why it is refused, in a study's words."""
        return _own_words(self.refusal)


@dataclass(frozen=True)
class Grid:
    """All combinations.

    Attributes
    ----------
    coords
        Labels of each dimension, in order.
    keys
        Keys of the study's table ``vary`` by dimension.
    combinations
        By index into the coordinates.
    scenes
        The scenes by label, with what all runs share.
    """

    coords: Mapping[str, list[Any]]
    keys: Mapping[str, str]
    combinations: Mapping[Index, Combination]
    scenes: Mapping[str, Scene]

    @property
    def problem_dims(self) -> list[str]:
        """Dimensions that change the problem: errors and costs under their values are not compared."""
        return [dim for dim in self.coords if dim == "scene" or not is_numerical(self.keys[dim])]


def make_grid(study: Study) -> Grid:
    """Expand a study.

    Raises
    ------
    SceneError
        A scene is wrong, a key is none of a scene, or a value is one that no combination can run.
    """
    tables = study.tables
    scenes = {label: _base(study, label, scene) for label, scene in study.scenes.items()}
    names = dimension_names(tables.vary)
    coords: dict[str, list[Any]] = {"scene": list(scenes)} if tables.scenes else {}
    coords |= {names[key]: _labels(written_alike(key, values)) for key, values in tables.vary.items()}
    combinations = {}
    for index in itertools.product(*(range(len(labels)) for labels in coords.values())):
        labels = {dim: coords[dim][k] for dim, k in zip(coords, index, strict=True)}
        chosen = index[1:] if tables.scenes else index
        values = {key: vs[k] for (key, vs), k in zip(tables.vary.items(), chosen, strict=True)}
        combinations[index] = _combination(scenes[labels.get("scene", "")], labels, values)
    _check(study, combinations, next(iter(scenes.values())), offset=1 if tables.scenes else 0)
    return Grid(coords, {names[key]: key for key in tables.vary}, combinations, scenes)


def _base(study: Study, label: str, chosen: Any) -> Scene:
    """A scene with what all runs share: nothing is recorded that the error does not need, unless the study asks for it."""
    tables = study.tables
    particles = MEASURES[tables.error.quantity].particles
    shared = {"output.particles": particles} | dict.fromkeys(
        ["output.surface", "output.gap", "output.ledger"], False
    )
    try:
        scene = load_scene(chosen)
    except SceneError as error:
        if isinstance(chosen, str) and ": no such file" in str(error):
            raise study.at(("scenes", label) if label else ("scene",), str(error)) from error
        raise
    for key, value in tables.set.items():
        shared |= overrides_of(scene, key, value)
    try:
        return scene.with_overrides(shared)
    except SceneError as error:
        about, message = _said(str(error), scene, tables.set)
        raise study.at(("set", about) if about else ("set",), message) from error


def _combination(base: Scene, labels: Mapping[str, Any], values: Mapping[str, Any]) -> Combination:
    try:
        overrides: dict[str, Any] = {}
        for key, value in values.items():
            overrides |= overrides_of(base, key, value)
        return Combination(labels, base.with_overrides(overrides))
    except SceneError as error:
        return Combination(labels, None, str(error))


def _check(study: Study, combinations: Mapping[Index, Combination], scene: Scene, offset: int) -> None:
    """Refuse a study with a value that no combination can run."""
    varied = study.tables.vary
    first = next(iter(combinations.values()))
    if all(one.scene is None for one in combinations.values()):
        key, message = _said(first.refusal, scene, {key: values[0] for key, values in varied.items()})
        raise study.at(("vary", key) if key else ("vary",), message)
    for depth, (key, values) in enumerate(varied.items()):
        for k in range(len(values)):
            with_it = [one for index, one in combinations.items() if index[depth + offset] == k]
            if all(one.scene is None for one in with_it):
                raise study.at(("vary", key, k), _own_words(with_it[0].refusal))


def _said(message: str, scene: Scene, values: Mapping[str, Any]) -> tuple[str | None, str]:
    """Which of the study's keys a scene complains of, and the complaint without the scene's name for it."""
    for key, value in values.items():
        for full in overrides_of(scene, key, value):
            if message.startswith(f"--set {full}:"):
                return key, _own_words(message)
    return None, _own_words(message)


def _own_words(message: str) -> str:
    """A scene's complaint without the option that a study does not have."""
    first = message.splitlines()[0] if message.startswith("--set ") else message
    return re.sub(r"^--set \S+: ", "", first)


def _labels(values: list[Any]) -> list[Any]:
    """Values as coordinates; texts where they are not all numbers or all texts."""
    labels = [plain(value) for value in values]
    for kinds in ((bool,), (int, float), (str,)):
        if all(isinstance(v, kinds) and (kinds == (bool,) or not isinstance(v, bool)) for v in labels):
            return labels
    return [label if isinstance(label, str) else value_text(label) for label in labels]
