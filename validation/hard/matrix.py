"""The matrix of scenes by methods and places: what holds, and which limit does not."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import ListedColormap

from mpmfw.plots.style import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mpmfw.validation import CaseRun

#: Limits by the letter that stands for them; every other one is a closed form's.
LETTERS = {"penetration": "P", "energy": "E", "momentum": "M", "friction": "T", "symmetry": "S"}
CLOSED = "C"
#: All holds; energy alone does not; others; no result; not run.
COLOURS = ("#9BD1B5", "#F6D08A", "#E8998D", "#B0A8B9", "#FFFFFF")
SAID = (
    "P penetration, E energy, M momentum, T friction, S symmetry, C closed form. Green: all that is asked holds,\n"
    "yellow: energy alone does not, red: more does not, grey: the run failed. Right of the lines: elsewhere"
)


def matrix(runs: Sequence[CaseRun]) -> Figure:
    """Scenes (rows) by methods as the scene stands, and by the other places of those that run there (columns)."""
    found = {_key(run): run for run in runs}
    scenes = list(dict.fromkeys(scene for scene, _ in found))
    columns = sorted(dict.fromkeys(column for _, column in found), key=_order)
    groups = [contact if version else "" for contact, version in columns]
    kind = np.full((len(scenes), len(columns)), 3)
    figure = new_figure(2, 1, 20.0 + 5.0 * len(scenes))
    axes = figure.subplots()
    for (row, scene), (k, column) in ((a, b) for a in enumerate(scenes) for b in enumerate(columns)):
        run = found.get((scene, column))
        if run is not None:
            kind[row, k] = 0 if not run.broken else 1 if run.broken == ("energy",) else 2
            text = "".join(sorted({LETTERS.get(key, CLOSED) for key in run.broken}))
            axes.text(k, row, text, ha="center", va="center")
    axes.imshow(kind, cmap=ListedColormap(COLOURS), vmin=-0.5, vmax=4.5, aspect="auto")
    axes.set_xticks(range(len(columns)), [_said(column) for column in columns], rotation=40, ha="left")
    axes.set_yticks(range(len(scenes)), scenes)
    axes.set_xticks(np.arange(0.5, len(columns) - 1), minor=True)
    axes.set_yticks(np.arange(0.5, len(scenes) - 1), minor=True)
    axes.grid(which="minor", color="white", linewidth=1.5)
    for k in range(1, len(columns)):
        if groups[k] != groups[k - 1]:
            axes.axvline(k - 0.5, color="black", linewidth=1)
    axes.xaxis.tick_top()
    axes.tick_params(which="both", length=0)
    figure.supxlabel(SAID)
    return figure


def _key(run: CaseRun) -> tuple[str, tuple[str, str]]:
    return run.place.at, (run.method.contact, run.version.at)


def _order(column: tuple[str, str]) -> tuple[bool, str, bool, int]:
    """As the scene stands first, with methods as they come; then by methods, by cells and by places."""
    contact, version = column
    place = version.removeprefix("coarser").removeprefix(", ")
    apart = contact if version else ""
    return bool(version), apart, version.startswith("coarser"), ("", "shifted", "turned", "both").index(place)


def _said(column: tuple[str, str]) -> str:
    contact, version = column
    return version or re.sub(r"\(.*\)", "*", contact)
