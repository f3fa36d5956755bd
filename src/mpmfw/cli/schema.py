"""``mpmfw schema``: the format of scenes for editors and other programs."""

from __future__ import annotations

import json

import typer


def schema() -> None:
    """Print the JSON Schema of scenes, option tables of all installed plug-ins included."""
    from mpmfw.scene import json_schema

    typer.echo(json.dumps(json_schema(), indent=2, ensure_ascii=False))
