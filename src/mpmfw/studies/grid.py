"""The grid of a study, and which of its keys is to blame where it cannot run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mpmfw.campaigns.grid import RunGrid
from mpmfw.campaigns.grid import make_grid as make_points
from mpmfw.campaigns.keys import overrides_of
from mpmfw.campaigns.measures import measure_of
from mpmfw.errors import NoSuchFileError, SceneError, SceneProblem
from mpmfw.scene import Scene, load_scene
from mpmfw.studies.loading import Study


def make_grid(study: Study) -> RunGrid:
    """Expand a study.

    Raises
    ------
    SceneError
        A scene is wrong, a key is none of a scene, or a value is one that no combination can run.
    """
    scenes = {label: _base(study, label, scene) for label, scene in study.scenes.items()}
    grid = make_points(scenes, study.tables.vary, {})
    _check(study, grid)
    return grid


def _base(study: Study, label: str, chosen: Any) -> Scene:
    """A scene with what all runs share: nothing is recorded that the error does not need, unless the study
    asks for it.
    """
    tables = study.tables
    particles = measure_of(tables.error.quantity).particles
    shared = {"output.particles": particles} | dict.fromkeys(
        ["output.surface", "output.gap", "output.ledger"], False
    )
    try:
        scene = load_scene(chosen, trust=study.trust)
    except NoSuchFileError as error:
        raise study.at(("scenes", label) if label else ("scene",), str(error)) from error
    for key, value in tables.set.items():
        shared |= overrides_of(scene.bodies, scene.dim, key, value)
    try:
        return scene.with_overrides(shared)
    except SceneError as error:
        blamed = _blamed(error.problems[0], scene, tables.set)
        raise study.at(("set", blamed) if blamed else ("set",), error.problems[0].plain) from error


def _check(study: Study, grid: RunGrid) -> None:
    """Refuse a study with a value that no combination can run."""
    varied, combinations = study.tables.vary, grid.combinations
    first = next(iter(combinations.values()))
    if all(one.scene is None for one in combinations.values()):
        scene = next(iter(grid.scenes.values()))
        key = _blamed(first.problems[0], scene, {key: values[0] for key, values in varied.items()})
        raise study.at(("vary", key) if key else ("vary",), first.why)
    offset = 1 if study.tables.scenes else 0
    for depth, (key, values) in enumerate(varied.items()):
        for k in range(len(values)):
            with_it = [one for index, one in combinations.items() if index[depth + offset] == k]
            if all(one.scene is None for one in with_it):
                raise study.at(("vary", key, k), with_it[0].why)


def _blamed(problem: SceneProblem, scene: Scene, values: Mapping[str, Any]) -> str | None:
    """Return which of the study's keys set what a scene complains of; None where none did."""
    for key, value in values.items():
        if problem.override in overrides_of(scene.bodies, scene.dim, key, value):
            return key
    return None
