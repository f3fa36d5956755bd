"""``mpmfw rank``: who wins at what price."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Annotated, Any

import typer
from typer import Argument, Option

from mpmfw.cli import arguments as args
from mpmfw.cli.paths import figure_path, new_path
from mpmfw.cli.tables import Format, FormatOption, print_table, write_rows


def rank(
    results: Annotated[list[Path], Argument(metavar="RESULTS", help="Files of mpmfw study.")],
    by: Annotated[str, Option(metavar="KEY", help="Rank contact, shape, or another dimension.")] = "contact",
    levels: Annotated[str, Option(metavar="ERRORS", help="Errors to reach, falling.")] = "10%,5%,2%,1%,0.5%",
    body: args.Body = None,
    pair: args.Pair = None,
    axis: args.Axis = None,
    output: args.Output = None,
    form: FormatOption = Format.table,
    force: args.Replace = False,
) -> None:
    """Rank the methods of studies by the problems that they solve, and by their cost.

    Of every method the cheapest run counts that reaches a level. With --output a figure (PNG, PDF or SVG):
    the share of problems and levels that each method solves within a cost.
    """
    from mpmfw.studies import ranking
    from mpmfw.studies.study import relative_error

    output = None if output is None else new_path(figure_path(output), force)
    reached = [relative_error(part.strip(), "--levels") for part in levels.split(",")]

    about = args.named(body=body, pair=pair, axis=axis)
    found = ranking.rank(results, by, reached, about)
    known = [name for name in ranking.QUANTITIES if found["over_best"].sel(quantity=name).notnull().any()]
    if form is not Format.table:
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
    _print_failures(json.loads(found.attrs["failures"]), err=form is not Format.table)
    if output is not None:
        from mpmfw.plots import write_figure
        from mpmfw.plots.ranking import profiles

        write_figure(profiles(found), output)
        typer.echo(str(output), err=form is not Format.table)


def _print_failures(failures: list[dict[str, Any]], *, err: bool) -> None:
    counts = Counter((one["method"], one["status"]) for one in failures)
    for (method, status), times in counts.items():
        runs = "run does" if times == 1 else "runs do"
        typer.echo(f"{method}: {times} {runs} not count: {status}", err=err)
