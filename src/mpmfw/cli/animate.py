"""``mpmfw animate``: a field as a moving picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mpmfw.cli.arguments import OutputOption
from mpmfw.cli.errors import check_writable
from mpmfw.cli.progress import outputs_progress
from mpmfw.cli.result_files import (
    ArrowsOption,
    BodiesOption,
    EveryOption,
    FieldOption,
    LimitsOption,
    ReplaceOption,
    check_files,
    limits_of,
)


def animate(
    file: Annotated[list[Path], typer.Argument(metavar="FILE", help="Files of runs.", show_default=False)],
    output: OutputOption = None,
    field: FieldOption = None,
    fps: Annotated[int, typer.Option(metavar="N", min=1, help="Frames a second.")] = 20,
    every: EveryOption = 1,
    body: BodiesOption = None,
    limits: LimitsOption = None,
    arrows: ArrowsOption = False,
    force: ReplaceOption = False,
) -> None:
    """Write a moving picture of a field (default von_mises) of the run in FILE, a frame for each output.

    Several FILEs stand side by side, at the times of the first. The ending of the output, .gif or .mp4, chooses
    the format; .mp4 needs ffmpeg. By default a .gif named as the first FILE.
    """
    from mpmfw.results.replacing import check_new

    check_files(file)
    path = check_writable(file[0].with_suffix(".gif") if output is None else output)
    check_new(path, force)
    scale = limits_of(limits)

    from mpmfw.plots.animation import animate as animate_runs
    from mpmfw.plots.animation import check_movie
    from mpmfw.results import check_results

    check_movie(path)
    for one in file:
        check_results(one)
    with outputs_progress("frames") as progress:
        animate_runs(
            file if len(file) > 1 else file[0],
            path,
            field or "von_mises",
            fps=fps,
            every=every,
            bodies=body or None,
            limits=scale,
            arrows=arrows,
            progress=progress,
        )
    typer.echo(str(path))
