"""``mpmfw stability``: a map of stiffness and time step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer import Option

from mpmfw.cli import arguments as args
from mpmfw.cli.tables import campaign_progress, print_table

if TYPE_CHECKING:
    import xarray as xr


def stability(
    scene: args.SceneName,
    output: args.Output = None,
    contact: args.Contact = None,
    shape: args.Shape = None,
    kappa: Annotated[str | None, Option(metavar="A,B,…", help="Stiffness factors of the contact.")] = None,
    ratio: Annotated[
        str | None, Option(metavar="A,B,…", help="Stiffnesses of the second body over the first.")
    ] = None,
    cfl: Annotated[
        str | None, Option(metavar="A,B,…", help="Courant numbers of the step; by default 0.1 to 1.2.")
    ] = None,
    steps: Annotated[int, Option(min=2, help="Steps of every run.")] = 300,
    set_: args.Set = None,
    trust: args.Trust = False,
    jobs: args.Jobs = None,
    scheduler: args.Scheduler = None,
    force: args.Replace = False,
) -> None:
    """Run SCENE at many stiffnesses and time steps, and map where it is stable.

    The map is written to a file, by default named after the scene, with the figure beside it.
    """
    loaded = args.chosen_scene(scene, contact, shape, set_, trust)
    path = args.result_path(output, loaded, "stability", force)
    args.new_path(path.with_suffix(".png"), force)
    options = args.named(kappa=kappa, ratio=ratio, cfl=cfl)
    given = {name: args.numbers(name, text) for name, text in options.items()}

    from mpmfw.plots import plot_file
    from mpmfw.stability import stability_map

    running: dict[str, Any] = {**given, **args.workers(jobs, scheduler)}
    with campaign_progress() as reports:
        progress = reports["progress"]
        dataset = stability_map(loaded, steps=steps, output=path, progress=progress, **running)
    _print(dataset)
    typer.echo(str(path))
    for written in plot_file(path, force=True):
        typer.echo(str(written))


def _print(dataset: xr.Dataset) -> None:
    from mpmfw.stability.chart import largest_stable

    axis, cfl = str(dataset["class"].dims[0]), dataset["cfl"].values
    numbers = [f"{value:g}" for value in cfl]
    heads = {
        axis: axis,
        "stable": "largest\nstable",
        "closed_form": "closed\nform",
        "limit": "Gershgorin\nbound",
        "marks": "at " + " ".join(numbers),
    }
    letters = [name[0].upper() for name in dataset.attrs["classes"].split(", ")] + ["?"]  # -1 is not known
    rows = []
    for value, stable in zip(dataset[axis].values, largest_stable(dataset), strict=True):
        row = dataset.sel({axis: value})
        marks = [
            letters[int(code)].rjust(len(number)) for code, number in zip(row["class"], numbers, strict=True)
        ]
        limits = {name: float(row[name]) for name in ("closed_form", "limit")}
        rows.append({axis: f"{value:g}", "stable": float(stable), **limits, "marks": " ".join(marks)})
    print_table(rows, heads, labels=(axis,), title=dataset.attrs["title"])
    typer.echo("N no contact, S stable, B bounded, D diverged: " + dataset.attrs["bounds"])
