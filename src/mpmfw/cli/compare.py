"""``mpmfw compare``: methods side by side, one dataset; ``stability``: a map of stiffness and time step."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer import Option

from mpmfw.cli import arguments as args
from mpmfw.cli.tables import Format, FormatOption, campaign_progress, print_table, write_rows
from mpmfw.errors import SceneError, is_complete

if TYPE_CHECKING:
    import xarray as xr

    from mpmfw.campaigns.running import Event, Progress

#: Columns of the page that a terminal does without.
_LEFT_OUT = {"largest_penetration", "material_points", "steps"}


def compare(
    scene: args.SceneName,
    contact: args.Contacts = None,
    shape: args.Shapes = None,
    code: args.Codes = None,
    vary: Annotated[
        list[str] | None, Option(metavar="KEY=A,B,…", help="A key and its values; repeatable.")
    ] = None,
    set_: args.Set = None,
    trust: args.Trust = False,
    output: args.Output = None,
    report: Annotated[Path | None, Option(metavar="FILE", help="HTML page to write as well.")] = None,
    records: Annotated[
        Path | None, Option(metavar="FOLDER", help="Folder for a JSON record of each row.")
    ] = None,
    force: args.Force = False,
    jobs: args.Jobs = None,
    scheduler: args.Scheduler = None,
    repeats: args.Repeats = None,
    form: FormatOption = Format.text,
) -> None:
    """Run SCENE with every combination of methods; join the results, by default in a file named after it.

    A method that fails does not stop the others. Methods are by default the scene's. A comparison that was
    interrupted continues from the folder FILE.runs.
    """
    from mpmfw.scene import load_scene
    from mpmfw.scene.requested import check_compared, methods_of

    contacts, shapes = args.names(contact, "contact"), args.names(shape, "shape")
    codes = args.names(code, "code")
    varied, shared = args.variations(vary), args.assignments(set_)
    loaded = load_scene(scene, set=shared, trust=trust)
    path = args.result_path(output, loaded, "compare", force)
    if report is not None and args.new_path(report, force).resolve() == path.resolve():
        raise SceneError(f"--report {report}: is the file of --output; give another name")
    own = methods_of(loaded)
    chosen: dict[str, Any] = {"contact": contacts or own["contact"], "shape": shapes or own["shape"]}
    check_compared(loaded, chosen, shared, varied)
    if records is not None:
        records.mkdir(parents=True, exist_ok=True)
        args.new_path(records / "record.json", force=True)
    from mpmfw.campaigns.campaign import compare as run_all
    from mpmfw.report import table, write_report

    running: dict[str, Any] = {
        **args.workers(jobs, scheduler),
        "repeats": repeats,
        "force": force,
        "output": path,
    }
    with campaign_progress() as reports:
        if report is not None:
            reports["progress"] = _first_page(reports["progress"], path, report)
        dataset = run_all(loaded, vary=varied, code=codes or (), **chosen, **running, **reports)
    alone = form is not Format.text
    if alone:
        write_rows(table(dataset), form)
    else:
        print_comparison(dataset)
    typer.echo(f"{path}: all series and costs", err=alone)
    if records is not None:
        from mpmfw.report.records import write_records

        typer.echo(f"{records}: {len(write_records(dataset, records))} records", err=alone)
    if report is not None:
        write_report(dataset, report)
        typer.echo(f"{report}: tables and figures", err=alone)
    else:
        typer.echo(f"For figures: mpmfw plot {path}, or --report FILE.html the next time", err=alone)


def _first_page(progress: Progress | None, results: Path, page: Path) -> Progress:
    """Return a progress that also writes the page of the first run as soon as that has ended."""
    from mpmfw.report import write_report

    written = False

    def tell(event: Event) -> None:
        nonlocal written
        if not written and event.done < event.total and is_complete(event.status):
            write_report(results, page)
            written = True
            if progress is not None:
                typer.echo(f"{page}: first figures, of {event.name}", err=True)
        if progress is not None:
            progress(event)

    return tell


def print_comparison(dataset: xr.Dataset) -> None:
    """Print the table of a comparison, why runs failed, and the reference."""
    from mpmfw.report import CHOICES, COLUMNS, method_dims, shown, table
    from mpmfw.report.table import column_of, measured
    from mpmfw.results.references import described

    rows = table(dataset)
    labels = [str(dim) for dim in method_dims(dataset)]
    columns = measured(dataset)
    columns += [name for name in COLUMNS if name not in _LEFT_OUT and any(name in row for row in rows)]
    heads = {name: name.replace("_", " ") for name in (*labels, "status", *CHOICES)}
    for name in columns:
        column = column_of(name)
        heads[name] = column.short + ("" if column.unit == "1" else f"\n[{column.unit}]")
    cells = []
    for row in rows:
        words = {name: row.get(name, "") for name in (*labels, *CHOICES)}
        if row["status"] != "ok":
            words |= {"status": row["status"].partition(":")[0], "style": "red"}
        cells.append(words | {name: shown(row.get(name, math.nan), column_of(name)) for name in columns})
    print_table(cells, heads, labels=labels, words=("status", *CHOICES))
    for row in rows:
        if row["status"] != "ok":
            typer.echo(f"{', '.join(str(row[label]) for label in labels)}: {row['status']}")
    if reference := described(dataset):
        own = reference.startswith("each row")
        typer.echo(f"Errors: {reference}" if own else f"Errors against {reference}")


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
    print_map(dataset)
    typer.echo(str(path))
    for written in plot_file(path, force=True):
        typer.echo(str(written))


def print_map(dataset: xr.Dataset) -> None:
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
