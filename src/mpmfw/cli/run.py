"""``mpmfw run`` and ``mpmfw resume``: one scene, one file of results."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from mpmfw.cli import arguments as args
from mpmfw.cli.paths import result_path
from mpmfw.cli.progress import run_progress


def run(
    scene: args.SceneName,
    contact: args.Contact = None,
    shape: args.Shape = None,
    set_: args.Set = None,
    trust: args.Trust = False,
    output: args.Output = None,
    checkpoint: args.Checkpoint = None,
    force: args.Force = False,
) -> None:
    """Run SCENE and write its results, by default to a file named as the scene."""
    loaded = args.chosen_scene(scene, contact, shape, set_, trust)
    path = result_path(output, loaded, "run", force)

    from mpmfw.runs.run import begun, run_on

    with (
        begun(loaded, output=path, force=force, checkpoint=checkpoint) as checkpoints,
        run_progress(loaded.time.end) as progress,
    ):
        run_on(checkpoints, progress)
    typer.echo(str(path))


def resume(
    results: Annotated[Path, Argument(metavar="RUN.nc", help="Results of a run that did not end.")],
    checkpoint: args.Checkpoint = None,
    threads: Annotated[int | None, Option(help="Threads instead of the scene's.")] = None,
    force: Annotated[
        bool, Option("--force", help="Go on with another version of the code, to other numbers.")
    ] = False,
    trust: args.Trust = False,
) -> None:
    """Go on with RUN.nc from its last checkpoint, to the end that it would have had."""
    from mpmfw.runs.run import resumed, run_on

    with resumed(results, None, None, force, checkpoint, threads, trust) as checkpoints:
        simulation = checkpoints.simulation
        end = simulation.scene.time.end
        typer.echo(f"{results}: goes on at {simulation.state.time:.6g} s of {end:g} s", err=True)
        with run_progress(end) as progress:
            run_on(checkpoints, progress)
    typer.echo(str(results))
