"""``mpmfw study``, ``choose`` and ``rank``: the cost of accuracy, and the method for an error."""

from __future__ import annotations

import json
from collections import Counter
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer import Argument, Option

from mpmfw.cli import arguments as args
from mpmfw.cli.tables import Format, FormatOption, campaign_progress, print_table, write_rows
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
    timing: Annotated[Timing, Option(help="Costs of runs beside others, or one at a time.")] = Timing.shared,
    jobs: args.Jobs = None,
    scheduler: args.Scheduler = None,
    repeats: args.Repeats = None,
    code: args.Codes = None,
    under: Annotated[
        str | None, Option(metavar="ERROR", help="Name the cheapest below this error: 1% or 0.01.")
    ] = None,
    body: args.Body = None,
    pair: args.Pair = None,
    axis: args.Axis = None,
    force: args.Force = False,
    trust: args.Trust = False,
    form: FormatOption = Format.text,
) -> None:
    """Run all combinations of STUDY, and give error and CPU time of each.

    The results are written to a file, by default named after the study. An interrupted study continues from
    the folder FILE.runs.
    """
    from mpmfw.studies.conclusion import conclusions, rows
    from mpmfw.studies.loading import load_study

    loaded = load_study(study, trust)
    path = Path(f"{loaded.name}.nc") if output is None else output
    args.check_result(path, "study", force)

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
        running |= {"code": args.names(code, "code")}
        dataset = run_study(loaded, under=under, about=about, **running)
    if form is not Format.text:
        write_rows(list(rows(dataset)), form)
    else:
        _print(dataset)
        for sentence in conclusions(dataset):
            typer.echo(sentence)
    typer.echo(f"{path}: errors and costs. For figures: mpmfw plot {path}", err=form is not Format.text)


def _print(dataset: xr.Dataset) -> None:
    from mpmfw.studies.conclusion import rows

    dims = [str(dim) for dim in dataset["status"].dims]
    labels = [*dims, *(name for name in ("scheme", "transfer") if name not in dims and name in dataset)]
    heads = {**{name: name.replace("_", "\n") for name in labels}, **_HEADS}
    if not (dataset["settle_time"] > 0.0).any():
        del heads["settle_time"]
    found = list(rows(dataset))
    for row in found:
        steps = int(row["steps"]) if row["steps"] > 0.0 else row["steps"]
        row |= {"error": 100.0 * row["error"], "noise": 100.0 * row["noise"], "steps": steps}
        row["pareto"] = "●" if row["pareto"] else ""
    print_table(found, heads, labels=labels, title=dataset.attrs["title"])
    for row in found:
        if row["status"] != "ok":
            typer.echo(f"{', '.join(str(row[dim]) for dim in dims)}: {row['status']}")
    typer.echo(f"\nErrors of {dataset.attrs['quantity']} against {dataset.attrs['error_against']}")
    typer.echo(f"Timing: {dataset.attrs['timing']}")


#: Heads of the columns of the table.
_CHOICE_HEADS = {
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
    code: args.Codes = None,
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
    form: FormatOption = Format.text,
    as_json: Annotated[bool, Option("--json", help="The same as --format json.")] = False,
) -> None:
    """Find the cheapest method and cell size with an error of SCENE below --error, from coarse to fine cells.

    By default it tries five contacts, with gimp and cpdi. The result is written to a file, by default named
    after the scene. An interrupted choice continues from the folder FILE.runs.
    """
    from mpmfw.scene import load_scene
    from mpmfw.scene.requested import check_compared

    form = Format.json if as_json else form
    contacts, shapes = args.names(contact, "contact"), args.names(shape, "shape")
    shared = args.assignments(set_)
    loaded = load_scene(scene, set=shared, trust=trust)
    path = args.result_path(output, loaded, "choice", force)
    from mpmfw.studies.choosing import CONTACTS, SHAPES
    from mpmfw.studies.choosing import choose as run_ladder

    check_compared(loaded, {"contact": contacts or CONTACTS, "shape": shapes or SHAPES}, shared, {})
    about = args.named(measure=measure, body=body, pair=pair, axis=axis, coarsest=coarsest, finest=finest)
    running: dict[str, Any] = {**about, **args.workers(jobs, scheduler), "force": force, "output": path}
    with campaign_progress() as reports:
        running |= {"contact": contacts, "shape": shapes, "code": args.names(code, "code") or ()}
        dataset = run_ladder(loaded, error, **running, **reports)
    _print_choice(dataset, form)
    typer.echo(f"{path}: runs and answer", err=form is not Format.text)


