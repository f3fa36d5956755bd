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
    TrustOption,
    jobs_of,
)
from mpmfw.cli.errors import check_result
from mpmfw.cli.formats import Format, FormatOption, write_rows
from mpmfw.cli.progress import campaign_progress
from mpmfw.errors import SceneError

if TYPE_CHECKING:
    import xarray as xr

    from mpmfw.studies.loading import Study


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
    trust: TrustOption = False,
    form: FormatOption = Format.table,
) -> None:
    """Run all combinations of STUDY, and say what accuracy costs in time.

    The results are written to a file, by default named as the study. Finished runs are kept in the folder FILE.runs: a
    study that was broken off goes on from there.
    """
    from mpmfw.studies.conclusion import conclusions, rows
    from mpmfw.studies.loading import load_study

    loaded = load_study(study, trust)
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
    from mpmfw.cli.tables import console, grouped_table
    from mpmfw.studies.conclusion import rows

    dims = [str(dim) for dim in dataset["status"].dims]
    labels = [*dims, *(name for name in ("scheme", "transfer") if name not in dims and name in dataset)]
    heads = {**{name: name.replace("_", "\n") for name in labels}, **_HEADS}
    if not (dataset["settle_time"] > 0.0).any():
        del heads["settle_time"]
    found = list(rows(dataset))
    cells = [_cells(row, labels) for row in found]
    console().print(grouped_table(heads, cells, labels, dataset.attrs["title"], wrapped=True))
    for row in found:
        if row["status"] != "ok":
            typer.echo(f"{', '.join(str(row[dim]) for dim in dims)}: {row['status']}")
    typer.echo(f"\nErrors of {dataset.attrs['quantity']} against {dataset.attrs['error_against']}")
    typer.echo(f"Timing: {dataset.attrs['timing']}")


def _cells(row: Mapping[str, Any], labels: list[str]) -> dict[str, str]:
    """Labels, error in per cent, costs, steps, and a mark on the front; a dash for what is not known."""
    from mpmfw.cli.tables import broken_label

    words = {name: broken_label(str(row[name])).replace("(", "(\n ", 1) for name in labels}
    numbers = {
        "error": f"{100.0 * row['error']:.3g}",
        "noise": f"{100.0 * row['noise']:.2g}",
        "cpu_time": f"{row['cpu_time']:.3g}",
        "cpu_time_spread": f"{row['cpu_time_spread']:.2g}",
        "settle_time": f"{row['settle_time']:.3g}",
        "steps": f"{row['steps']:.0f}",
    }
    known = {name: "–" if text == "nan" else text for name, text in numbers.items()}
    return {**words, **known, "pareto": "●" if row["pareto"] else ""}
