"""``mpmfw plugins``, ``schema``, ``new`` and ``check``, which runs the conformance kit on a plug-in."""

from __future__ import annotations

import inspect
import itertools
import json
import os
import re
import signal
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path
from textwrap import indent
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer import Argument, Option

from mpmfw.cli import arguments as args
from mpmfw.cli.tables import outputs_progress, print_table
from mpmfw.errors import MpmfwError, SceneError

if TYPE_CHECKING:
    from mpmfw.plugin.discovery import Kind
    from mpmfw_testing import Check, Outcome


def plugins() -> None:
    """List the installed plug-ins: name, kind, distribution and description.

    A plug-in that cannot be used is BROKEN, with the reason.
    """
    from mpmfw.campaigns.measures import MEASURES
    from mpmfw.plugin.discovery import KINDS, available, distribution_of, load

    rows = []
    for kind in KINDS:
        for name, entry in available(kind).items():
            version = "" if entry.dist is None else entry.dist.version
            try:
                about = first_sentence(load(kind, name).__doc__)
            except SceneError as error:  # one broken plug-in does not hide the others
                about = f"BROKEN: {error}"
            source = f"{distribution_of(entry)} {version}"
            rows.append({"name": name, "kind": kind, "source": source, "about": about})
    for name, measure in MEASURES.items():
        about = first_sentence(measure.__doc__)
        rows.append({"name": name, "kind": "measure", "source": "mpmfw", "about": about})
    print_table(rows, labels=("name",), words=("kind", "source", "about"))


def first_sentence(text: str | None) -> str:
    """Return the first sentence of a docstring, however many lines it takes."""
    paragraph = " ".join(inspect.cleandoc(text or "").partition("\n\n")[0].split())
    found = re.match(r"(.*?[.!?])(?= +[A-Z`]|$)", paragraph)
    return found.group(1) if found else paragraph


def schema() -> None:
    """Print the JSON Schema of scenes, option tables of all installed plug-ins included."""
    from mpmfw.scene import json_schema

    typer.echo(json.dumps(json_schema(), indent=2, ensure_ascii=False))


def new(
    kind: Annotated[str, Argument(metavar="KIND", help="As 'mpmfw plugins' lists them: contact, shape …")],
    name: Annotated[str, Argument(metavar="NAME", help="Name in scenes, such as soft_wall.")],
    into: Annotated[Path, Option(metavar="DIR", help="Folder to write it in.")] = Path(),
) -> None:
    """Write a distribution with a plug-in of KIND called NAME."""
    from mpmfw_testing.templates import write_package

    place = write_package(kind, name, into)
    typer.echo(f"{place}: written; next: pip install -e '{place}[test]' && pytest {place}")


