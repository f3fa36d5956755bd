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
        list[Path],
        typer.Argument(metavar="FILE", help="File of a run or a comparison.", show_default=False),
    ],
    output: OutputOption = None,
) -> None:
    """Draw the figures of FILE, by default to PNG files named as it.

    Several FILEs, comparisons of a rolling cylinder with slip and without, make one figure, a row each.
    """
    for k, one in enumerate(file):
        if one.is_dir():
            raise SceneError(f"{one}: is a folder; give the name of a file")
        if one.resolve() in [other.resolve() for other in file[:k]]:
            raise SceneError(f"{one}: given twice")
        if not one.is_file():
            raise SceneError(f"{one}: no such file")
    if output is not None and output.suffix not in ("", ".png"):
        raise SceneError(f"{output}: figures are PNG files; give a name that ends in .png")
    default = file[0].with_suffix(".png") if len(file) == 1 else file[0].with_name("motion.png")
    path = check_writable(default if output is None else output)

    from mpmfw.plots import plot_file, plot_files
    from mpmfw.results import check_results

    for one in file:
        check_results(one)
    for written in plot_file(file[0], path) if len(file) == 1 else [plot_files(file, path)]:
        typer.echo(str(written))
