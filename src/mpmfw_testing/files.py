"""A counterexample as files: its picture, its scene, and the program that runs it with the plug-in."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path
from typing import Any

from mpmfw.scene.toml_text import toml_text
from mpmfw_testing.check import Check, Violation
from mpmfw_testing.subject import Subject

#: Kinds whose checks run no scene that names the plug-in, or none that a simulation is given.
NO_PROGRAM = ("material", "friction", "geometry", "measure", "reference")


def draw(folder: Path, subject: Subject, check: Check, violation: Violation) -> Path | None:
    """Write the picture of a violation, with the numbers of its case below; None if there is none."""
    if violation.picture is None:
        return None
    from mpmfw.plots.style import journal_style, new_figure

    path = folder / f"{_file_name(subject, check)}.png"
    with journal_style():
        figure = new_figure(1, 1, height=78.0)
        axes: Any = figure.add_subplot()
        violation.picture(axes)
        axes.set_title(f"{subject.label}: {check.name}", loc="left")
        handles, labels = axes.get_legend_handles_labels()
        if axes.get_legend() is not None:
            axes.get_legend().remove()
        if handles:  # above the axes, where it covers nothing
            figure.legend(handles, labels, loc="outside upper left", ncols=2, columnspacing=1.2)
        text = "\n".join(textwrap.wrap("; ".join(violation.numbers), 74))
        figure.supxlabel(text, x=0.02, horizontalalignment="left")
        folder.mkdir(parents=True, exist_ok=True)
        figure.savefig(path)
    return path


def save(folder: Path, subject: Subject, check: Check, violation: Violation) -> tuple[Path, ...]:
    """Write the scene of a violation, and a program that runs it; return the files, none without a scene."""
    mapping = violation.case.scene
    if mapping is None:
        return ()
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / f"{_file_name(subject, check)}.toml"
    lines = [line for text in (violation.message, *violation.numbers) for line in text.splitlines()]
    comment = "".join(f"# {line}\n" for line in lines)
    scene.write_text(comment + toml_text(dict(mapping)), encoding="utf-8")
    if subject.kind in NO_PROGRAM:
        return (scene,)
    program = scene.with_suffix(".py")
    program.write_text(_program(scene, violation.case.steps, subject), encoding="utf-8")
    return scene, program


def _program(scene: Path, steps: int, subject: Subject) -> str:
    """Return the text of the program; the plug-in is made of its class, installed or not."""
    plugin, options = subject.plugin, ", ".join(f"{key}={value!r}" for key, value in subject.options.items())
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


def _file_name(subject: Subject, check: Check) -> str:
    """Return the name of a counterexample's files, without an ending."""
    return re.sub(r"[^\w.=-]+", "-", subject.label).strip("-") + f"-{check.name}"
