"""``mpmfw study``: what accuracy costs in time."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mpmfw.cli import arguments as args
from mpmfw.cli.paths import check_result
from mpmfw.cli.progress import campaign_progress
from mpmfw.cli.tables import Format, FormatOption, print_table, print_text, write_rows
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


class Timing(StrEnum):
    """Ways to measure costs."""

    shared = "shared"
    exclusive = "exclusive"


def study(
    study: Annotated[
        str, typer.Argument(metavar="STUDY", help="A TOML file, or the name of a shipped study.")
    ],
    output: args.Output = None,
    timing: Annotated[
        Timing, typer.Option(help="Take costs as runs come, or of one run at a time.")
    ] = Timing.shared,
    jobs: args.Jobs = None,
    scheduler: args.Scheduler = None,
    repeats: args.Repeats = None,
    under: Annotated[
        str | None,
        typer.Option(metavar="ERROR", help="Relative error below which the cheapest is named: 1% or 0.01."),
    ] = None,
    body: args.Body = None,
    pair: args.Pair = None,
    axis: args.Axis = None,
    force: args.Force = False,
    trust: args.Trust = False,
    form: FormatOption = Format.table,
) -> None:
    """Run all combinations of STUDY, and say what accuracy costs in time.

    The results are written to a file, by default named as the study. Finished runs are kept in the folder
    FILE.runs: a study that was broken off goes on from there.
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

    with campaign_progress() as (progress, _):
        dataset = run_study(
            loaded,
            output=path,
            timing=timing.value,
            jobs=args.jobs_of(jobs, scheduler, None),
            executor=scheduler,
            repeats=repeats,
            under=under,
            about=args.named(body=body, pair=pair, axis=axis),
            progress=progress,
            force=force,
        )
    if form is not Format.table:
        write_rows(list(rows(dataset)), form)
    else:
        _print(dataset)
        for sentence in conclusions(dataset):
            typer.echo(sentence)
    typer.echo(f"{path}: errors and costs. For figures: mpmfw plot {path}", err=form is not Format.table)


def _print(dataset: xr.Dataset) -> None:
    """Print a line for each combination; those without a result say why below the table."""
    from mpmfw.studies.conclusion import rows

    dims = [str(dim) for dim in dataset["status"].dims]
    labels = [*dims, *(name for name in ("scheme", "transfer") if name not in dims and name in dataset)]
    heads = {**{name: name.replace("_", "\n") for name in labels}, **_HEADS}
    if not (dataset["settle_time"] > 0.0).any():
        del heads["settle_time"]
    found = list(rows(dataset))
    cells = [
        {
            **row,
            "error": 100.0 * row["error"],
            "noise": 100.0 * row["noise"],
            "steps": int(row["steps"]) if row["steps"] > 0.0 else row["steps"],
            "pareto": "●" if row["pareto"] else "",
        }
        for row in found
    ]
    print_table(cells, heads, labels=labels, title=dataset.attrs["title"])
    for row in found:
        if row["status"] != "ok":
            print_text(f"{', '.join(str(row[dim]) for dim in dims)}: {row['status']}")
    typer.echo(f"\nErrors of {dataset.attrs['quantity']} against {dataset.attrs['error_against']}")
    typer.echo(f"Timing: {dataset.attrs['timing']}")
