"""``mpmfw run`` and ``resume``: one scene, one file of results; ``benchmark``: time by stage; ``warm-up``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from typer import Argument, Option

from mpmfw.cli import arguments as args
from mpmfw.cli.tables import print_table, run_progress
from mpmfw.errors import SceneError


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
    """Run SCENE and write its results, by default to a file named after the scene."""
    loaded = args.chosen_scene(scene, contact, shape, set_, trust)
    path = args.result_path(output, loaded, "run", force)

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
        bool, Option("--force", help="Continue with another version of the code; numbers may differ.")
    ] = False,
    trust: args.Trust = False,
) -> None:
    """Continue RUN.nc from its last checkpoint, with the same results as without the interruption."""
    from mpmfw.runs.run import moment, resumed, run_on

    with resumed(results, None, None, force, checkpoint, threads, trust) as checkpoints:
        simulation = checkpoints.simulation
        typer.echo(f"{results}: continues {moment(simulation)}", err=True)
        with run_progress(simulation.scene.time.end) as progress:
            run_on(checkpoints, progress)
    typer.echo(str(results))


#: Steps after which the shipped scenes are in contact.
IN_CONTACT = {"colliding-rings": 250}

#: Steps that call all kernels once bodies touch; most waits for that, and the steps of one.
FIRST_STEPS, WAITS, WAIT = 5, 10, 50

#: Headings of stages that are not the stage's name.
HEADS = {"ns_shape": "fill", "ns_contact": "contact ns"}


def benchmark(
    scenes: Annotated[str, Option(help="Scenes between commas.")] = "rolling-cylinder-slip,colliding-rings",
    repeats: Annotated[int, Option(min=3, help="Samples of each measurement.")] = 15,
    threads: Annotated[int, Option(min=1, help="Compare wall times with one thread and these.")] = 1,
    trust: args.Trust = False,
) -> None:
    """Print ns per material point and step of scenes, by stage; or what threads gain."""
    from mpmfw.benchmark import measure_scene, measure_threads
    from mpmfw.campaigns.work import Load, processor
    from mpmfw.scene import load_scene

    # a wrong scene is refused before any is measured
    loaded = {name: load_scene(name, trust=trust) for name in scenes.split(",") if name}
    if not loaded:
        raise SceneError("--scenes: expected at least one scene")
    rows, load = [], Load()
    for name, scene in loaded.items():
        start = IN_CONTACT.get(name, 0)
        if threads > 1:
            rows.append(measure_threads(scene, threads, repeats, start=start))
            continue
        row = measure_scene(scene, repeats, start=start)
        rows.append({**row, "contact %": 100.0 * row["ns_contact"] / row["ns_total"]})
    what = "ns per material point and step" if threads == 1 else "least wall time of a step, ns per point"
    heads = {key: HEADS.get(key, key.removeprefix("ns_")) for row in rows for key in row}
    print_table(rows, heads, labels=("scene", "contact", "shape"), title=f"Scenes: {what}")
    typer.echo(f"{processor()}; other processes kept {load.others():.1f} cores busy")


def warm_up(
    scene: args.SceneName = "rolling-cylinder-slip",
    contact: args.Contacts = None,
    shape: args.Shapes = None,
    trust: args.Trust = False,
) -> None:
    """Compile the kernels of SCENE, so that its runs start at once.

    It takes steps with outputs until bodies touch, at most 555, with every combination of methods, by default
    the scene's."""
    from collections import deque
    from itertools import product

    from mpmfw.runs.simulation import Simulation

    contacts, shapes = args.names(contact, "contact"), args.names(shape, "shape")
    for chosen in product(contacts or (None,), shapes or (None,)):
        loaded = args.chosen_scene(scene, *chosen, None, trust)
        simulation, frames = Simulation(loaded), deque[Any](maxlen=1)
        for steps in (0, *[WAIT] * WAITS):
            simulation.advance(steps)
            simulation.advance(FIRST_STEPS, frames.append)
            force = frames[0].series.get("contact_force")
            if force is None or force.any():
                break
        seconds, label = simulation.clock.compile_time, ", ".join(name for name in chosen if name)
        typer.echo(f"{label or loaded.name}: {seconds:.1f} s to compile or load kernels")
