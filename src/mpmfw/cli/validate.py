"""``mpmfw validate``: the suite of cases, one table, and the figures."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from mpmfw.cli import arguments as args
from mpmfw.errors import SceneError


def validate(
    cases: Annotated[
        list[str] | None, Argument(metavar="[CASE …]", help="Cases; all by default.", show_default=False)
    ] = None,
    quick: Annotated[bool, Option("--quick", help="Run fewer methods on coarser grids.")] = False,
    suite: Annotated[
        Path | None,
        Option(metavar="FOLDER", help="Folder of cases, or 'hard'; by default mpmfw's.", show_default=False),
    ] = None,
    output: Annotated[
        Path, Option("-o", "--output", metavar="FOLDER", help="Folder for the figures and the table.")
    ] = Path("validation-results"),
    document: Annotated[Path | None, Option(metavar="FILE.md", help="Page to write as well.")] = None,
    jobs: Annotated[
        int | None, Option("-j", "--jobs", min=1, help="Cases at a time; one for each core by default.")
    ] = None,
    force: Annotated[bool, Option("--force", help="Run cases again that have results.")] = False,
) -> None:
    """Run validation cases by pytest: closed forms and references for contact algorithms.

    The exit status is 0 if all gates hold, except known red ones, else 1. Cases whose results in the output
    folder are of the present code are not run again.
    """
    try:
        import xdist  # noqa: F401
    except ImportError as error:
        raise SceneError("validate needs pytest-xdist: pip install 'mpmfw[testing]'") from error
    from mpmfw.validation.page import GATES, said, summary, write_csv, write_page
    from mpmfw.validation.suite import find_cases, run_cases, suite_of

    folder = suite_of(suite)
    found = sorted(find_cases(folder, cases or ()))
    _check_places(output, document, force)
    rows = run_cases(found, output, quick, jobs, force)
    for row in (row for row in rows if row["verdict"] in GATES[1:]):
        typer.echo(f"{row['verdict']}: {row['case']}: {said(row)}")
    write_csv(rows, output / "validation.csv")
    if document is not None:
        named = ["--suite", str(suite)] if suite not in (None, folder) else []
        words = ["mpmfw", "validate", *(cases or ()), *["--quick"] * quick, *named]
        write_page(rows, document, f"`{' '.join(words)}`", output)
    typer.echo(f"{summary(rows)}\n{output}: figures, and validation.csv")
    if any(row["verdict"] == "RED" for row in rows):
        raise typer.Exit(1)


def _check_places(output: Path, document: Path | None, force: bool) -> None:
    """Refuse a folder with other files, and a page without the marks."""
    from mpmfw.campaigns.store import own_files
    from mpmfw.validation.page import BEGIN

    if output.exists() and not output.is_dir():
        raise SceneError(f"--output {output}: is a file; give the name of a folder")
    output.mkdir(parents=True, exist_ok=True)
    earlier = (output / "runs").is_dir() and bool(own_files(output / "runs"))
    if any(one.name != "runs" for one in output.iterdir()) and not (earlier or force):
        raise SceneError(f"--output {output}: contains other files; give another folder, or --force")
    if document is not None:
        marked = document.is_file() and BEGIN in document.read_text(encoding="utf-8")
        args.new_path(document, force or marked)
