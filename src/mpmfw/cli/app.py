"""The commands, collected. Exit status: 0 done, 1 the run failed, 2 the request was wrong."""

from __future__ import annotations

import functools
import io
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer
from typer import Argument, Option

from mpmfw._version import __version__
from mpmfw.cli.compare import compare, stability
from mpmfw.cli.explain import explain
from mpmfw.cli.figures import animate, export, plot, report, view
from mpmfw.cli.plugins import check, new, plugins, schema
from mpmfw.cli.run import benchmark, resume, run, warm_up
from mpmfw.cli.study import choose, rank, study
from mpmfw.cli.validate import validate
from mpmfw.errors import Interrupted, MpmfwError, ResultsWarning, SceneError

app = typer.Typer(
    name="mpmfw",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,  # what draws boxes takes longer to import than the help may take
    pretty_exceptions_enable=False,
)


def exit_status(command: Callable[..., Any]) -> Callable[..., None]:
    """Return the command with errors on stderr and an exit status."""

    @functools.wraps(command)
    def guarded(*args: Any, **kwargs: Any) -> None:
        try:
            with warnings.catch_warnings():
                warnings.showwarning = functools.partial(_show, warnings.showwarning)
                command(*args, **kwargs)
        except BrokenPipeError:
            raise
        except (MpmfwError, Interrupted, OSError) as error:
            text = str(error)
            if isinstance(error, OSError) and error.filename:
                text = f"'{error.filename}': {error.strerror}"
            typer.echo(text, err=True)
            status = 2 if isinstance(error, SceneError) else 1
            raise typer.Exit(128 + error.number if isinstance(error, Interrupted) else status) from error

    return guarded


def _show(other: Any, message: Warning | str, category: type[Warning], *rest: Any, **named: Any) -> None:
    if issubclass(category, ResultsWarning):
        typer.echo(f"note: {message}", err=True)
    else:
        other(message, category, *rest, **named)


def prune(
    folders: Annotated[list[Path], Argument(metavar="FOLDER", help="Folders such as FILE.nc.runs.")],
) -> None:
    """Delete runs of other code or other versions of the libraries.

    Unfinished files of killed processes go as well; other files stay.
    """
    from mpmfw.campaigns.store import Store
    from mpmfw.runs.identity import is_current

    for folder in folders:
        if not folder.is_dir():
            raise SceneError(f"{folder}: no such folder; expected one of finished runs, such as FILE.nc.runs")
        forgotten, kept, freed = Store(folder).prune(is_current)
        typer.echo(f"{folder}: {forgotten} runs deleted, {1e-6 * freed:.3g} MB free, {kept} runs kept")


_COMMANDS = (
    run, resume, compare, study, rank, choose, stability, report, plot, animate, view, export, explain,
    schema, plugins, benchmark, warm_up, validate, check, new,
)  # fmt: skip

for command in _COMMANDS:
    first = (command.__doc__ or "").partition("\n\n")[0]  # in the list of commands as a whole, else it is cut
    app.command(short_help=first)(exit_status(command))

_store = typer.Typer(name="store", help="Manage the folders of finished runs.", no_args_is_help=True)
_store.command()(exit_status(prune))
app.add_typer(_store)


def _print_version(asked: bool) -> None:
    if asked:
        typer.echo(__version__)
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Contact algorithms of the Material Point Method, side by side: error, noise and cost."""


def main(arguments: list[str] | None = None) -> None:
    """Run the command line with these arguments, or those of the process."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # names of files may be no text
    app(arguments, prog_name="mpmfw")
