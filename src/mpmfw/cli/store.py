"""``mpmfw store``: the folders of finished runs that campaigns take from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mpmfw.errors import SceneError


def prune(
    folders: Annotated[list[Path], typer.Argument(metavar="FOLDER", help="Folders such as FILE.nc.runs.")],
    days: Annotated[
        float | None,
        typer.Option(metavar="N", min=0.0, help="Forget runs that are older as well."),
    ] = None,
) -> None:
    """Forget runs that no campaign of today would take: those of other code, or of other versions of the
    libraries.

    What a process left that was killed while it wrote goes as well. Files that no campaign wrote stay as they
    are, and so do results files such as FILE.nc.
    """
    from mpmfw.campaigns.store import Store
    from mpmfw.runs.identity import is_current

    for folder in folders:
        if not folder.is_dir():
            raise SceneError(f"{folder}: no such folder; expected one of finished runs, such as FILE.nc.runs")
    for folder in folders:
        forgotten, kept, freed = Store(folder).prune(is_current, days)
        typer.echo(f"{folder}: {forgotten} runs forgotten, {1e-6 * freed:.3g} MB free, {kept} runs kept")
