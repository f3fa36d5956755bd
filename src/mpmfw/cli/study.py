"""``mpmfw study``: what accuracy costs in time."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer import Argument, Option

from mpmfw.cli import arguments as args
from mpmfw.cli.paths import check_result
from mpmfw.cli.progress import campaign_progress
from mpmfw.cli.tables import Format, FormatOption, print_table, write_rows
from mpmfw.errors import SceneError

if TYPE_CHECKING:
    import xarray as xr

#: Heads of the columns of numbers.
_HEADS = {
    "error": "error\n[%]",
    "noise": "noise\n[%]",
    "cpu_time": "CPU\n[s]",
    "cpu_time_spread": "±\n[s]",
    "settle_time": "settle\n[s]",
    "steps": "steps",
    "pareto": "front",
}


Timing = StrEnum("Timing", ("shared", "exclusive"))


def study(
    study: Annotated[str, Argument(metavar="STUDY", help="A TOML file, or the name of a shipped study.")],
    output: args.Output = None,
    timing: Annotated[Timing, Option(help="Take costs as runs come, or of one at a time.")] = Timing.shared,
    jobs: args.Jobs = None,
    scheduler: args.Scheduler = None,
    repeats: args.Repeats = None,
    under: Annotated[
        str | None, Option(metavar="ERROR", help="Name the cheapest below this error: 1% or 0.01.")
    ] = None,
    body: args.Body = None,
    pair: args.Pair = None,
    axis: args.Axis = None,
    force: args.Force = False,
    trust: args.Trust = False,
    form: FormatOption = Format.table,
) -> None:
    """Run all combinations of STUDY, and say what accuracy costs in time.

    The results are written to a file, by default named as the study. One that was broken off goes on from the
    folder FILE.runs.
    """
    from mpmfw.studies.conclusion import conclusions, rows
    from mpmfw.studies.loading import load_study

    loaded = load_study(study, trust)
    path = Path(f"{loaded.name}.nc") if output is None else output
    sources = [loaded.source.name, *(scene for scene in loaded.scenes.values() if isinstance(scene, str))]
    if any(source is not None and Path(source).resolve() == path.resolve() for source in sources):
        raise SceneError(f"--output {path}: is a file that the study reads; give another name")
    check_result(path, "study", force)

    from mpmfw.studies.study import study as run_study

    running: dict[str, Any] = {
        **args.workers(jobs, scheduler, None),
        "repeats": repeats,
        "force": force,
        "output": path,
    }
    about = args.named(body=body, pair=pair, axis=axis)
    with campaign_progress() as reports:
        running |= {"progress": reports["progress"], "timing": timing.value}
        dataset = run_study(loaded, under=under, about=about, **running)
    if form is not Format.table:
        write_rows(list(rows(dataset)), form)
    else:
        _print(dataset)
        for sentence in conclusions(dataset):
            typer.echo(sentence)
    typer.echo(f"{path}: errors and costs. For figures: mpmfw plot {path}", err=form is not Format.table)


def _print(dataset: xr.Dataset) -> None:
    from mpmfw.studies.conclusion import rows

    dims = [str(dim) for dim in dataset["status"].dims]
    labels = [*dims, *(name for name in ("scheme", "transfer") if name not in dims and name in dataset)]
    heads = {**{name: name.replace("_", "\n") for name in labels}, **_HEADS}
    if not (dataset["settle_time"] > 0.0).any():
        del heads["settle_time"]
    found = list(rows(dataset))
    for row in found:
        row |= {"error": 100.0 * row["error"], "noise": 100.0 * row["noise"]}
        row |= {"steps": int(row["steps"]) if row["steps"] > 0.0 else row["steps"]}
        row |= {"pareto": "●" if row["pareto"] else ""}
    print_table(found, heads, labels=labels, title=dataset.attrs["title"])
    for row in found:
        if row["status"] != "ok":
            typer.echo(f"{', '.join(str(row[dim]) for dim in dims)}: {row['status']}")
    typer.echo(f"\nErrors of {dataset.attrs['quantity']} against {dataset.attrs['error_against']}")
    typer.echo(f"Timing: {dataset.attrs['timing']}")
