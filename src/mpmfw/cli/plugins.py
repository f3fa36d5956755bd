"""``mpmfw plugins``: what is installed."""

from __future__ import annotations

import inspect
import re
from typing import TYPE_CHECKING, Any

import typer

from mpmfw.cli.tables import print_rows
from mpmfw.errors import SceneError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from mpmfw.plugin.discovery import Kind


def plugins() -> None:
    """List the installed plug-ins: name, kind, the distribution that each comes from, and what it is.

    One that cannot be used says why: BROKEN. Measures that mpmfw registers itself are listed as well.
    """
    from mpmfw.campaigns.measures import MEASURES
    from mpmfw.plugin.discovery import KINDS, available, unknown_groups

    rows = [_row(kind, name, entry) for kind in KINDS for name, entry in available(kind).items()]
    own = [
        _said("measure", name, "mpmfw", first_sentence(measure.__doc__)) for name, measure in MEASURES.items()
    ]
    print_rows([*rows, *own])
    for line in unknown_groups():
        typer.echo(line)


def first_sentence(text: str | None) -> str:
    """The first sentence of a docstring, whole, however many lines it takes."""
    paragraph = " ".join(inspect.cleandoc(text or "").partition("\n\n")[0].split())
    found = re.match(r"(.*?[.!?])(?= +[A-Z`]|$)", paragraph)
    return found.group(1) if found else paragraph


def _row(kind: Kind, name: str, entry: EntryPoint) -> dict[str, Any]:
    from mpmfw.plugin.discovery import distribution_of, load

    version = "" if entry.dist is None else entry.dist.version
    try:
        about = first_sentence(load(kind, name).__doc__)
    except SceneError as error:  # one broken plug-in does not hide the others
        about = f"BROKEN: {error}"
    return _said(kind, name, f"{distribution_of(entry)} {version}", about)


def _said(kind: str, name: str, source: str, about: str) -> dict[str, Any]:
    return {"name": name, "kind": kind, "source": source, "about": about}
