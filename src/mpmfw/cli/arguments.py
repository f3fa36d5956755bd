"""Arguments of several commands, their values, and the files that commands write.

Wrong text raises a SceneError, and so does a file that cannot be written, before long work.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from typer import Argument, Option

from mpmfw.errors import SceneError

if TYPE_CHECKING:
    from mpmfw.plugin.discovery import Kind
    from mpmfw.scene import Scene

SceneName: TypeAlias = Annotated[
    str, Argument(metavar="SCENE", help="A TOML file, or the name of a shipped scene.")
]
Contact: TypeAlias = Annotated[
    str | None, Option(metavar="NAME", help="Contact, such as 'penalty(kappa=2)'.")
]
Shape: TypeAlias = Annotated[str | None, Option(metavar="NAME", help="Shape function.")]
Contacts: TypeAlias = Annotated[
    str | None, Option("--contact", metavar="A,B,…", help="Contacts, such as 'none,penalty(kappa=2)'.")
]
Codes: TypeAlias = Annotated[
    str | None,
    Option("--code", metavar="A,B,…", help="Other codes, such as 'newton': simplest and best settings."),
]
Shapes: TypeAlias = Annotated[str | None, Option("--shape", metavar="A,B,…", help="Shape functions.")]
Set: TypeAlias = Annotated[
    list[str] | None,
    Option("--set", metavar="KEY=VALUE", help="Set a key; repeatable."),
]
Trust: TypeAlias = Annotated[
    bool, Option("--trust", help="Import code of files that you trust (module:Class).")
]
Output: TypeAlias = Annotated[Path | None, Option("-o", "--output", metavar="FILE", help="File to write.")]
Force: TypeAlias = Annotated[
    bool,
    Option("--force", help="Replace a result; run past the limits of steps."),
]
Replace: TypeAlias = Annotated[bool, Option("--force", help="Replace files that exist.")]
Checkpoint: TypeAlias = Annotated[
    str | None,
    Option(metavar="TIME", help="Wall time between checkpoints; 10 min by default."),
]
Jobs: TypeAlias = Annotated[
    int | None, Option("-j", "--jobs", min=1, help="Processes at a time, one thread each.")
]
Body: TypeAlias = Annotated[
    str | None, Option(metavar="NAME", help="Measured body; by default from the motion.")
]
Pair: TypeAlias = Annotated[
    str | None, Option(metavar="A-B", help="Measured pair; by default from the motion.")
]
Axis: TypeAlias = Annotated[
    str | None, Option(metavar="NAME", help="Measured axis; by default from the motion.")
]
Repeats: TypeAlias = Annotated[
    int | None, Option(min=1, help="Runs of each combination; the cheapest counts.")
]
Scheduler: TypeAlias = Annotated[
    str | None, Option(metavar="ADDRESS", help="Dask scheduler whose workers run it.")
]
Bodies: TypeAlias = Annotated[
    list[str] | None, Option("--body", metavar="NAME", help="Only this body; repeatable.")
]
Every: TypeAlias = Annotated[int, Option(metavar="N", min=1, help="Each N-th output, and the last.")]
Field: TypeAlias = Annotated[
    str | None, Option(metavar="NAME", help="Field, such as von_mises; a wrong name lists all.")
]
Limits: TypeAlias = Annotated[
    str | None, Option(metavar="LOW,HIGH", help="Ends of the colour scale, in SI units.")
]
Arrows: TypeAlias = Annotated[bool, Option("--arrows", help="Draw contact forces on surface nodes.")]


def workers(jobs: int | None, scheduler: str | None, default: int | None = 1) -> dict[str, Any]:
    """Return a campaign's keywords ``jobs`` and ``executor``."""
    if scheduler is not None and jobs is not None:
        raise SceneError("--jobs: has no effect with --scheduler")
    return {"jobs": None if scheduler is not None else jobs or default, "executor": scheduler}