def check(
    plugin: Annotated[
        str,
        Argument(metavar="PLUGIN", help="Plug-in, or module:Class, such as 'penalty(kappa=2)'."),
    ],
    kind: Annotated[
        str | None,
        Option(
            metavar="contact|detection|law|shape|material|load|friction|boundary|output|geometry|measure|reference",
            help="Kind of the plug-in, if several have its name.",
        ),
    ] = None,
    set_: Annotated[
        list[str] | None, Option("--set", metavar="OPTION=VALUE", help="Set an option; repeatable.")
    ] = None,
    only: Annotated[list[str] | None, Option(metavar="CHECK", help="Run this check; repeatable.")] = None,
    expected_failures: Annotated[
        Path | None, Option(metavar="FILE.toml", help="Checks that must fail, and why.")
    ] = None,
    pictures: Annotated[Path, Option(metavar="DIR", help="Folder for pictures.")] = Path("mpmfw-check"),
    save: Annotated[Path | None, Option(metavar="DIR", help="Folder for scenes of counterexamples.")] = None,
    bounds: Annotated[bool, Option("--bounds", help="Check every index of the kernels.")] = False,
    list_: Annotated[bool, Option("--list", help="Print the checks and their bounds, run none.")] = False,
) -> None:
    """Run the conformance kit on PLUGIN; exit status 1 if a check fails unexpectedly.

    Each failure names the property and the smallest counterexample.
    """
    asked = _kind_of(plugin, kind)
    if list_:
        from mpmfw_testing.parametrised import requested

        for each in requested(asked, only)[0]:
            typer.echo(f"{each.name}\n{indent(inspect.getdoc(each.run) or '', '  ')}\n")
        return
    if bounds:
        given: list[tuple[str, Any]] = [("--kind", asked), ("--pictures", pictures)]
        given += [("--expected-failures", expected_failures), ("--save", save)]
        given += [("--set", text) for text in set_ or ()] + [("--only", name) for name in only or ()]
        _run_with_bounds([plugin, *(str(part) for pair in given if pair[1] is not None for part in pair)])
        return
    from mpmfw.scene.override import parse_value
    from mpmfw_testing import examine, subject_of
    from mpmfw_testing.parametrised import requested
    from mpmfw_testing.past_the_end import say_lines
    from mpmfw_testing.searching import hypothesis

    if os.environ.get("NUMBA_BOUNDSCHECK"):
        say_lines()
    hypothesis()  # a missing extra is said before anything is checked
    options = {key: parse_value(text) for key, text in args.assignments(set_).items()}
    subject = subject_of(plugin, asked, options)
    table = {} if expected_failures is None else _table(expected_failures)
    checks, expected = requested(asked, only, table)
    with outputs_progress("checks") as tell:
        begun = itertools.count()

        def progress(_: Check) -> None:
            if tell is not None:
                tell(next(begun), len(checks))

        outcomes = examine(subject, checks, expected, pictures, progress, save)
    _print(f"{asked} {subject.label}", outcomes)
    if wrong := [outcome for outcome in outcomes if outcome.wrong]:
        names = ", ".join(outcome.check for outcome in wrong)
        raise MpmfwError(f"{subject.label}: {len(wrong)} of {len(outcomes)} checks went wrong: {names}")


def _run_with_bounds(arguments: list[str]) -> None:
    """Run the command in another process, whose kernels check every index."""
    import platformdirs

    root = os.environ.get("NUMBA_CACHE_DIR") or str(platformdirs.user_cache_path("mpmfw") / "kernels")
    environment = {**os.environ, "NUMBA_BOUNDSCHECK": "1", "NUMBA_CACHE_DIR": f"{root}-bounds"}
    command = [sys.executable, "-m", "mpmfw", "check", *arguments]
    done = subprocess.run(command, env=environment, check=False)
    if done.returncode > 0:
        raise typer.Exit(done.returncode)
    if done.returncode < 0:
        raise MpmfwError(f"the process of the checks was ended by {signal.Signals(-done.returncode).name}")


def _kind_of(text: str, kind: str | None) -> Kind:
    """Return the kind that is named, or the only one with a plug-in of this name."""
    from mpmfw.campaigns.measures import names_of_measures
    from mpmfw.plugin.discovery import available, choices, did_you_mean, load
    from mpmfw.scene.specification import parse_specification
    from mpmfw_testing.parametrised import CHECKED
    from mpmfw_testing.subject import kind_of

    plugin = parse_specification(text).name
    if kind is not None:
        if kind not in CHECKED:
            raise SceneError(f"--kind {kind}: {did_you_mean(kind, CHECKED)}")
        return CHECKED[CHECKED.index(kind)]
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
        raise SceneError(f"'{plugin}' is a plug-in of several kinds ({', '.join(found)}); name it by --kind")
    return found[0]


def _table(path: Path) -> dict[str, str]:
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise SceneError(f"--expected-failures {path}: {error}") from error
    table = document.get("expected_failures", document)
    if not isinstance(table, dict) or not all(isinstance(why, str) for why in table.values()):
        raise SceneError(f'--expected-failures {path}: expected lines check-name = "why it must fail"')
    return table


def _print(title: str, outcomes: Sequence[Outcome]) -> None:
    columns = ("check", "outcome", "seconds", "what must hold")
    rows = [
        dict(zip(columns, (one.check, one.status, f"{one.seconds:.1f}", one.statement), strict=True))
        for one in outcomes
    ]
    print_table(rows, labels=("check",), words=("outcome", "what must hold"), title=title)
    for outcome in outcomes:
        if outcome.status != "passed" or outcome.message:
            typer.echo(outcome.report + ("" if outcome.same_as else "\n"))