def _print_choice(dataset: xr.Dataset, form: Format) -> None:
    from mpmfw.studies.conclusion import advice, method_rows

    rows = method_rows(dataset)
    if form is not Format.text:
        write_rows(rows, form)
        return
    for row in rows:
        row |= {"pilots": row["pilots"].replace(" ", "\n"), "error": 100.0 * row["error"]}
        if row["status"] not in ("ok", "not run"):
            row["verdict"] = row["status"]
    title = dataset.attrs["title"]
    print_table(rows, _CHOICE_HEADS, labels=("contact", "shape"), words=("verdict",), title=title)
    for sentence in advice(dataset):
        typer.echo(sentence)


def rank(
    context: typer.Context,
    results: Annotated[list[Path] | None, Argument(metavar="RESULTS", help="Files of mpmfw study.")] = None,
    records: Annotated[
        Path | None, Option(metavar="FOLDER", help="Rank the records of mpmfw compare --records instead.")
    ] = None,
    by: Annotated[str, Option(metavar="KEY", help="Rank contact, shape, or another dimension.")] = "contact",
    levels: Annotated[str, Option(metavar="ERRORS", help="Errors to reach, falling.")] = "10%,5%,2%,1%,0.5%",
    body: args.Body = None,
    pair: args.Pair = None,
    axis: args.Axis = None,
    output: args.Output = None,
    form: FormatOption = Format.text,
    force: args.Replace = False,
) -> None:
    """Rank the methods of studies by the problems that they solve, and by their cost.

    For each method the cheapest run that reaches a level counts. --output draws (PNG, PDF or SVG) the share
    of problems and levels that each method solves within a cost; with --records, errors and costs.
    """
    if (records is None) != bool(results):
        raise SceneError("RESULTS: expected files of mpmfw study, or --records FOLDER")
    if records is not None:
        default = context.get_parameter_source("results")  # they are not given
        others = ("by", "levels", "body", "pair", "axis")
        given = [f"--{name}" for name in others if context.get_parameter_source(name) != default]
        if given:
            raise SceneError(f"{', '.join(given)}: has no effect with --records; leave it out")
        _show_records(
            records, form, None if output is None else args.new_path(args.figure_path(output), force)
        )
        return
    assert results is not None
    from mpmfw.studies import ranking
    from mpmfw.studies.study import relative_error

    output = None if output is None else args.new_path(args.figure_path(output), force)
    reached = [relative_error(part.strip(), "--levels") for part in levels.split(",")]

    about = args.named(body=body, pair=pair, axis=axis)
    found = ranking.rank(results, by, reached, about)
    known = [name for name in ranking.QUANTITIES if found["over_best"].sel(quantity=name).notnull().any()]
    if form is not Format.text:
        write_rows([{"quantity": name} | row for name in known for row in ranking.summary(found, name)], form)
    else:
        for quantity in known:
            meaning = ranking.QUANTITIES[quantity]
            if quantity == "error" and found.attrs["errors"]:
                meaning = f"error of {found.attrs['errors']}"
            title = (
                f"Problems, of {found.sizes['problem']} at most, whose {quantity} ({meaning}) falls "
                "to each level; median cost over the cheapest method's"
            )
            print_table(ranking.summary(found, quantity), labels=("method",), title=title)
    counts = Counter((one["method"], one["status"]) for one in json.loads(found.attrs["failures"]))
    for (method, status), times in counts.items():
        runs = "run does" if times == 1 else "runs do"
        typer.echo(f"{method}: {times} {runs} not count: {status}", err=form is not Format.text)
    if output is not None:
        from mpmfw.plots import write_figure
        from mpmfw.plots.records import profiles

        write_figure(profiles(found), output)
        typer.echo(str(output), err=form is not Format.text)


def _show_records(folder: Path, form: Format, output: Path | None) -> None:
    """Print records, and draw their figure."""
    from mpmfw.report.records import dots_of, ranked, read_records

    records = read_records(folder)
    scenes = ranked(records)
    if form is not Format.text:
        write_rows([{"scene": scene} | row for scene, rows in scenes.items() for row in rows], form)
    else:
        words = ("code", "status", "machine")
        for scene, rows in scenes.items():
            names = dict.fromkeys(name for row in rows for name in row)
            heads = {name: name.replace("_", "\n") for name in names}
            print_table(rows, heads, labels=("method", "shape"), words=words, title=scene)
    if output is not None:
        from mpmfw.plots import write_figure
        from mpmfw.plots.records import dots

        write_figure(dots(dots_of(records)), output)
        typer.echo(str(output), err=form is not Format.text)
