"""The matrix of scenes by methods, places and cells: what holds, and which limit does not."""

import itertools
import re
from collections.abc import Sequence

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from mpmfw.plots.style import new_figure
from mpmfw.validation import CaseRun

#: Limits by the letter that stands for them; every other one is a closed form's.
LETTERS = {"penetration": "P", "energy": "E", "momentum": "M", "friction": "T", "symmetry": "S"}
CLOSED = "C"
#: All holds; energy alone does not; others; no result.
COLOURS = ("#9BD1B5", "#F6D08A", "#E8998D", "#B0A8B9")
SAID = (
    "P penetration, E energy, M momentum, T friction, S symmetry, C closed form. Green: all that is asked "
    "holds,\n"
    "yellow: energy alone does not, red: more does not, grey: the run failed"
)


def matrix(runs: Sequence[CaseRun]) -> Figure:
    """Scenes (rows) by methods, and for each of them by places and cells (columns)."""
    found = {(run.place.at, (run.method.contact, run.version.at)): run for run in runs}
    scenes = list(dict.fromkeys(scene for scene, _ in found))
    contacts = list(dict.fromkeys(contact for _, (contact, _) in found))
    versions = sorted(dict.fromkeys(version for _, (_, version) in found), key=_order)
    columns = list(itertools.product(contacts, versions))
    kind = np.full((len(scenes), len(columns)), 3)
    figure = new_figure(2, 1, 27.0 + 5.0 * len(scenes))
    axes = figure.subplots()
    for (row, scene), (k, column) in itertools.product(enumerate(scenes), enumerate(columns)):
        run = found.get((scene, column))
        if run is not None:
            kind[row, k] = 0 if not run.broken else 1 if run.broken == ["energy"] else 2
            text = "".join(sorted({LETTERS.get(key, CLOSED) for key in run.broken}))
            axes.text(k, row, text, ha="center", va="center")
    axes.imshow(kind, cmap=ListedColormap(COLOURS), vmin=-0.5, vmax=len(COLOURS) - 0.5, aspect="auto")
    axes.set_xticks(range(len(columns)), [version or "as it stands" for _, version in columns], rotation=90)
    axes.set_yticks(range(len(scenes)), scenes)
    axes.set_xticks(np.arange(0.5, len(columns) - 1), minor=True)
    axes.set_yticks(np.arange(0.5, len(scenes) - 1), minor=True)
    axes.grid(which="minor", color="white", linewidth=1.5)
    axes.xaxis.tick_top()
    axes.tick_params(which="both", length=0)
    for k, contact in enumerate(contacts):
        if k:
            axes.axvline(k * len(versions) - 0.5, color="black", linewidth=1)
        middle = (k + 0.5) * len(versions) - 0.5
        name = re.sub(r"\(.*\)", "*", contact)
        place = ((middle, 1.0), (0, 66), ("data", "axes fraction"), "offset points")
        axes.annotate(name, *place, ha="center", fontweight="bold")
    figure.supxlabel(SAID)
    return figure


def _order(version: str) -> tuple[bool, int]:
    """By cells and by places."""
    place = version.removeprefix("coarser").removeprefix(", ")
    return version.startswith("coarser"), ("", "shifted", "turned", "both").index(place)
