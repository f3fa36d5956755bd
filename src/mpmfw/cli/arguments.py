"""Arguments that several commands take, and how their text is read."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from mpmfw.errors import SceneError

if TYPE_CHECKING:
    from mpmfw.plugin.discovery import Kind
    from mpmfw.scene import Scene

SceneArgument: TypeAlias = Annotated[
    str,
    typer.Argument(metavar="SCENE", help="A TOML file, or the name of a shipped scene.", show_default=False),
]
ContactOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--contact",
        metavar="NAME",
        help="Contact strategy, instead of the scene's; with options as in 'penalty(kappa=2)'.",
    ),
]
ShapeOption: TypeAlias = Annotated[
    str | None, typer.Option("--shape", metavar="NAME", help="Shape function, instead of the scene's.")
]
SetOption: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Set a key of the scene, such as grid.cell_size=0.2; repeatable."
    ),
]
TrustOption: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--trust", help="Import the code that a file names as module:Class; only if you trust its author."
    ),
]
OutputOption: TypeAlias = Annotated[
    Path | None, typer.Option("-o", "--output", metavar="FILE", help="File to write.", show_default=False)
]

ForceOption: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--force",
        help="Replace a result of the same kind, and begin a run past the limits of steps and frames.",
    ),
]


CheckpointOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--checkpoint",
        metavar="TIME",
        help="Wall time between two checkpoints, from which 'mpmfw resume' goes on; '10 min' by default, inf for none.",
        show_default=False,
    ),
]
JobsOption: TypeAlias = Annotated[
    int | None,
    typer.Option(
        "-j",
        "--jobs",
        min=1,
        help="Processes at a time, one thread each; 1 is this process itself.",
        show_default=False,
    ),
]
BodyOption: TypeAlias = Annotated[
    str | None,
    typer.Option("--body", metavar="NAME", help="Body that is measured; if left out the motion decides."),
]
PairOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--pair", metavar="A-B", help="Pair of bodies that is measured; if left out the motion decides."
    ),
]
AxisOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--axis", metavar="NAME", help="Axis along which is measured; if left out the motion decides."
    ),
]
RepeatsOption: TypeAlias = Annotated[
    int | None,
    typer.Option(
        "--repeats",
        min=1,
        help="Runs of each combination; if left out short ones are repeated, or as a study says.",
        show_default=False,
    ),
]
SchedulerOption: TypeAlias = Annotated[
    str | None,
    typer.Option("--scheduler", metavar="ADDRESS", help="Dask scheduler whose workers run it instead."),
]


def jobs_of(jobs: int | None, scheduler: str | None, default: int | None = 1) -> int | None:
    """Processes at a time; none beside a scheduler.

    Raises
    ------
    SceneError
        Both are given.
    """
    if scheduler is not None and jobs is not None:
        raise SceneError("--jobs: has no effect with --scheduler, whose workers are as many as they are")
    return None if scheduler is not None else jobs or default


def assignments(texts: list[str] | None, option: str = "--set") -> dict[str, str]:
    """``KEY=VALUE`` texts by key.

    Raises
    ------
    SceneError
        A text has no key or no equals sign, or a key is given twice.
    """
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
    """The scene with what the options choose over it.

    Raises
    ------
    SceneError
        The scene or an option is wrong, or two options choose the same thing.
    """
    from mpmfw.scene import load_scene
    from mpmfw.scene.requested import check_methods_run, friction_laws
    from mpmfw.scene.specification import called, written

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
    try:
        loaded = load_scene(scene, set=overrides, trust=trust)
    except SceneError as error:
        text: dict[str, str] = {kind: f"--{kind} {name}" for kind, name in choices if name is not None}
        raise SceneError(called(str(error), text)) from error
    methods = {
        "contact": loaded.contact.tables if loaded.contact else (),
        "friction": friction_laws(loaded, {}, {}),
        "shape": (loaded.shape.method,),
    }
    check_methods_run(assignments(set_), methods, "--set")
    return loaded


def names(text: str | None, kind: Kind) -> list[str] | None:
    """Plug-ins between commas, each a name or a name with options, or None if the option is absent.

    Raises
    ------
    SceneError
        A name is empty, unknown or given twice; an option is unknown or refused.
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
    """``KEY=A,B,…`` as values by key; commas within brackets and quotes belong to a value."""
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
