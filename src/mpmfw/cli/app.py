"""The commands, collected. Exit status: 0 done, 1 the run failed, 2 the request was wrong."""

from __future__ import annotations

import io
import sys
from typing import Annotated

import typer

from mpmfw._version import __version__
from mpmfw.cli.benchmark import benchmark
from mpmfw.cli.check import check
from mpmfw.cli.choose import choose
from mpmfw.cli.compare import compare
from mpmfw.cli.errors import exit_status
from mpmfw.cli.explain import explain
from mpmfw.cli.figures import animate, export, plot
from mpmfw.cli.plugins import new, plugins, schema
from mpmfw.cli.rank import rank
from mpmfw.cli.run import resume, run
from mpmfw.cli.stability import stability
from mpmfw.cli.store import prune
from mpmfw.cli.study import study
from mpmfw.cli.validate import validate

app = typer.Typer(
    name="mpmfw",
    help="Contact algorithms of the Material Point Method, side by side: error, noise and cost.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,  # what draws boxes takes longer to import than the help may take
    pretty_exceptions_enable=False,
)

_COMMANDS = (
    run, resume, compare, study, rank, choose, stability, plot, animate, export, explain, schema, plugins,
    benchmark,
    validate, check, new,
)  # fmt: skip

for command in _COMMANDS:
    first = (command.__doc__ or "").partition("\n\n")[0]  # in the list of commands as a whole, else it is cut
    app.command(short_help=first)(exit_status(command))

_store = typer.Typer(
    name="store", help="The folders of finished runs that campaigns take from.", no_args_is_help=True
)
_store.command()(exit_status(prune))
app.add_typer(_store)


def _print_version(asked: bool) -> None:
    if asked:
        typer.echo(__version__)
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Contact algorithms of the Material Point Method, side by side: error, noise and cost."""


def main(arguments: list[str] | None = None) -> None:
    """Run the command line; the entry point of the script ``mpmfw``, which takes the process's own
    arguments.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # names of files may be no text
    app(arguments, prog_name="mpmfw")
