"""Files of results as arguments, and progress over their outputs."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, TypeAlias

import typer

from mpmfw.errors import SceneError

BodiesOption: TypeAlias = Annotated[
    list[str] | None,
    typer.Option("--body", metavar="NAME", help="Only this body; repeatable.", show_default=False),
]
EveryOption: TypeAlias = Annotated[
    int, typer.Option("--every", metavar="N", min=1, help="Only each N-th output.")
]
FieldOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--field",
        metavar="NAME",
        help="Field on the material points: von_mises, velocity, stress_xy … A wrong name lists all.",
        show_default=False,
    ),
]
LimitsOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--limits", metavar="LOW,HIGH", help="Ends of the colour scale, in SI units.", show_default=False
    ),
]
ReplaceOption: TypeAlias = Annotated[bool, typer.Option("--force", help="Replace files that exist.")]
ArrowsOption: TypeAlias = Annotated[
    bool, typer.Option("--arrows", help="Draw contact forces on surface nodes as arrows.")
]


def check_files(files: Sequence[Path]) -> None:
    """Ask that every argument is a file, and that none is given twice.

    Raises
    ------
    SceneError
        One is a folder, is not there or comes twice.
    """
    for k, one in enumerate(files):
        if one.is_dir():
            raise SceneError(f"{one}: is a folder; give the name of a file")
        if os.path.realpath(one) in [os.path.realpath(other) for other in files[:k]]:
            raise SceneError(f"{one}: given twice")
        if not one.is_file():
            raise SceneError(f"{one}: no such file")


def limits_of(text: str | None) -> tuple[float, float] | None:
    """``LOW,HIGH`` as numbers.

    Raises
    ------
    SceneError
        The text is not two finite numbers, the lower one first.
    """
    if text is None:
        return None
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError as error:
        raise SceneError(f"--limits {text}: expected two numbers with a comma between them") from error
    if not (math.isfinite(low) and math.isfinite(high)):
        raise SceneError(f"--limits {text}: expected two finite numbers")
    if not low < high:
        raise SceneError(f"--limits {text}: expected the lower number first")
    return low, high
