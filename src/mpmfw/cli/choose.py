"""``mpmfw choose``: the method and cell size for an error."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer import Option

from mpmfw.cli import arguments as args
from mpmfw.cli.paths import result_path
from mpmfw.cli.progress import campaign_progress
from mpmfw.cli.tables import Format, FormatOption, print_table, write_rows

if TYPE_CHECKING:
    import xarray as xr

#: Heads of the columns of the table.
_HEADS = {
    "contact": "contact",
    "shape": "shape",
    "pilots": "errors\n[%]",
    "cell_size_needed": "cell\n[m]",
    "error": "error\n[%]",
    "cost": "CPU\n[s]",
    "verdict": "verdict",
}


def choose(
    scene: args.SceneName,
    error: Annotated[str, Option(metavar="ERROR", help="Relative error to reach: 1% or 0.01.")] = "1%",
    measure: Annotated[
        str | None, Option(metavar="NAME", help="Quantity; by default the first whose value is known.")
    ] = None,
    body: args.Body = None,
    pair: args.Pair = None,
    axis: args.Axis = None,
    contact: args.Contacts = None,
    shape: args.Shapes = None,
    coarsest: Annotated[
        str | None, Option(metavar="LENGTH", help="Largest cell size; twice the scene's by default.")
    ] = None,
    finest: Annotated[
        str | None, Option(metavar="LENGTH", help="Smallest cell size; a quarter of the scene's by default.")
    ] = None,
    set_: args.Set = None,
    trust: args.Trust = False,
    output: args.Output = None,
    force: args.Force = False,
    jobs: args.Jobs = None,
    scheduler: args.Scheduler = None,
    form: FormatOption = Format.table,
    as_json: Annotated[bool, Option("--json", help="The same as --format json.")] = False,
) -> None:
    """Say which method and cell size bring the error of SCENE below --error: coarse to fine, until two laws
    agree.

    By default it chooses among five cheap contacts, gimp and cpdi. The result is written to a file, by
    default named as the scene. A choice that was broken off goes on from the folder FILE.runs.
    """
    from mpmfw.scene import load_scene
    from mpmfw.scene.requested import check_compared, check_requested

    form = Format.json if as_json else form
    contacts, shapes = args.names(contact, "contact"), args.names(shape, "shape")
    shared = args.assignments(set_)
    check_requested(shared, {}, ("--set", "--vary"))
    loaded = load_scene(scene, set=shared, trust=trust)
    path = result_path(output, loaded, "choice", force)
    from mpmfw.studies.choosing import CONTACTS, SHAPES
    from mpmfw.studies.choosing import choose as run_ladder

    methods = {"contact": contacts or CONTACTS, "shape": shapes or SHAPES}
    check_compared(loaded, methods, shared, {}, ("--set", "--vary"))
    about = args.named(measure=measure, body=body, pair=pair, axis=axis, coarsest=coarsest, finest=finest)
    running: dict[str, Any] = {**about, **args.workers(jobs, scheduler), "force": force, "output": path}
    with campaign_progress() as reports:
        dataset = run_ladder(loaded, error, contact=contacts, shape=shapes, **running, **reports)
    _print(dataset, form)
    typer.echo(f"{path}: runs and answer", err=form is not Format.table)


def _print(dataset: xr.Dataset, form: Format) -> None:
    from mpmfw.studies.conclusion import advice, method_rows

    rows = method_rows(dataset)
    if form is not Format.table:
        write_rows(rows, form)
        return
    for row in rows:
        row |= {"pilots": row["pilots"].replace(" ", "\n"), "error": 100.0 * row["error"]}
        if row["status"] not in ("ok", "not run"):
            row["verdict"] = row["status"]
    title = dataset.attrs["title"]
    print_table(rows, _HEADS, labels=("contact", "shape"), words=("verdict",), title=title)
    for sentence in advice(dataset):
        typer.echo(sentence)
