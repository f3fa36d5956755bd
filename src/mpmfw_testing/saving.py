"""A counterexample as files: its scene, and the program that runs it with the plug-in."""

from __future__ import annotations

import contextvars
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mpmfw.scene.toml_text import toml_text
from mpmfw_testing.check import Violation, shown
from mpmfw_testing.subject import Subject

#: Scene that the kit ran last: of a search, whose last case is the smallest, that of the counterexample.
_last: contextvars.ContextVar[tuple[dict[str, Any], int] | None] = contextvars.ContextVar(
    "scene", default=None
)


#: Kinds whose checks run no scene that names the plug-in, or none that a simulation is given.
NO_PROGRAM = ("material", "friction", "geometry", "measure", "reference")


def remember(mapping: Mapping[str, Any], steps: int) -> None:
    """Say which scene the kit runs now, and for how many steps."""
    _last.set((dict(mapping), steps))


def forget() -> None:
    """Say that no scene was run yet."""
    _last.set(None)


def save(folder: Path, name: str, subject: Subject, violation: Violation) -> tuple[Path, ...]:
    """Write the scene that was run last, and a program that runs it; nothing if none was run.

    Parameters
    ----------
    folder
        Made if there is one to write.
    name
        Of the files, without an ending.
    subject
        The plug-in; one that a function makes has no program.
    violation
        What happened in the scene.

    Returns
    -------
    The files.
    """
    last = _last.get()
    if last is None:
        return ()
    mapping, steps = last
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / f"{name}.toml"
    about = [
        violation.message,
        *(f"{key} = {shown(value)}" for key, value in violation.counterexample.items()),
    ]
    comment = "".join(f"# {line}\n" for text in about for line in text.splitlines())
    scene.write_text(comment + toml_text(mapping), encoding="utf-8")
    if subject.plugin is None or subject.kind in NO_PROGRAM:
        return (scene,)
    program = folder / f"{name}.py"
    program.write_text(_program(scene, steps, subject), encoding="utf-8")
    return scene, program


def _program(scene: Path, steps: int, subject: Subject) -> str:
    """Text of the program; the plug-in is made of its class, installed or not."""
    plugin = subject.plugin
    assert plugin is not None
    options = ", ".join(f"{key}={value!r}" for key, value in subject.options.items())
    made = f"{plugin.__qualname__}({options})"
    given = {
        "load": f', loads={{"checked": {made}}}', "contact": f", contact={made}", "shape": f", shape={made}"
    }.get(subject.kind, "")  # fmt: skip
    return (
        f'"""Run {scene.name} with {subject.label}: python {scene.with_suffix(".py").name}"""\n\n'
        "from pathlib import Path\n\n"
        f"from {plugin.__module__} import {plugin.__qualname__.partition('.')[0]}\n"
        "from mpmfw.runs.simulation import Simulation\n\n"
        f'simulation = Simulation(Path(__file__).with_suffix(".toml"){given})\n'
        f"simulation.advance({steps}, lambda frame: print(frame.time, 's', "
        "frame.series['linear_momentum'].tolist()))\n"
    )
