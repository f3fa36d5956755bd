"""The tables of a study's file."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from mpmfw.scene.base import Axis, Table
from mpmfw.units import Number

#: Values of one key; what they may be is the scene's business.
Values = Annotated[list[Any], Field(min_length=1)]
#: The name of a shipped scene, a file beside the study's, or the scene itself.
SceneChoice = str | dict[str, Any]


class ErrorTable(Table):
    """Which error is measured, and against what.

    Attributes
    ----------
    quantity
        Name of a measure, see :data:`mpmfw.studies.measures.MEASURES`.
    kind
        ``closed-form``: what the scene's own closed form says; ``reference``: a file, a value, or the solution that
        ships with mpmfw for the scene; ``finest``: the finest run of the study.
    body, pair, axis
        What the quantity is of; the scene decides where they are left out.
    norm
        Of the difference of two curves or fields: ``largest`` or ``l2``; the measure decides where it is left out.
    file, column
        CSV file with a column ``time`` [s] and one of the quantity [SI]: by name, or the only other one.
    value
        The quantity itself, where it is a number.
    finest
        Labels that choose the finest run; a numeric dimension that is not named takes its finest value, one of names
        its own.
    """

    quantity: str
    kind: Literal["closed-form", "reference", "finest"] = "closed-form"
    body: str | None = None
    pair: str | None = None
    axis: Axis = "x"
    norm: Literal["largest", "l2"] | None = None
    file: str | None = None
    column: str | None = None
    value: Number | None = None
    finest: dict[str, Any] = Field(default={})


class CostTable(Table):
    """How the cost is measured.

    Attributes
    ----------
    repeats
        Runs of each combination; the median and the spread of their CPU times are the cost.
    settling
        Whether settling counts: it is the whole work of a scene that ends at rest.
    """

    repeats: Annotated[int, Field(ge=1)] = 3
    settling: bool = False


class StudyTables(Table):
    """All tables of a study.

    Attributes
    ----------
    scene, scenes
        The one scene, or several by label, which become the dimension ``scene``.
    vary
        Values by short name or dotted key, a dimension each.
    set
        Values that all runs share.
    under
        Relative error below which the cheapest combination is named.
    """

    title: str = ""
    scene: SceneChoice | None = None
    scenes: dict[str, SceneChoice] = Field(default={})
    vary: Annotated[dict[str, Values], Field(min_length=1)]
    set: dict[str, Any] = Field(default={})
    error: ErrorTable
    cost: CostTable = CostTable()
    under: Annotated[Number, Field(gt=0)] = 0.01
