"""The tables of a study's file."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from mpmfw.campaigns.judging import ErrorTable
from mpmfw.scene.base import Table
from mpmfw.units import Number

#: Values of one key; what they may be is the scene's business.
Values = Annotated[list[Any], Field(min_length=1)]
#: The name of a shipped scene, a file beside the study's, or the scene itself.
SceneChoice = str | dict[str, Any]


class CostTable(Table):
    """How the cost is measured.

    Attributes
    ----------
    repeats
        Runs of each combination; the least of their CPU times is the cost.
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
