"""``mpmfw export``: a run for ParaView."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mpmfw.cli.errors import check_writable
from mpmfw.cli.progress import outputs_progress
from mpmfw.cli.result_files import BodiesOption, EveryOption, ReplaceOption, check_files
from mpmfw.errors import SceneError


def export(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="File of a run.", show_default=False)],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FOLDER",
            help="Folder to write to, or a name ending in .pvd.",
            show_default=False,
        ),
    ] = None,
    every: EveryOption = 1,
    body: BodiesOption = None,
    force: ReplaceOption = False,
) -> None:
    """Write the run in FILE for ParaView, by default to a folder named as it.

    Open …-points.pvd: material points with all their fields, as cells where the shape function has domains;
    …-surfaces.pvd: surfaces with contact force and gap; …-series.csv: the series.
    """
    check_files([file])
    target = file.with_name(f"{file.stem}-paraview") if output is None else output
    _check_target(target)

    from mpmfw.paraview import export as export_run
    from mpmfw.results import check_results

    check_results(file)
    with outputs_progress("outputs") as progress:
        written = export_run(file, target, every=every, bodies=body or None, progress=progress, force=force)
    for path in written:
        typer.echo(str(path))


def _check_target(target: Path) -> None:
    """Ask that the folder can be written to, or made."""
    if target.suffix == ".pvd":
        check_writable(target)
    elif target.is_dir():
        check_writable(target / "series.csv")
    elif target.exists():
        raise SceneError(f"{target}: is a file; give a folder, or a name that ends in .pvd")
    else:
        check_writable(target)
