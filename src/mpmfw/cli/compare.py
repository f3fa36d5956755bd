"""``mpmfw compare``: methods side by side, one dataset."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from mpmfw.cli.arguments import ForceOption, SceneArgument, SetOption, assignments, names, variations
from mpmfw.cli.errors import check_apart, check_writable
from mpmfw.cli.progress import compare_progress
from mpmfw.cli.summary import print_comparison


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
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE", help="File to write.")] = Path(
        "compare.nc"
    ),
    report: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Page of tables and figures (HTML) to write as well.")
    ] = None,
    force: ForceOption = False,
) -> None:
    """Run SCENE with every combination of methods and join the results.

    A method that fails does not stop the others: its status says why.
    """
    from mpmfw.scene import load_scene
    from mpmfw.scene.requested import check_methods_run, check_requested
    from mpmfw.scene.specification import parse_specification

    contacts, shapes = names(contact, "contact"), names(shape, "shape")
    varied = variations(vary)
    shared = assignments(set_)
    check_requested(shared, varied, ("--set", "--vary"))
    loaded = load_scene(scene, set=shared)
    check_apart(loaded, output=output, report=report)
    for path in (output, report):
        if path is not None:
            check_writable(path)
    # A single body needs no contact; the dimension is there all the same
    contacts = contacts or [loaded.contact.method if loaded.contact else "none"]
    shapes = shapes or [loaded.shape.method]
    run = {
        kind: [parse_specification(said).name for said in chosen]
        for kind, chosen in (("contact", contacts), ("shape", shapes))
    }
    for option, keys in (("--set", shared), ("--vary", varied)):
        check_methods_run(keys, run, option)
    combinations = len(contacts) * len(shapes) * math.prod(len(values) for values in varied.values())

    from mpmfw.comparison import compare as run_all
    from mpmfw.report import write_report

    with compare_progress(combinations, loaded.time.end) as runner:
        dataset = run_all(
            loaded, contact=contacts, shape=shapes, vary=varied, output=output, runner=runner, force=force
        )
    if report is not None:
        write_report(dataset, report)
    print_comparison(dataset)
    typer.echo(f"{output}: all series and costs")
    if report is not None:
        typer.echo(f"{report}: tables and figures")
    else:
        typer.echo(f"For figures: mpmfw plot {output}, or --report FILE.html the next time")
