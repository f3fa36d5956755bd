"""``mpmfw plugins``: what is installed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from mpmfw.cli.tables import print_rows
from mpmfw.errors import SceneError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from mpmfw.discovery import Kind


def plugins() -> None:
    """List the installed plug-ins: name, kind, distribution, version and what each is."""
    from mpmfw.discovery import KINDS, available, unknown_groups

    print_rows([_row(kind, name, entry) for kind in KINDS for name, entry in available(kind).items()])
    for line in unknown_groups():
        typer.echo(line)


def _row(kind: Kind, name: str, entry: EntryPoint) -> dict[str, Any]:
    from mpmfw.discovery import distribution_of, load

    version = "" if entry.dist is None else entry.dist.version
    try:
        about = (load(kind, name).__doc__ or "").strip().partition("\n")[0]
    except SceneError as error:  # one broken plug-in does not hide the others
        about = f"BROKEN: {error}"
    return {
        "name": name,
        "kind": kind,
        "distribution": distribution_of(entry),
        "version": version,
        "about": about,
    }
