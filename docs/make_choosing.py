"""Print the numbers of docs/guide/choosing.md and draw its figure: ``python docs/make_choosing.py``.

Five problems run with five contacts, and the settings that the page names. Two minutes of CPU time."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

import mpmfw
from mpmfw.errors import MpmfwError, ResultsWarning
from mpmfw.plots.style import journal_style

DOCS = Path(__file__).parent
PROBLEMS = DOCS / "problems"
STRONGEST = "bardenhagen(criterion=position,normal=master)"
CONTACTS = ("bardenhagen", STRONGEST, "nairn", "penalty", "lcp")
#: Pressure of a solid shaft in a hub of the same material (Lamé): radii 0.1 and 0.2 m, 0.2 mm too large.
LAME = 210e9 / (1 - 0.3**2) * 0.0002 * (0.2**2 - 0.1**2) / (2 * 0.1 * 0.2**2)
#: Prandtl's pressure over the strength in shear, 10 kPa, and the footing's width [m].
PRANDTL, STRENGTH, WIDTH = 2 + math.pi, 1e4, 1.0


def press_fit(tree: xr.DataTree) -> float:
    """Mean pressure in the shaft, over Lamé's."""
    pressure = mpmfw.field(tree, "in_plane_pressure", body="shaft")
    volume = mpmfw.field(tree, "volume", body="shaft")
    return float((pressure * volume).sum() / volume.sum()) / LAME


def footing(tree: xr.DataTree) -> float:
    """Mean pressure under the footing in the last third of its way, over Prandtl's."""
    force = tree["series"]["reaction"].sel(body="footing", axis="y")
    late = force.isel(time=slice(2 * len(force) // 3, None))
    return abs(float(late.mean())) / (WIDTH * STRENGTH * PRANDTL)


def column(tree: xr.DataTree) -> float:
    """Run-out of 99 % of the sand over the column's width."""
    return (float(mpmfw.field(tree, "position_x", body="sand").quantile(0.99)) - 0.2) / 0.2


SCENES: dict[str, Callable[[xr.DataTree], float]] = {
    "footing": footing,
    "press-fit": press_fit,
    "column-collapse": column,
}


def result(scene: str, contact: str, **settings: Any) -> tuple[float, float]:
    """Return the measure of one of :data:`SCENES`, NaN if the run fails, and the CPU time [s]."""
    try:
        file = PROBLEMS / f"{scene}.toml"
        tree = mpmfw.run(file if file.exists() else scene, contact=contact, set=settings)
    except MpmfwError:
        return math.nan, math.nan
    return SCENES[scene](tree), float(tree.attrs["cpu_time"])


def compared(scene: str, column_: str, contacts: tuple[str, ...]) -> list[float]:
    """Return errors of a shipped scene [%], CPDI."""
    rows = mpmfw.compare(scene, contact=contacts, shape=["cpdi"], jobs=1).mpmfw.table()
    return [float(value) for value in rows[column_]]


def problems() -> dict[str, list[float]]:
    """Return errors [%] by problem, a value for each contact."""
    finer = result("column-collapse", STRONGEST, **{"grid.cell_size": 0.01})[0]
    rows = {
        "impact of two rings\nimpulse over time": compared(
            "colliding-rings-4-a-cell", "impulse_curve_error", CONTACTS
        ),
        "footing on clay\nbearing capacity": [],
        "cylinder that rolls\nand slips: spin": compared("rolling-cylinder-slip", "spin_error", CONTACTS),
        "press fit\npressure": [],
        "column of sand\nrun-out": [],
    }
    for label, scene, expected in zip(
        [name for name, values in rows.items() if not values], SCENES, (1.0, 1.0, finer), strict=True
    ):
        rows[label] = [100 * (result(scene, contact)[0] / expected - 1) for contact in CONTACTS]
    return rows


#: Choice of each problem, by the index of its contact.
CHOICES = (3, 3, 3, 3, 1)
HEADS = ("bardenhagen", "bardenhagen\nposition, master", "nairn", "penalty", "lcp")


def draw(rows: dict[str, list[float]]) -> Figure:
    """Draw errors as a table, coloured by size; frames mark the choice."""
    with journal_style():
        figure = Figure(figsize=(6.9, 3.1), layout="constrained")
        axes = figure.add_subplot()
        for row, values in enumerate(rows.values()):
            for place, value in enumerate(values):
                size = abs(value) if math.isfinite(value) else math.inf
                colour = "#a6d2ec" if size <= 7 else "#f7ecc8" if size <= 20 else "#f2b39b"
                axes.add_patch(Rectangle((place, row), 1, 1, facecolor=colour, edgecolor="white"))
                text = f"{value:+.1f} %".replace("-", "−") if math.isfinite(value) else "fails"
                axes.text(place + 0.5, row + 0.5, text, ha="center", va="center", fontsize=10)
            axes.add_patch(
                Rectangle((CHOICES[row] + 0.03, row + 0.04), 0.94, 0.92, fill=False, linewidth=1.8)
            )
        axes.set(xlim=(0, len(HEADS)), ylim=(len(rows), 0))
        axes.set_xticks(np.arange(len(HEADS)) + 0.5, HEADS, fontsize=9)
        axes.set_yticks(np.arange(len(rows)) + 0.5, rows, fontsize=9)
        axes.tick_params(length=0, top=False, bottom=False, labeltop=True, labelbottom=False)
        axes.spines[:].set_visible(False)
    return figure


#: The footing at twice its speed.
FASTER = [[0.0, 0.0, 0.0], [0.025, 0.0, -0.05], [0.125, 0.0, -0.05]]
SETTINGS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("press-fit", "penalty(kappa=1)", {}),
    ("press-fit", "penalty(kappa=16)", {}),
    ("press-fit", "lcp(recovery=0.1)", {}),
    ("press-fit", "penalty", {"shape.method": "gimp"}),
    ("press-fit", "penalty", {"grid.cell_size": 0.01}),
    ("footing", "penalty", {"bodies.footing.rigid.motion.velocity": FASTER, "time.end": 0.125}),
    ("footing", "penalty", {"grid.cell_size": 0.0625}),
    ("footing", STRONGEST, {"grid.cell_size": 0.0625}),
    ("footing", "penalty", {"bodies.soil.volumetric": "pointwise"}),
    ("column-collapse", STRONGEST, {"contact.friction": 0.3}),
    ("column-collapse", STRONGEST, {"stepping.transfer": "flip", "stepping.pic_fraction": 0.05}),
)


def main() -> None:
    """Print all numbers and write docs/guide/choosing.png."""
    warnings.simplefilter("ignore", ResultsWarning)
    rows = problems()
    for label, values in rows.items():
        print(label.replace("\n", ", "), *(f"{value:+.1f} %" for value in values), sep=" | ")
    for scene, contact, settings in SETTINGS:
        value, seconds = result(scene, contact, **settings)
        print(f"{scene}, {contact}, {settings}: {value:.3f}, {seconds:.1f} s")
    draw(rows).savefig(DOCS / "guide" / "choosing.png", dpi=200, metadata={"Software": None})


if __name__ == "__main__":
    main()
