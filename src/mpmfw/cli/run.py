"""``mpmfw run``: one scene, one file of results."""

from __future__ import annotations

import typer

from mpmfw.cli.arguments import (
    CheckpointOption,
    ContactOption,
    ForceOption,
    OutputOption,
    SceneArgument,
    SetOption,
    ShapeOption,
    TrustOption,
    chosen_scene,
)
from mpmfw.cli.errors import result_path
from mpmfw.cli.progress import run_progress


def run(
    scene: SceneArgument,
    contact: ContactOption = None,
    shape: ShapeOption = None,
    set_: SetOption = None,
    trust: TrustOption = False,
    output: OutputOption = None,
    checkpoint: CheckpointOption = None,
    force: ForceOption = False,
) -> None:
    """Run SCENE and write its results, by default to a file named as the scene."""
    loaded = chosen_scene(scene, contact, shape, set_, trust)
    path = result_path(output, loaded, "", "run", "run's results", force)

    from mpmfw.runs.run import run_to_file

    with run_progress(loaded.time.end) as progress:
        run_to_file(loaded, output=path, progress=progress, force=force, checkpoint=checkpoint)
    typer.echo(str(path))
