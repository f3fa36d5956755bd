"""``mpmfw plugins``, ``schema`` and ``new``."""

from __future__ import annotations

import inspect
import json
import re
from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from mpmfw.cli.tables import print_table
from mpmfw.errors import SceneError


def plugins() -> None:
    """List the installed plug-ins: name, kind, distribution and description.

    A plug-in that cannot be used is BROKEN, with the reason.
    """
    from mpmfw.campaigns.measures import MEASURES
    from mpmfw.plugin.discovery import KINDS, available, distribution_of, load, unknown_groups

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
    for line in unknown_groups():
        typer.echo(line)


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
