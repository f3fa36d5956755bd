"""``mpmfw compare``: methods side by side, one dataset."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mpmfw.cli.arguments import (
    ForceOption,
    JobsOption,
    OutputOption,
    RepeatsOption,
    SceneArgument,
    SchedulerOption,
    SetOption,
    TrustOption,
    assignments,
    jobs_of,
    names,
    variations,
)
from mpmfw.cli.errors import check_writable, result_path
from mpmfw.cli.formats import Format, FormatOption, write_rows
from mpmfw.cli.progress import campaign_progress

if TYPE_CHECKING:
    import xarray as xr


def compare(
    scene: SceneArgument,
    contact: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,…",
            help="Contact strategies, with options as in 'none,penalty(kappa=2)'; the scene's own if left out.",
        ),
    ] = None,
    shape: Annotated[
        str | None, typer.Option(metavar="A,B,…", help="Shape functions; the scene's own if left out.")
    ] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=A,B,…", help="A key of the scene and its values, a dimension more; repeatable."
        ),
    ] = None,
    set_: SetOption = None,
    trust: TrustOption = False,
    output: OutputOption = None,
    report: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Page of tables and figures (HTML) to write as well.")
    ] = None,
    force: ForceOption = False,
    jobs: JobsOption = None,
    scheduler: SchedulerOption = None,
    repeats: RepeatsOption = None,
    form: FormatOption = Format.table,
) -> None:
    """Run SCENE with every combination of methods and join the results, by default in a file named as the scene.

    A method that fails does not stop the others: its status says why. Finished runs are kept in the folder FILE.runs: a
    comparison that was broken off goes on from there.
    """
    from mpmfw.results.replacing import check_new
    from mpmfw.scene import load_scene
    from mpmfw.scene.requested import check_compared, check_requested

    contacts, shapes = names(contact, "contact"), names(shape, "shape")
    varied = variations(vary)
    shared = assignments(set_)
    check_requested(shared, varied, ("--set", "--vary"))
    loaded = load_scene(scene, set=shared, trust=trust)
    path = result_path(output, loaded, "-compare", "compare", "comparison", force, report=report)
    if report is not None:
        check_new(check_writable(report), force)
    # A single body needs no contact; the dimension is there all the same
    contacts = contacts or [loaded.contact.method if loaded.contact else "none"]
    shapes = shapes or [loaded.shape.method]
    check_compared(loaded, {"contact": contacts, "shape": shapes}, shared, varied, ("--set", "--vary"))
    from mpmfw.campaigns.comparison import compare as run_all
    from mpmfw.report import write_report

    with campaign_progress() as (progress, within):
        dataset = run_all(
            loaded,
            contact=contacts,
            shape=shapes,
            vary=varied,
            output=path,
            progress=progress,
            report=within,
            force=force,
            jobs=jobs_of(jobs, scheduler),
            executor=scheduler,
            repeats="auto" if repeats is None else repeats,
        )
    if report is not None:
        write_report(dataset, report)
    _print(dataset, path, report, form)


def _print(dataset: xr.Dataset, path: Path, report: Path | None, form: Format) -> None:
    """The table, and where everything is."""
    from mpmfw.cli.summary import print_comparison
    from mpmfw.report import table

    alone = form is not Format.table
    if alone:
        write_rows(table(dataset), form)
    else:
        print_comparison(dataset)
    typer.echo(f"{path}: all series and costs", err=alone)
    if report is not None:
        typer.echo(f"{report}: tables and figures", err=alone)
    else:
        typer.echo(f"For figures: mpmfw plot {path}, or --report FILE.html the next time", err=alone)
