"""``mpmfw report`` and ``view``: pages for the browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from mpmfw.cli import arguments as args
from mpmfw.errors import SceneError


def report(
    file: Annotated[list[Path], Argument(metavar="FILE", help="Runs, comparisons, studies or maps.")],
    output: args.Output = None,
    force: args.Replace = False,
) -> None:
    """Write an HTML page for each FILE: what differs most, pictures, tables. It opens without a network."""
    if output is not None and len(file) > 1:
        raise SceneError(f"--output {output}: takes one FILE")
    args.check_files(file)
    from mpmfw.report import write_report
    from mpmfw.results import check_results

    pages = [args.new_path(output or one.with_suffix(".html"), force) for one in file]
    for one in file:
        check_results(one)
    for one, page in zip(file, pages, strict=True):
        write_report(one, page)
        typer.echo(str(page))


def view(
    file: Annotated[Path, Argument(metavar="FILE", help="File of a run.")],
    field: args.Field = None,
    every: args.Every = 1,
    port: Annotated[int, Option(metavar="N", min=0, max=65535, help="Port; by default a free one.")] = 0,
    browser: Annotated[bool, Option(help="Open the page in the browser.")] = True,
) -> None:
    """Show the run in FILE in the browser: time, field, deformation, contact forces.

    The page is served to this computer alone, at 127.0.0.1, until Ctrl-C.
    """
    args.check_files([file])
    from mpmfw.plots.viewer import view as show
    from mpmfw.results import check_results

    check_results(file)
    show(file, field or "von_mises", every=every, port=port, open_browser=browser)
