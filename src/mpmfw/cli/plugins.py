"""``mpmfw plugins``: what is installed."""

from __future__ import annotations

from importlib.metadata import EntryPoint
from typing import Any

from mpmfw.cli.tables import print_rows
from mpmfw.discovery import KINDS, Kind, available, distribution_of, load
from mpmfw.errors import SceneError


def plugins() -> None:
    """List the installed plug-ins: name, kind, distribution, version and what each is."""
    print_rows([_row(kind, name, entry) for kind in KINDS for name, entry in available(kind).items()])


def _row(kind: Kind, name: str, entry: EntryPoint) -> dict[str, Any]:
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
