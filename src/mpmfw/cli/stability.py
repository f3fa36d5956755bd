"""``mpmfw stability``: how far a contact can be driven."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from mpmfw.cli.arguments import (
    ContactOption,
    JobsOption,
    OutputOption,
    SceneArgument,
    SchedulerOption,
    SetOption,
    ShapeOption,
    TrustOption,
    chosen_scene,
    jobs_of,
)
from mpmfw.cli.errors import result_path
from mpmfw.cli.progress import campaign_progress
from mpmfw.errors import SceneError

if TYPE_CHECKING:
    import xarray as xr


def stability(
    scene: SceneArgument,
    output: OutputOption = None,
    contact: ContactOption = None,
    shape: ShapeOption = None,
    kappa: Annotated[
        str | None,
        typer.Option(metavar="A,B,…", help="Stiffness factors of the contact.", show_default=False),
    ] = None,
    ratio: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,…", help="Stiffnesses of the second body over the first, instead of kappa."
        ),
    ] = None,
    cfl: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,…",
            help="Courant numbers of the fixed step; 0.1 to 1.2 if left out.",
            show_default=False,
        ),
    ] = None,
    steps: Annotated[int, typer.Option(min=2, help="Steps of every run.")] = 300,
    set_: SetOption = None,
    trust: TrustOption = False,
    jobs: JobsOption = None,
    scheduler: SchedulerOption = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a map that is there.")] = False,
) -> None:
    """Run SCENE at many stiffnesses and time steps, past the limit too, and map where it stays stable.

    The map is written to a file, by default named as the scene, with the figure beside it. One that was broken off goes on
    where it stopped.
    """
    from mpmfw.results.replacing import check_new

    loaded = chosen_scene(scene, contact, shape, set_, trust)
    path = result_path(output, loaded, "-stability", "stability", "map of stability", force)
    check_new(path.with_suffix(".png"), force)
    numbers = {
        name: _numbers(name, text) for name, text in (("kappa", kappa), ("ratio", ratio), ("cfl", cfl))
    }

    from mpmfw.plots import plot_file
    from mpmfw.stability import stability_map

    given = {name: values for name, values in numbers.items() if values is not None}
    with campaign_progress() as (progress, _):
        dataset = stability_map(
            loaded,
            steps=steps,
            output=path,
            progress=progress,
            jobs=jobs_of(jobs, scheduler),
            executor=scheduler,
            **given,  # type: ignore[arg-type]
        )
    _print(dataset)
    typer.echo(str(path))
    for written in plot_file(path, force=True):
        typer.echo(str(written))


def _numbers(option: str, text: str | None) -> list[float] | None:
    if text is None:
        return None
    try:
        return [float(part) for part in text.split(",")]
    except ValueError as error:
        raise SceneError(f"--{option} {text}: expected numbers with a comma between them") from error


def _print(dataset: xr.Dataset) -> None:
    """Largest stable Courant number at every stiffness, beside those of the theory, and one letter for every point."""
    from rich.console import Console

    from mpmfw.cli.tables import grouped_table
    from mpmfw.stability.chart import largest_stable

    axis, cfl = str(dataset["class"].dims[0]), dataset["cfl"].values
    heads = {
        axis: axis,
        "stable": "largest\nstable",
        "closed_form": "closed\nform",
        "limit": "Gershgorin\nbound",
    }
    heads["marks"] = "at " + " ".join(f"{value:g}" for value in cfl)
    letters = [name[0].upper() for name in dataset.attrs["classes"].split(", ")] + ["?"]  # -1 is not known
    rows = []
    for value, stable in zip(dataset[axis].values, largest_stable(dataset), strict=True):
        row = dataset.sel({axis: value})
        marks = " ".join(letters[int(c)].ljust(len(f"{v:g}")) for c, v in zip(row["class"], cfl, strict=True))
        lines = {name: f"{float(row[name]):.3g}" for name in ("closed_form", "limit")}
        held = "–" if stable != stable else f"{stable:g}"
        rows.append({axis: f"{value:g}", "stable": held, **lines, "marks": f"   {marks}"})
    Console().print(grouped_table(heads, rows, ["marks"], dataset.attrs["title"], wrapped=True, parted=False))
    typer.echo("N no contact, S stable, B bounded, D diverged: " + dataset.attrs["bounds"])
