"""``mpmfw check``: run the conformance kit on a plug-in."""

from __future__ import annotations

import inspect
import os
import signal
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from textwrap import indent
from typing import TYPE_CHECKING, Annotated

import typer

from mpmfw.cli import arguments as args
from mpmfw.cli.tables import print_table
from mpmfw.errors import MpmfwError, SceneError

if TYPE_CHECKING:
    from mpmfw.plugin.discovery import Kind
    from mpmfw_testing import Check, Outcome


def check(
    plugin: Annotated[
        str,
        typer.Argument(
            metavar="PLUGIN",
            help="Installed plug-in (mpmfw plugins lists them) or module:Class; with options as in "
            "'penalty(kappa=2)'.",
        ),
    ],
    kind: Annotated[
        str | None,
        typer.Option(
            metavar="contact|detection|law|shape|material|load|friction|boundary|output|geometry|measure|reference",
            help="Kind of the plug-in, where its name does not say.",
        ),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="OPTION=VALUE", help="Set an option of the plug-in; repeatable."),
    ] = None,
    only: Annotated[
        list[str] | None, typer.Option(metavar="CHECK", help="Run this check alone; repeatable.")
    ] = None,
    expected_failures: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.toml", help="Checks that must fail: a table of their names and the reasons."
        ),
    ] = None,
    pictures: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder for pictures of counterexamples.")
    ] = Path("mpmfw-check"),
    save: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Write the scene of each counterexample there, and the program that runs it."
        ),
    ] = None,
    bounds: Annotated[
        bool,
        typer.Option(
            "--bounds",
            help="Check every index of the kernels, in another process; minutes for the first time.",
        ),
    ] = False,
    list_: Annotated[
        bool, typer.Option("--list", help="Print the checks of its kind with their bounds, and run none.")
    ] = False,
) -> None:
    """Run the conformance kit on PLUGIN; exit status 1 if a check fails unexpectedly.

    Each failure says which property is broken, the smallest counterexample, and where its picture is.
    """
    asked = _kind_of(plugin, kind)
    if list_:
        from mpmfw_testing.parametrised import checks_of, chosen

        for each in chosen(checks_of(asked), only):
            typer.echo(f"{each.name}\n{indent(inspect.getdoc(each.run) or '', '  ')}\n")
        return
    if bounds:
        files = {"--expected-failures": expected_failures, "--pictures": pictures, "--save": save}
        given = [part for option, path in files.items() if path is not None for part in (option, str(path))]
        given += [part for text in set_ or () for part in ("--set", text)]
        given += [part for name in only or () for part in ("--only", name)]
        _run_with_bounds([plugin, "--kind", asked, *given])
        return
    from mpmfw.scene.override import parse_value
    from mpmfw_testing import examine, subject_of
    from mpmfw_testing.examination import justified
    from mpmfw_testing.parametrised import checks_of, chosen
    from mpmfw_testing.past_the_end import say_lines
    from mpmfw_testing.searching import hypothesis

    if os.environ.get("NUMBA_BOUNDSCHECK"):
        say_lines()
    hypothesis()  # a missing extra is said before anything is checked
    options = {key: parse_value(text) for key, text in args.assignments(set_).items()}
    subject = subject_of(plugin, asked, options)
    known = checks_of(asked)
    checks = chosen(known, only)
    table = justified({} if expected_failures is None else _table(expected_failures), known)
    expected = {check.name: table[check.name] for check in checks if check.name in table}
    with _progress(len(checks)) as progress:
        outcomes = examine(subject, checks, expected, pictures, progress, save)
    _print(f"{asked} {subject.label}", outcomes)
    wrong = [outcome for outcome in outcomes if outcome.wrong]
    if wrong:
        names = ", ".join(outcome.check for outcome in wrong)
        twins = sum(bool(outcome.same_as) for outcome in wrong)
        reasons = "one reason" if len(wrong) == twins + 1 else f"{len(wrong) - twins} different reasons"
        causes = f" for {reasons}" if twins else ""
        raise MpmfwError(
            f"{subject.label}: {len(wrong)} of {len(outcomes)} checks went wrong{causes}: {names}"
        )


