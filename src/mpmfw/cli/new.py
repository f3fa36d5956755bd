"""``mpmfw new``: the beginning of a plug-in of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeAlias

import typer

KindArgument: TypeAlias = Annotated[
    str,
    typer.Argument(
        metavar="KIND",
        help="contact, law, detection, shape, material, load, boundary, output, friction, geometry, measure or reference.",
    ),
]
NameArgument: TypeAlias = Annotated[
    str, typer.Argument(metavar="NAME", help="What scenes will call it, such as soft_wall.")
]
FolderOption: TypeAlias = Annotated[
    Path, typer.Option(metavar="DIR", help="Folder that the distribution's folder is made in.")
]


def new(kind: KindArgument, name: NameArgument, into: FolderOption = Path()) -> None:
    """Write a distribution with a plug-in of KIND called NAME that passes its tests, to be filled with a method of one's own."""
    from mpmfw_testing.templates import write_package

    place = write_package(kind, name, into)
    typer.echo(f"{place}: written; next: pip install -e '{place}[test]' && pytest {place}")
