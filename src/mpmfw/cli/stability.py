"""``mpmfw stability``: how far a contact can be driven."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich import box
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from mpmfw.cli.arguments import (
    ContactOption,
    OutputOption,
    SceneArgument,
    SetOption,
    ShapeOption,
    chosen_scene,
)
from mpmfw.cli.errors import check_apart, check_writable
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
        typer.Option(metavar="A,B,…", help="Stiffness factors of the penalty contact.", show_default=False),
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
) -> None:
    """Run SCENE at many stiffnesses and time steps, past the limit too, and map where it stays stable.

    The map is written to a file, by default named as the scene, with the figure beside it. One that was broken off goes on
    where it stopped.
    """
    loaded = chosen_scene(scene, contact, shape, set_)
    from mpmfw.results.replacing import check_replaceable

    path = check_writable(Path(f"{loaded.name}-stability.nc") if output is None else output)
    check_apart(loaded, output=path)
    check_replaceable(path, "stability", "map of stability")
    numbers = {
        name: _numbers(name, text) for name, text in (("kappa", kappa), ("ratio", ratio), ("cfl", cfl))
    }

    from mpmfw.plots import plot_file
    from mpmfw.stability import stability_map
    from mpmfw.stability.kept import kept_file

    given = {name: values for name, values in numbers.items() if values is not None}
    try:
        with _progress() as progress:
            dataset = stability_map(loaded, steps=steps, output=path, progress=progress, **given)  # type: ignore[arg-type]
    except KeyboardInterrupt:
        if kept_file(path).is_file():
            typer.echo(f"{kept_file(path)}: points so far; the same command goes on from there", err=True)
        raise
    _print(dataset)
    typer.echo(str(path))
    for written in plot_file(path):
        typer.echo(str(written))


def _numbers(option: str, text: str | None) -> list[float] | None:
    if text is None:
        return None
    try:
        return [float(part) for part in text.split(",")]
    except ValueError as error:
        raise SceneError(f"--{option} {text}: expected numbers with a comma between them") from error


@contextmanager
def _progress() -> Iterator[Callable[[int, int], None] | None]:
    """How many runs are done, on a terminal; None in a pipe."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    columns = (TextColumn("runs"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def _print(dataset: xr.Dataset) -> None:
    """Largest stable Courant number at every stiffness, beside those of the theory, and one letter for every point."""
    from mpmfw.stability.chart import largest_stable

    axis, cfl = str(dataset["class"].dims[0]), dataset["cfl"].values
    table = Table(
        title=dataset.attrs["title"],
        title_justify="left",
        box=box.SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
        pad_edge=False,
    )
    for head in (axis, "largest\nstable", "closed\nform", "Gershgorin\nbound"):
        table.add_column(Text(head), justify="right", no_wrap=True)
    table.add_column(Text("at " + " ".join(f"{value:g}" for value in cfl)))
    held, letters = largest_stable(dataset), dataset.attrs["classes"].split(", ")
    for k, value in enumerate(dataset[axis].values):
        row = dataset.isel({axis: k})
        said = [f"{value:g}", "–" if held[k] != held[k] else f"{held[k]:g}"]
        said += [f"{float(row[name]):.3g}" for name in ("closed_form", "limit")]
        marks = " ".join(
            letters[int(c)][0].upper().ljust(len(f"{v:g}")) for c, v in zip(row["class"], cfl, strict=True)
        )
        table.add_row(*map(Text, said), Text("   " + marks))
    Console().print(table)
    typer.echo("N no contact, S stable, B bounded, D diverged: " + dataset.attrs["bounds"])
