"""Load a valid scene from a file, a shipped scene's name or a mapping; one error lists all problems."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from mpmfw.errors import SceneError
from mpmfw.geometry.base import context_of_cells
from mpmfw.scene.checks import check
from mpmfw.scene.contact_parts import latest_spelling, without_effect
from mpmfw.scene.options import NAMED, Chosen, separate_options
from mpmfw.scene.override import merge, parse_path, parse_value
from mpmfw.scene.problem import Locator, Origin, Problem, distinct, dotted
from mpmfw.scene.problem import Path as KeyPath
from mpmfw.scene.scene import Scene
from mpmfw.scene.sources import Source, check_content, code_in, plain, read_source, shipped_texts
from mpmfw.scene.specification import keys_of
from mpmfw.scene.wording import problems_of


def shipped_scenes() -> dict[str, str]:
    """TOML texts of the scenes inside the package, by name."""
    return shipped_texts("scenes")


def load_scene(
    scene: str | os.PathLike[str] | Mapping[str, Any] | Scene,
    set: Mapping[str, Any] | None = None,
    trust: bool = False,
    said: Mapping[str, str] | None = None,
) -> Scene:
    """Read and validate a scene.

    Parameters
    ----------
    scene
        A TOML file, the name of a shipped scene such as ``colliding-rings``, or nested mappings; a scene
        passes through.
    set
        Values by dotted key, which override the scene's. Text is parsed as a TOML value if possible.
    trust
        Whether a file may name plug-ins as ``module:Class``, whose code is imported. Mappings and ``set``
        always may.
    said
        What messages call a key of ``set``, by default ``--set KEY``.

    Raises
    ------
    SceneError
        One line for each problem: file, line, key, what was expected, the nearest valid name.
    """
    overrides = {k: parse_value(v) if isinstance(v, str) else v for k, v in (set or {}).items()}
    if isinstance(scene, Scene):
        return scene.with_overrides(overrides, said) if overrides else scene
    source = replace(read_source(scene, "scene", shipped_scenes()), said=said or {})
    if source.text is not None and not trust:
        refuse_code(source)
    return scene_from(source, overrides)


def refuse_code(source: Source) -> None:
    """Refuse a file that names plug-ins as ``module:Class``, a line for each."""
    problems = list(code_in(source.mapping))
    problems += [replace(p, path=(), override=str(p.path[0])) for p in code_in(source.overrides)]
    if problems:
        raise error_of(problems, source, source.overrides)


def scene_from(source: Source, overrides: Mapping[str, Any]) -> Scene:
    """Validate a source with its own and further overrides; a SceneError lists all problems."""
    overrides = {**source.overrides, **plain(overrides)}
    unreadable = list(check_content(source.mapping))
    for key, value in overrides.items():
        unreadable += [replace(found, path=(), override=key) for found in check_content(value)]
    if unreadable:
        raise error_of(unreadable, source, overrides)
    expanded, said_twice = _expanded(overrides)
    mapping, problems = merge(source.mapping, expanded)
    problems += said_twice
    paths = origin_of(source, overrides).overrides
    latest_spelling(mapping, (path for _, path in paths))
    chosen = separate_options(mapping)
    problems += chosen.problems + without_effect(paths, mapping.get("contact"))
    scene: Scene | None = None
    core, outside = _with_resolved_paths(chosen.core, source.directory, [path for _, path in paths])
    if outside:  # before the models are made, which read the files
        raise error_of(problems + outside, source, overrides)
    try:
        scene = Scene.model_validate(core, context=context_of_cells(core))
        problems += map(chosen.placed, check(scene, chosen.plugins, chosen.options))
    except ValidationError as error:
        problems += map(chosen.placed, problems_of(error, Scene, chosen.core))
    if problems or scene is None:
        raise error_of(problems, source, overrides)
    scene = _with_options(scene, chosen)
    scene._source, scene._read = replace(source, overrides=overrides), scene_from
    scene._mapping = chosen.whole
    return scene


def _expanded(overrides: Mapping[str, Any]) -> tuple[dict[str, Any], list[Problem]]:
    """Expand methods with options into the keys that they set; return duplicates as problems."""
    found: dict[str, Any] = {}
    problems = []
    for key, value in overrides.items():
        try:
            keys = {dotted(path): given for path, given in keys_of(key, value).items()}
        except SceneError as error:
            problems.append(Problem((), str(error), override=key))
            continue
        others = [other for other in overrides if other != key]
        twice = [other for other in others if any(f"{one}.".startswith(f"{other}.") for one in keys)]
        message = f"{key} = '{value}' sets it too; leave one of them out"
        problems += [Problem((), message, override=other) for other in twice]
        found |= keys or {key: value}
    return found, problems


def _with_resolved_paths(
    core: dict[str, Any], directory: Path | None, set_paths: list[KeyPath]
) -> tuple[dict[str, Any], list[Problem]]:
    """Return the tables with mesh files' paths from the scene's folder, and problems of those elsewhere.

    A file that is not trusted may name files in its own folder and in the working folder alone.
    """
    bodies = core.get("bodies")
    if directory is None or not isinstance(bodies, dict):
        return core, []
    folders, resolved, problems = (directory.resolve(), Path.cwd()), dict(bodies), []
    for name, body in bodies.items():
        geometry = body.get("geometry") if isinstance(body, dict) else None
        if not isinstance(geometry, dict) or not isinstance(geometry.get("path"), str):
            continue
        path, at = directory / geometry["path"], ("bodies", name, "geometry", "path")
        resolved[name] = {**body, "geometry": {**geometry, "path": str(path)}}
        is_set = any(at[: len(target)] == target for target in set_paths)
        if not is_set and not any(path.resolve().is_relative_to(folder) for folder in folders):
            message = (
                f"the file is neither in the scene's folder, {folders[0]}, nor in the working folder; "
                f"expected it there, or give it on the command line: --set {dotted(at)}=FILE"
            )
            problems.append(Problem(at, message))
    return {**core, "bodies": resolved}, problems


def _with_options(scene: Scene, chosen: Chosen) -> Scene:
    options = chosen.options
    shape = scene.shape.model_copy(update={"options": options.get(("shape", scene.shape.method))})
    contact = scene.contact
    if contact is not None:
        own = options.get(("contact", contact.method))
        tables = chosen.contact_tables or (contact.method,)
        friction = options.get(("contact", contact.friction_law or ""))
        if contact.friction_law is not None:
            tables = (*tables, contact.friction_law)
        update: dict[str, Any] = {"options": own, "friction_options": friction, "tables": tables}
        update["pairs"] = tuple(
            pair.model_copy(update={"options": options.get(("contact", "pairs", key, str(pair.method)))})
            for key, pair in zip(chosen.pairs, contact.pairs, strict=True)
        )
        contact = contact.model_copy(update=update)
    named: dict[str, dict[str, Any]] = {}
    for group in NAMED:
        for name, table in getattr(scene, group).items():
            given = {"options": options.get((group, name))}
            named.setdefault(group, {})[name] = table.model_copy(update=given)
    return scene.model_copy(update={"shape": shape, "contact": contact, **named})


def origin_of(source: Source, overrides: Mapping[str, Any]) -> Origin:
    """Return where the keys of a scene were written."""
    targets: list[tuple[str, KeyPath]] = []
    for key, value in overrides.items():
        try:
            targets += [(key, path) for path in keys_of(key, value) or [parse_path(key)]]
        except (ValueError, SceneError):
            continue  # it is a problem of its own
    locator = Locator(source.text) if source.text is not None else None
    return Origin(source.name, locator, targets, source.said)


def error_of(problems: Iterable[Problem], source: Source, overrides: Mapping[str, Any]) -> SceneError:
    """Return the error that lists the problems of a file and of its overrides, in the order of its lines."""
    origin = origin_of(source, overrides)
    ordered = sorted(distinct(problems), key=origin.line_number)
    return SceneError(problems=[origin.located(problem) for problem in ordered])


def located(error: SceneError, scene: Scene) -> SceneError:
    """Return an error of a simulation's build with the file and line of its key, if it has one."""
    problem, *others = error.problems
    if others or problem.source or not problem.key:
        return error
    try:
        path = parse_path(problem.key)
    except ValueError:
        return error
    origin = origin_of(scene.source, scene.source.overrides)
    return SceneError(problems=[origin.located(Problem(path, problem.message))])
