"""From a TOML file of tables to a validated model, or one error that lists all problems."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

from pydantic import ValidationError

from mpmfw.scene import Source
from mpmfw.scene.base import Table
from mpmfw.scene.loading import error_of
from mpmfw.scene.problem import Problem
from mpmfw.scene.wording import problems_of

Model = TypeVar("Model", bound=Table)


def validated(model: type[Model], source: Source, checks: Callable[[Model], Iterable[Problem]]) -> Model:
    """The tables of a source; ``checks`` looks for problems between keys that are valid by themselves.

    Raises
    ------
    SceneError
        One line for each thing that is wrong: file, line, key, what was expected, the nearest valid name.
    """
    data = dict(source.mapping)
    try:
        tables = model.model_validate(data)
        problems = list(checks(tables))
    except ValidationError as error:
        problems = problems_of(error, model, data)
    if problems:
        raise error_of(problems, source, {})
    return tables
