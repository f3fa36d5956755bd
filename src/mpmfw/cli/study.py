"""``mpmfw study``: what accuracy costs in time."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mpmfw.cli.arguments import (
    ForceOption,
    JobsOption,
    OutputOption,
    RepeatsOption,
    SchedulerOption,
    jobs_of,
)
from mpmfw.cli.errors import check_result
from mpmfw.cli.formats import Format, FormatOption, write_rows
from mpmfw.cli.progress import campaign_progress
from mpmfw.errors import SceneError

if TYPE_CHECKING:
    import xarray as xr

    from mpmfw.studies.loading import Study


class Timing(StrEnum):
    """How costs are measured."""

    shared = "shared"
    exclusive = "exclusive"


def study(
    study: Annotated[
        str,
        typer.Argument(
            metavar="STUDY", help="A TOML file, or the name of a shipped study.", show_default=False
        ),
    ],
    output: OutputOption = None,
    timing: Annotated[
        Timing,
        typer.Option(help="Take costs as runs come, or of one run at a time."),
    ] = Timing.shared,
    jobs: JobsOption = None,
    scheduler: SchedulerOption = None,
    repeats: RepeatsOption = None,
    under: Annotated[
        str | None,
        typer.Option(
            metavar="ERROR",
            help="Relative error below which the cheapest is named: 1% or 0.01.",
            show_default=False,
        ),
    ] = None,
    force: ForceOption = False,
    form: FormatOption = Format.table,
) -> None:
    """Run all combinations of STUDY, and say what accuracy costs in time.

    The results are written to a file, by default named as the study. Finished runs are kept in the folder FILE.runs: a
    study that was broken off goes on from there.
    """
    from mpmfw.studies.conclusion import conclusions, rows
    from mpmfw.studies.loading import load_study

    loaded = load_study(study)
    path = Path(f"{loaded.name}.nc") if output is None else output
    _check_apart(loaded, path)
    check_result(path, "study", "study's results", force)

    from mpmfw.studies.study import study as run_study

    with campaign_progress() as (progress, _):
        dataset = run_study(
            loaded,
            output=path,
            timing=timing.value,
            jobs=jobs_of(jobs, scheduler, None),
            scheduler=scheduler,
            repeats=repeats,
            under=under,
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


def _check_apart(study: Study, path: Path) -> None:
    """Refuse an output in place of the study or of a scene."""
    sources = [study.source.name, *(scene for scene in study.scenes.values() if isinstance(scene, str))]
    if any(source is not None and Path(source).resolve() == path.resolve() for source in sources):
        raise SceneError(f"--output {path}: is a file that the study reads; give another name")


def _print(dataset: xr.Dataset) -> None:
    """One line a combination; those without a result say why below the table."""
    from rich.text import Text

    from mpmfw.cli.tables import broken_label, console, plain_table
    from mpmfw.studies.conclusion import rows

    dims = [str(dim) for dim in dataset["status"].dims]
    found = list(rows(dataset))
    table = plain_table(dataset.attrs["title"])
    chosen = [name for name in ("scheme", "transfer") if name not in dims and name in dataset]
    for dim in (*dims, *chosen):
        table.add_column(dim.replace("_", "\n"), overflow="fold")
    for head in ("error\n[%]", "noise\n[%]", "CPU\n[s]", "±\n[s]", "steps", "front"):
        table.add_column(Text(head), justify="right", no_wrap=True)
    for before, row in zip([None, *found], found, strict=False):
        if before is not None and before[dims[0]] != row[dims[0]]:
            table.add_section()
        labels = (broken_label(str(row[dim])).replace("(", "(\n ", 1) for dim in (*dims, *chosen))
        table.add_row(*map(Text, labels), *_cells(row))
    console().print(table)
    for row in found:
        if row["status"] != "ok":
            typer.echo(f"{', '.join(str(row[dim]) for dim in dims)}: {row['status']}")
    typer.echo(f"\nErrors of {dataset.attrs['quantity']} against {dataset.attrs['error_against']}")
    typer.echo(f"Timing: {dataset.attrs['timing']}")


def _cells(row: Mapping[str, Any]) -> list[str]:
    """Error in per cent, costs, steps, and a mark on the front; a dash for what is not known."""
    numbers = (100.0 * row["error"], 100.0 * row["noise"], row["cpu_time"], row["cpu_time_spread"])
    texts = [f"{number:.{digits}g}" for number, digits in zip(numbers, (3, 2, 3, 2), strict=True)]
    texts.append(f"{row['steps']:.0f}")
    return ["–" if text == "nan" else text for text in texts] + ["●" if row["pareto"] else ""]
