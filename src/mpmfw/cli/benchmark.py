"""``mpmfw benchmark``: nanoseconds per material point and step, by stage."""

from __future__ import annotations

from typing import Annotated

import typer
from typer import Option

from mpmfw.cli import arguments as args
from mpmfw.cli.tables import print_table
from mpmfw.errors import SceneError

#: Steps after which the shipped scenes are in contact.
IN_CONTACT = {"colliding-rings": 250}

#: Columns of a measurement that are not shown.
HIDDEN = ("dim", "ns_low", "ns_high")

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
        shown = {key: value for key, value in row.items() if key not in HIDDEN}
        rows.append({**shown, "contact %": 100.0 * row["ns_contact"] / row["ns_total"]})
    what = "ns per material point and step" if threads == 1 else "least wall time of a step, ns per point"
    heads = {key: HEADS.get(key, key.removeprefix("ns_")) for row in rows for key in row}
    print_table(rows, heads, labels=("scene", "contact", "shape"), title=f"Scenes: {what}")
    typer.echo(f"{processor()}; other processes kept {load.others():.1f} cores busy")
