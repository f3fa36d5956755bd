"""``mpmfw choose``: the method and cell size for an error."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mpmfw.cli.arguments import (
    AxisOption,
    BodyOption,
    ForceOption,
    JobsOption,
    OutputOption,
    PairOption,
    SceneArgument,
    SchedulerOption,
    SetOption,
    TrustOption,
    assignments,
    jobs_of,
    names,
)
from mpmfw.cli.errors import result_path
from mpmfw.cli.formats import Format, FormatOption, write_rows
from mpmfw.cli.progress import campaign_progress

if TYPE_CHECKING:
    import xarray as xr

#: Heads of the columns of the table.
_HEADS = {
    "contact": "contact",
    "shape": "shape",
    "pilots": "errors\n[%]",
    "cell": "cell\n[m]",
    "error": "error\n[%]",
    "cost": "CPU\n[s]",
    "verdict": "verdict",
}


def choose(
    scene: SceneArgument,
    error: Annotated[
        str, typer.Option(metavar="ERROR", help="Relative error that is asked for: 1% or 0.01.")
    ] = "1%",
    measure: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Quantity whose error it is; the first that the scene's closed form or reference knows if left out.",
            show_default=False,
        ),
    ] = None,
    body: BodyOption = None,
    pair: PairOption = None,
    axis: AxisOption = None,
    contact: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,…",
            help="Contact strategies to choose among, with options as in 'penalty(kappa=2)', the cheap ones first; five if left "
            "out.",
            show_default=False,
        ),
    ] = None,
    shape: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,…",
            help="Shape functions to choose among; gimp and cpdi if left out.",
            show_default=False,
        ),
    ] = None,
    coarsest: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Largest cell size; twice the scene's own if left out.",
            show_default=False,
        ),
    ] = None,
    finest: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Smallest cell size; a quarter of the scene's own if left out.",
            show_default=False,
        ),
    ] = None,
    set_: SetOption = None,
    trust: TrustOption = False,
    output: OutputOption = None,
    force: ForceOption = False,
    jobs: JobsOption = None,
    scheduler: SchedulerOption = None,
    form: FormatOption = Format.table,
    as_json: Annotated[bool, typer.Option("--json", help="The same as --format json.")] = False,
) -> None:
    """Say which method and cell size bring the error of SCENE below --error: coarse to fine, until two laws agree.

    The result is written to a file, by default named as the scene. Finished runs are kept in the folder FILE.runs: a choice
    that was broken off, or that is asked for another error, goes on from there.
    """
    from mpmfw.scene import load_scene
    from mpmfw.scene.requested import check_compared, check_requested

    form = Format.json if as_json else form
    contacts, shapes = names(contact, "contact"), names(shape, "shape")
    shared = assignments(set_)
    check_requested(shared, {}, ("--set", "--vary"))
    loaded = load_scene(scene, set=shared, trust=trust)
    path = result_path(output, loaded, "-choose", "choice", "result of mpmfw choose", force)
    from mpmfw.studies.advice import advice, method_rows
    from mpmfw.studies.choosing import CONTACTS, SHAPES
    from mpmfw.studies.choosing import choose as run_ladder

    methods = {"contact": contacts or CONTACTS, "shape": shapes or SHAPES}
    check_compared(loaded, methods, shared, {}, ("--set", "--vary"))
    with campaign_progress("runs") as (progress, within):
        dataset = run_ladder(
            loaded,
            error,
            measure=measure,
            body=body,
            pair=pair,
            axis=axis,
            contact=contacts,
            shape=shapes,
            coarsest=coarsest,
            finest=finest,
            output=path,
            executor=scheduler,
            jobs=jobs_of(jobs, scheduler),
            progress=progress,
            report=within,
            force=force,
        )
    if form is not Format.table:
        write_rows(method_rows(dataset), form)
    else:
        _print(dataset)
        for sentence in advice(dataset):
            typer.echo(sentence)
    typer.echo(f"{path}: runs and answer", err=form is not Format.table)


def _print(dataset: xr.Dataset) -> None:
    """One line a method."""
    from mpmfw.cli.tables import console, grouped_table
    from mpmfw.studies.advice import method_rows

    cells = [_cells(row) for row in method_rows(dataset)]
    words = ["contact", "shape", "verdict"]
    console().print(grouped_table(_HEADS, cells, words, dataset.attrs["title"], wrapped=True, parted=False))


def _cells(row: Mapping[str, Any]) -> dict[str, str]:
    """Return a row's texts; a dash for what is not known."""
    from mpmfw.cli.tables import broken_label

    numbers = {
        "cell": f"{row['cell_size_needed']:.4g}",
        "error": f"{100.0 * row['error']:.3g}",
        "cost": f"{row['cost']:.3g}",
    }
    return {
        "contact": broken_label(row["contact"]).replace("(", "(\n ", 1),
        "shape": row["shape"],
        "pilots": row["pilots"].replace(" ", "\n"),
        **{name: "–" if text == "nan" else text for name, text in numbers.items()},
        "verdict": row["verdict"] if row["status"] in ("ok", "not run") else row["status"],
    }