def assignments(texts: list[str] | None, option: str = "--set") -> dict[str, str]:
    """Return ``KEY=VALUE`` texts as values by key."""
    found: dict[str, str] = {}
    for text in texts or []:
        key, equals, value = (part.strip() for part in text.partition("="))
        if not key or not equals:
            form = "KEY=A,B,…, such as … =0.2,0.1" if option == "--vary" else "KEY=VALUE, such as … =0.2"
            raise SceneError(f"{option} {text}: expected {form.replace('… ', 'grid.cell_size')}")
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

    overrides, said = assignments(set_), dict[str, str]()
    choices: tuple[tuple[Kind, str | None], ...] = (("contact", contact), ("shape", shape))
    for kind, name in choices:
        if name is None:
            continue
        key = f"{kind}.method"
        if key in overrides:
            raise SceneError(f"--{kind} {name}: --set {key} chooses another one; leave one of them out")
        overrides[key], said[key] = written(kind, name, f"--{kind}"), f"--{kind} {name}"
    loaded = load_scene(scene, set=overrides, trust=trust, said=said)
    methods = {
        "contact": loaded.contact.tables if loaded.contact else (),
        "friction": friction_laws(loaded, {}, {}),
        "shape": (loaded.shape.method,),
    }
    check_methods_run(assignments(set_), methods)
    return loaded


def names(text: str | None, kind: Kind) -> list[str] | None:
    """Return the plug-ins between commas, with options, or None if the option is absent."""
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
    """Return ``KEY=A,B,…`` as values by key."""
    from mpmfw.campaigns.grid import given_twice
    from mpmfw.scene.override import parse_value

    found: dict[str, list[Any]] = {}
    for key, text in assignments(texts, "--vary").items():
        values = parse_value(f"[{text}]")
        if not isinstance(values, list):  # bare words and quantities: 2 mm, 1 mm
            values = [parse_value(part.strip()) for part in text.split(",")]
        if not values or "" in values:
            raise SceneError(f"--vary {key}: expected values between commas, such as {key}=0.4,0.2")
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
    if (given := numbers("limits", text)) is None:
        return None
    if len(given) != 2 or not -math.inf < given[0] < given[1] < math.inf:
        raise SceneError(f"--limits {text}: expected two finite numbers, the lower one first")
    return given[0], given[1]


def named(**given: str | None) -> dict[str, str]:
    """Return the options that are given."""
    return {key: name for key, name in given.items() if name is not None}


#: What follows the scene's name in the name of a result of each kind.
_ENDINGS = {"run": "", "compare": "-compare", "choice": "-choose", "stability": "-stability"}


def check_result(path: Path, kind: str, force: bool = False) -> Path:
    """Return the path; a SceneError if results would replace a file without ``force`` or finished runs."""
    from mpmfw.campaigns.store import own_files
    from mpmfw.results.replacing import check_replaceable
    from mpmfw.runs.restart import is_foreign

    check_replaceable(path, kind)
    exists = path.is_file() and path.stat().st_size > 0
    resumable, hint = False, ""
    if kind == "run" and (checkpoint := Path(f"{path}.checkpoint")).exists():
        hint = f", from a run that did not end; mpmfw resume {path} continues it"
        if is_foreign(str(checkpoint)):
            raise SceneError(f"{checkpoint}: is not a checkpoint of a run, for {path}; give another name")
        if not force and not exists:
            text = f"{checkpoint}: is the checkpoint of a run whose results are missing"
            raise SceneError(f"{text}; give another name, or --force to replace it")
    elif kind != "run" and (folder := Path(f"{path}.runs")).exists():
        if not folder.is_dir():
            raise SceneError(f"{folder}: is a file, not a folder of finished runs; give another name")
        resumable = bool(own_files(folder))
    if exists and not force and not resumable:
        raise SceneError(f"{path}: exists already{hint}; give another name, or --force to replace it")
    return path


def result_path(output: Path | None, scene: Scene, kind: str, force: bool) -> Path:
    """Return the path of a scene's results."""
    path = Path(f"{scene.name}{_ENDINGS[kind]}.nc") if output is None else output
    return check_result(path, kind, force)


def new_path(path: Path, force: bool) -> Path:
    """Return the path of a figure, a page or an export, if it can be written."""
    from mpmfw.results.replacing import check_new, check_writable

    return check_new(check_writable(path), force)


def figure_path(path: Path) -> Path:
    """Return the name of a figure's file, by default PNG."""
    if path.suffix.lower() not in ("", ".png", ".pdf", ".svg"):
        raise SceneError(f"{path}: expected a figure whose name ends in .png, .pdf or .svg")
    return path if path.suffix else path.with_suffix(".png")
