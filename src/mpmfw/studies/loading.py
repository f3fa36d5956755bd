"""Tables of a study, read from a file, a shipped study's name or a mapping; one error lists all problems."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, ValidationError

from mpmfw.campaigns.grid import given_twice
from mpmfw.campaigns.judging import ErrorTable
from mpmfw.campaigns.keys import SHORT, full_key, written_alike
from mpmfw.campaigns.measures import measure_of
from mpmfw.errors import SceneError
from mpmfw.scene import Scene, Source
from mpmfw.scene.base import Table
from mpmfw.scene.loading import error_of, refuse_code
from mpmfw.scene.override import parse_path
from mpmfw.scene.problem import Path as KeyPath
from mpmfw.scene.problem import Problem
from mpmfw.scene.sources import read_source, shipped_texts
from mpmfw.scene.wording import problems_of, unknown_key
from mpmfw.units import Number

#: Values of one key; what they may be is the scene's business.
Values = Annotated[list[Any], Field(min_length=1)]
#: The name of a shipped scene, a file beside the study's, or the scene itself.
SceneChoice = str | dict[str, Any]


class CostTable(Table):
    """Measurement of the cost."""

    repeats: Annotated[int, Field(ge=1)] = 1  #: runs of each combination; the least CPU time is the cost
    settling: bool = False  #: whether settling counts, the whole work of a scene that ends at rest


class StudyTables(Table):
    """All tables of a study."""

    title: str = ""
    scene: SceneChoice | None = None
    scenes: dict[str, SceneChoice] = Field(default={})  #: several by label, the dimension ``scene``
    #: values by short name or dotted key, a dimension each
    vary: Annotated[dict[str, Values], Field(min_length=1)]
    code: list[str] = Field(default=[])  #: other codes, whose runs stand beside those of ``vary.contact``
    set: dict[str, Any] = Field(default={})  #: values that all runs share
    error: ErrorTable
    cost: CostTable = CostTable()
    under: Annotated[Number, Field(gt=0)] = 0.01  #: relative error below which the cheapest is named


@dataclass(frozen=True)
class Study:
    """A valid study and where it came from."""

    tables: StudyTables
    source: Source
    trust: bool = False  #: whether the files of its scenes may name ``module:Class``

    @property
    def name(self) -> str:
        """The file's name without its ending, or ``study``."""
        return Path(self.source.name).stem if self.source.name else "study"

    @property
    def scenes(self) -> dict[str, Any]:
        """Scenes by label, files as paths from here."""
        chosen: dict[str, Any] = {**self.tables.scenes} or {"": self.tables.scene}
        return {label: self.beside(scene) for label, scene in chosen.items()}

    def beside(self, name: Any) -> Any:
        """Return a file's path from the study's folder."""
        folder = self.source.directory
        if isinstance(name, str) and folder is not None and (folder / name).is_file():
            return os.fspath(folder / name)
        return name

    def at(self, path: KeyPath, message: str) -> SceneError:
        """An error about the key at ``path``, with its file and line."""
        return error_of([Problem(path, message)], self.source, {})


def shipped_studies() -> dict[str, str]:
    """TOML texts of the studies inside the package, by name."""
    return shipped_texts("studies")


def load_study(study: str | os.PathLike[str] | Mapping[str, Any] | Study, trust: bool = False) -> Study:
    """Read a study: a TOML file, a shipped one's name, or mappings; a SceneError lists all problems."""
    if isinstance(study, Study):
        return study
    source = read_source(study, "study", shipped_studies())
    if source.text is not None and not trust:
        refuse_code(source)
    data = dict(source.mapping)
    try:
        tables = StudyTables.model_validate(data)
        problems = list(_checks(tables))
    except ValidationError as error:
        problems = problems_of(error, StudyTables, data)
    if problems:
        raise error_of(problems, source, {})
    return Study(tables, source, trust)


def _checks(tables: StudyTables) -> Iterator[Problem]:
    if tables.scene is None and not tables.scenes:
        yield Problem(("scene",), "missing; expected the name of a shipped scene or of a file", "missing")
    if tables.scene is not None and tables.scenes:
        yield Problem(("scene",), "has no effect beside the table scenes; leave one of them out")
    for table in ("vary", "set"):
        for key in getattr(tables, table):
            yield from _key((table, key))
    taken: dict[str, str] = {}
    for key in tables.vary:
        if taken.setdefault(full_key(key), key) != key:
            message = f"sets the same key of the scene as {taken[full_key(key)]}; leave one of them out"
            yield Problem(("vary", key), message)
    for key in tables.set:
        if full_key(key) in taken:
            message = f"vary {taken[full_key(key)]} replaces it; leave one of them out"
            yield Problem(("set", key), message)
    for key, given in tables.vary.items():
        values = written_alike(key, given)
        for k in given_twice(values):
            yield Problem(("vary", key, k), f"{values[k]} is given twice")
    yield from _error(tables)


def _key(path: tuple[str, str]) -> Iterator[Problem]:
    key = path[1]
    try:
        first = parse_path(key)[0]
    except ValueError as error:
        yield Problem(path, str(error))
        return
    tables = [*Scene.model_fields]
    if key not in SHORT and first not in tables:
        alone = not re.search(r"[.\[]", key)
        yield unknown_key(path, [*SHORT, *tables] if alone else tables)


def _error(tables: StudyTables) -> Iterator[Problem]:
    error = tables.error
    try:
        measure = measure_of(error.quantity)
    except SceneError as problem:
        yield Problem(("error", "quantity"), str(problem))
        return
    kinds = {"file": "reference", "column": "reference", "value": "reference", "finest": "finest"}
    for key, kind in kinds.items():
        if getattr(error, key) not in (None, {}) and error.kind != kind:
            yield Problem(("error", key), f"has no effect; expected only with kind = '{kind}'")
    named, kind = error.quantity, measure.kind
    unvaried = [key for key in error.finest if key not in tables.vary]
    refused: tuple[tuple[bool, KeyPath, str], ...] = (
        (error.value is not None and kind != "number", ("value",), f"{named} is a {kind}; give a file"),
        (error.file is not None and kind != "curve", ("file",), f"{named} is a {kind}, not a curve in time"),
        (error.column is not None and error.file is None, ("column",), "has no effect without file"),
        (error.kind == "finest" and kind == "field", ("kind",), "other runs have the field at other points"),
        (error.norm is not None and kind == "number", ("norm",), f"has no effect: {named} is a number"),
        (
            bool(unvaried),
            ("finest", *unvaried[:1]),
            f"is not varied; expected one of {', '.join(tables.vary)}",
        ),
    )
    yield from (Problem(("error", *path), text) for holds, path, text in refused if holds)
