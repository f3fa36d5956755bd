"""``mpmfw resume``: go on with a run that was killed or interrupted."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mpmfw.cli.arguments import CheckpointOption, TrustOption
from mpmfw.cli.progress import run_progress


def resume(
    results: Annotated[
        Path,
        typer.Argument(metavar="RUN.nc", help="Results of a run that did not end.", show_default=False),
    ],
    checkpoint: CheckpointOption = None,
    threads: Annotated[
        int | None,
        typer.Option(
            "--threads", help="Threads in place of the scene's; the results are the same.", show_default=False
        ),
    ] = None,
    force: Annotated[
        bool,
        typer.Option(
            "--force", help="Go on with another version of the code or a library, to other numbers."
        ),
    ] = False,
    trust: TrustOption = False,
) -> None:
    """Go on with RUN.nc from its last checkpoint, to the end that it would have had."""
    from mpmfw.runs.run import last_checkpoint, resuming

    time, end = last_checkpoint(results, trust)
    typer.echo(f"{results}: goes on at {time:.6g} s of {end:g} s", err=True)
    with run_progress(end) as progress:
        again = resuming(
            results, progress=progress, force=force, checkpoint=checkpoint, threads=threads, trust=trust
        )
        with again:
            pass
    typer.echo(str(results))
