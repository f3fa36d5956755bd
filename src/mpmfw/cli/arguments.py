"""Arguments that several commands take, and how their text is read; wrong text raises a SceneError."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from mpmfw.errors import SceneError

if TYPE_CHECKING:
    from mpmfw.plugin.discovery import Kind
    from mpmfw.scene import Scene

SceneName: TypeAlias = Annotated[
    str, typer.Argument(metavar="SCENE", help="A TOML file, or the name of a shipped scene.")
]
Contact: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="NAME", help="Contact, instead of the scene's; with options as in 'penalty(kappa=2)'."
    ),
]
Shape: TypeAlias = Annotated[
    str | None, typer.Option(metavar="NAME", help="Shape function, instead of the scene's.")
]
Contacts: TypeAlias = Annotated[
    str | None,
    typer.Option("--contact", metavar="A,B,…", help="Contacts, with options as in 'none,penalty(kappa=2)'."),
]
Shapes: TypeAlias = Annotated[str | None, typer.Option("--shape", metavar="A,B,…", help="Shape functions.")]
Set: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Set a key of the scene, such as grid.cell_size=0.2; repeatable."
    ),
]
Trust: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--trust", help="Import the code that a file names as module:Class; only if you trust its author."
    ),
]
Output: TypeAlias = Annotated[
    Path | None, typer.Option("-o", "--output", metavar="FILE", help="File to write.")
]
Force: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--force",
        help="Replace a result of the same kind, and begin a run past the limits of steps and frames.",
    ),
]
Replace: TypeAlias = Annotated[bool, typer.Option("--force", help="Replace files that exist.")]
Checkpoint: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="TIME",
        help="Wall time between two checkpoints, from which 'mpmfw resume' goes on; '10 min' by default, inf "
        "for "
        "none.",
    ),
]
Jobs: TypeAlias = Annotated[
    int | None, typer.Option("-j", "--jobs", min=1, help="Processes at a time, one thread each.")
]
Body: TypeAlias = Annotated[
    str | None, typer.Option(metavar="NAME", help="Body that is measured; if left out the motion decides.")
]
Pair: TypeAlias = Annotated[
    str | None,
    typer.Option(metavar="A-B", help="Pair of bodies that is measured; if left out the motion decides."),
]
Axis: TypeAlias = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Axis along which is measured; if left out the motion decides."),
]
Repeats: TypeAlias = Annotated[
    int | None,
    typer.Option(
        min=1,
        help="Runs of each combination, of which the cheapest is its cost; 1 or the study's if left out.",
    ),
]
Scheduler: TypeAlias = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler whose workers run it instead.")
]
Bodies: TypeAlias = Annotated[
    list[str] | None, typer.Option("--body", metavar="NAME", help="Only this body; repeatable.")
]
Every: TypeAlias = Annotated[int, typer.Option(metavar="N", min=1, help="Only each N-th output.")]
Field: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Field on the material points: von_mises, velocity, stress_xy … A wrong name lists all.",
    ),
]
Limits: TypeAlias = Annotated[
    str | None, typer.Option(metavar="LOW,HIGH", help="Ends of the colour scale, in SI units.")
]
Arrows: TypeAlias = Annotated[
    bool, typer.Option("--arrows", help="Draw contact forces on surface nodes as arrows.")
]


def jobs_of(jobs: int | None, scheduler: str | None, default: int | None = 1) -> int | None:
    """Return the number of processes at a time; None beside a scheduler."""
    if scheduler is not None and jobs is not None:
        raise SceneError("--jobs: has no effect with --scheduler, whose workers are as many as they are")
    return None if scheduler is not None else jobs or default


def assignments(texts: list[str] | None, option: str = "--set") -> dict[str, str]:
    """Return ``KEY=VALUE`` texts as values by key."""
    found: dict[str, str] = {}
    for text in texts or []:
        key, equals, value = (part.strip() for part in text.partition("="))
        if not key or not equals:
            raise SceneError(f"{option} {text}: expected KEY=VALUE, such as grid.cell_size=0.2")
        if key in found:
            raise SceneError(f"{option} {key}: given twice, as {found[key]} and as {value}")
        found[key] = value
    return found


def chosen_scene(
    scene: str, contact: str | None, shape: str | None, set_: list[str] | None, trust: bool
) -> Scene:
    """Load the scene with the methods and keys that the options choose."""
    from mpmfw.scene import load_scene
    from mpmfw.scene.requested import check_methods_run, friction_laws
    from mpmfw.scene.specification import written

    overrides = assignments(set_)
    choices: tuple[tuple[Kind, str | None], ...] = (("contact", contact), ("shape", shape))
    for kind, name in choices:
        if name is None:
            continue
        if f"{kind}.method" in overrides:
            raise SceneError(
                f"--{kind} {name}: --set {kind}.method chooses another one; leave one of them out"
            )
        overrides[f"{kind}.method"] = written(kind, name, f"--{kind}")
    said = {f"{kind}.method": f"--{kind} {name}" for kind, name in choices if name is not None}
    loaded = load_scene(scene, set=overrides, trust=trust, said=said)
    methods = {
        "contact": loaded.contact.tables if loaded.contact else (),
        "friction": friction_laws(loaded, {}, {}),
        "shape": (loaded.shape.method,),
    }
    check_methods_run(assignments(set_), methods, "--set")
    return loaded


def names(text: str | None, kind: Kind) -> list[str] | None:
    """Return the plug-ins between commas, each a name or a name with options, or None if the option is
    absent.
    """
    from mpmfw.scene.specification import split_specifications, written

    if text is None:
        return None
    try:
        found = split_specifications(text)
    except SceneError as error:
        raise SceneError(f"--{kind} {error}") from error
    if not found or not all(found):
        raise SceneError(f"--{kind} {text}: expected names with a comma between them")
    known = [written(kind, name, f"--{kind}") for name in found]
    if len(set(known)) < len(known):
        raise SceneError(f"--{kind} {text}: a name is given twice")
    return known


def variations(texts: list[str] | None) -> dict[str, list[Any]]:
    """Return ``KEY=A,B,…`` as values by key; commas within brackets and quotes belong to a value."""
    from mpmfw.campaigns.grid import given_twice
    from mpmfw.scene.override import parse_value

    found: dict[str, list[Any]] = {}
    for key, text in assignments(texts, "--vary").items():
        values = parse_value(f"[{text}]")
        if not isinstance(values, list):  # bare words and quantities: 2 mm, 1 mm
            values = [parse_value(part.strip()) for part in text.split(",")]
        if not values or "" in values:
            raise SceneError(
                f"--vary {key}: expected values with a comma between them, such as {key}=0.4,0.2"
            )
        for k in given_twice(values):
            raise SceneError(f"--vary {key}: {values[k]} is given twice")
        found[key] = values
    return found


def check_files(files: Sequence[Path]) -> None:
    """Check that every argument is a file, and that none is given twice."""
    for k, one in enumerate(files):
        if one.is_dir():
            raise SceneError(f"{one}: is a folder; give the name of a file")
        if os.path.realpath(one) in [os.path.realpath(other) for other in files[:k]]:
            raise SceneError(f"{one}: given twice")
        if not one.is_file():
            raise SceneError(f"{one}: no such file")


def numbers(option: str, text: str | None) -> list[float] | None:
    """Return numbers between commas, or None if the option is absent."""
    if text is None:
        return None
    try:
        return [float(part) for part in text.split(",")]
    except ValueError as error:
        raise SceneError(f"--{option} {text}: expected numbers with a comma between them") from error


def limits_of(text: str | None) -> tuple[float, float] | None:
    """Return ``LOW,HIGH`` as numbers."""
    given = numbers("limits", text)
    if given is None:
        return None
    if len(given) != 2 or not all(map(math.isfinite, given)):
        raise SceneError(f"--limits {text}: expected two finite numbers with a comma between them")
    low, high = given
    if not low < high:
        raise SceneError(f"--limits {text}: expected the lower number first")
    return low, high


def named(**given: str | None) -> dict[str, str]:
    """Return the options that are given."""
    return {key: name for key, name in given.items() if name is not None}
