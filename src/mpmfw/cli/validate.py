"""``mpmfw validate``: the suite of cases, one table, and the figures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

if TYPE_CHECKING:
    from mpmfw.validation import Outcome

#: Terminal width below which the table would be cut.
WIDTH = 170


def validate(
    cases: Annotated[
        list[str] | None,
        typer.Argument(metavar="[CASE …]", help="Cases by name; all if left out.", show_default=False),
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="The reduced version: fewer methods, coarser grids.")
    ] = False,
    suite: Annotated[Path, typer.Option(metavar="FOLDER", help="Folder of the cases.")] = Path("validation"),
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="FOLDER", help="Folder for the figures and the table (CSV)."),
    ] = Path("validation-results"),
    document: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Page of documentation (Markdown) to write as well."),
    ] = None,
    known_red: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Gates known not to hold (TOML): end with 0 if these and no others are red."
        ),
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option("-j", "--jobs", min=1, help="Cases at a time; one for each core if left out."),
    ] = None,
) -> None:
    """Run validation cases: closed forms and references that tell contact algorithms apart.

    Ends with 0 if every gate holds, with 1 if one is red. The table and the page of documentation are of all cases
    whose results lie in the output folder, so that cases may be run one by one.
    """
    from mpmfw.validation import find_cases, run_cases
    from mpmfw.validation.known import departures, read_known_red
    from mpmfw.validation.report import summary, terminal_table, write_csv, write_page
    from mpmfw.validation.store import kept, save

    found = find_cases(suite, cases or ())
    known = read_known_red(known_red) if known_red is not None else []
    with _progress(len(found)) as done:

        def finished(outcome: Outcome) -> None:
            save(outcome, output, quick)
            if done is not None:
                done(outcome)

        outcomes = run_cases(found, output, quick=quick, jobs=jobs, done=finished)
    console = Console()
    Console(width=max(console.width, WIDTH)).print(terminal_table(outcomes))
    for outcome in outcomes:
        if outcome.error:
            typer.echo(f"{outcome.folder.name} went wrong:\n{outcome.error}", err=True)
    everything = kept(find_cases(suite), output, quick)
    write_csv(everything, output / "validation.csv")
    if document is not None:
        write_page(everything, document, quick, known)
    typer.echo(summary(outcomes))
    typer.echo(f"{output}: {sum(len(one.figures) for one in outcomes)} figures, and validation.csv")
    unexpected = departures([row for outcome in outcomes for row in outcome.rows], known, quick=quick)
    for line in unexpected:
        typer.echo(line)
    if unexpected or any(outcome.error for outcome in outcomes):
        raise typer.Exit(1)


@contextmanager
def _progress(total: int) -> Iterator[Callable[[Outcome], None] | None]:
    """How many cases are done, on a terminal; None in a pipe."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    columns = (TextColumn("cases"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}"))
    with Progress(*columns, TimeElapsedColumn(), console=console, transient=True) as bar:
        task = bar.add_task("", total=total)

        def done(outcome: Outcome) -> None:
            verdict = "holds" if outcome.holds else "RED"
            bar.update(
                task, advance=1, description=f"{outcome.folder.name}: {verdict}, {outcome.seconds:.0f} s"
            )

        yield done
