"""``mpmfw run``: one scene, one file of results."""

from __future__ import annotations

from pathlib import Path

import typer

from mpmfw.cli.arguments import (
    CheckpointOption,
    ContactOption,
    ForceOption,
    OutputOption,
    SceneArgument,
    SetOption,
    ShapeOption,
    chosen_scene,
)
from mpmfw.cli.errors import check_apart, check_result
from mpmfw.cli.progress import run_progress


def run(
    scene: SceneArgument,
    contact: ContactOption = None,
    shape: ShapeOption = None,
    set_: SetOption = None,
    output: OutputOption = None,
    checkpoint: CheckpointOption = None,
    force: ForceOption = False,
) -> None:
    """Run SCENE and write its results, by default to a file named as the scene."""
    loaded = chosen_scene(scene, contact, shape, set_)
    path = Path(f"{loaded.name}.nc") if output is None else output
    check_apart(loaded, output=path)
    check_result(path, "run", "run's results", force)

    from mpmfw.runs import run_to_file

    with run_progress(loaded.time.end) as progress:
        run_to_file(loaded, output=path, progress=progress, force=force, checkpoint=checkpoint)
    typer.echo(str(path))
