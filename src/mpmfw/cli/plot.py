"""``mpmfw plot``: figures of a results' file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mpmfw.cli.arguments import OutputOption
from mpmfw.cli.errors import check_writable
from mpmfw.errors import SceneError


def plot(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="File of a run or a comparison.", show_default=False)
    ],
    output: OutputOption = None,
) -> None:
    """Draw the figures of FILE, by default to a PNG of the same name."""
    if not file.is_file():
        raise SceneError(f"{file}: no such file")
    path = check_writable(file.with_suffix(".png") if output is None else output)

    from mpmfw.plots import plot_file

    for written in plot_file(file, path):
        typer.echo(str(written))