def _run_with_bounds(arguments: list[str]) -> None:
    """Run the command in another process, whose kernels check every index.

    They have a cache of their own: numba's key does not say which way a kernel was compiled.
    """
    import platformdirs

    root = os.environ.get("NUMBA_CACHE_DIR") or str(platformdirs.user_cache_path("mpmfw") / "kernels")
    environment = {**os.environ, "NUMBA_BOUNDSCHECK": "1", "NUMBA_CACHE_DIR": f"{root}-bounds"}
    command = [sys.executable, "-m", "mpmfw", "check", *arguments]
    done = subprocess.run(command, env=environment, check=False)
    if done.returncode > 0:
        raise typer.Exit(done.returncode)
    if done.returncode < 0:
        name = signal.Signals(-done.returncode).name
        raise MpmfwError(
            f"the process of the checks was ended by {name}, with every index of the kernels checked"
        )


def _kind_of(text: str, kind: str | None) -> Kind:
    """Return the kind that is named, or that of the class, or the only one with a plug-in of this name."""
    from mpmfw.campaigns.measures import names_of_measures
    from mpmfw.plugin.discovery import available, choices, did_you_mean, load
    from mpmfw.scene.specification import parse_specification
    from mpmfw_testing.parametrised import CHECKED
    from mpmfw_testing.subject import kind_of

    plugin = parse_specification(text).name
    for asked in CHECKED:
        if kind == asked:
            return asked
    if kind is not None:
        raise SceneError(f"--kind {kind}: {did_you_mean(kind, CHECKED)}")
    if ":" in plugin and "+" not in plugin:
        return kind_of(load("contact", plugin))
    found = [each for each in CHECKED if plugin in choices(each)]
    if "contact" in found:  # which is made of them
        found = [each for each in found if each not in ("detection", "law")]
    if not found and plugin in names_of_measures():  # bundled ones are announced by no entry point
        return "measure"
    if not found:
        names = [name for each in CHECKED for name in available(each)]
        raise SceneError(f"no plug-in '{plugin}' is installed; {did_you_mean(plugin, names)}")
    if len(found) > 1:
        raise SceneError(
            f"'{plugin}' is the name of plug-ins of several kinds ({', '.join(found)}); say --kind"
        )
    return found[0]


def _table(path: Path) -> dict[str, str]:
    """Return the expected failures of a TOML file, at its top or in a table ``expected_failures``."""
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise SceneError(f"--expected-failures {path}: {error}") from error
    table = document.get("expected_failures", document)
    if not isinstance(table, dict) or not all(isinstance(why, str) for why in table.values()):
        raise SceneError(
            f'--expected-failures {path}: expected lines check-name = "why it must fail", in a table '
            "expected_failures or at the top"
        )
    return table


@contextmanager
def _progress(total: int) -> Iterator[Callable[[Check], None] | None]:
    """Context with a function that shows the name of the running check; None in a pipe."""
    from rich.console import Console

    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    with console.status("") as status:
        begun = iter(range(1, total + 1))
        yield lambda check: status.update(f"{next(begun)}/{total} {check.name}: {check.property}")


def _print(title: str, outcomes: Sequence[Outcome]) -> None:
    rows = [
        {
            "check": outcome.check,
            "outcome": outcome.status,
            "seconds": f"{outcome.seconds:.1f}",
            "what must hold": outcome.statement,
        }
        for outcome in outcomes
    ]
    print_table(rows, labels=("check",), words=("outcome", "what must hold"), title=title)
    for outcome in outcomes:
        if outcome.status != "passed" or outcome.message:
            typer.echo(outcome.report + ("" if outcome.same_as else "\n"))
