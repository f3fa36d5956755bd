"""Rotational inertia exact, lumped and local: rolling over grid offsets and cell sizes."""

# cost: 110

from __future__ import annotations

import numpy as np
from drawing import draw
from questions import SERIES_ONLY
from rolling import NO_SLIP, SLIP, Roll, lumping_loss, measures, motion_of

from mpmfw.validation import Case, Method

ROTATIONS = ("exact", "lumped", "local")
#: Of the grid's origin against the bodies, in cells.
OFFSETS = ((0.0, 0.0), (0.37, 0.21))
CELL, COARSE, HALF = 0.4, 0.8, 0.2  #: [m]
NAMES = {
    "displacement": "displacement at 10 m",
    "acceleration": "fitted acceleration",
    "spin": "spin at 10 m",
    "angular acceleration": "fitted angular acceleration",
}

#: Errors [%] by name, of every offset; keyed by roll, rotation and cell size.
Found = dict[tuple[str, str, float], dict[str, list[float]]]


def check(case: Case) -> None:
    """Both rolls at the paper's cell size and two offsets, and without slip at half of it."""
    found: Found = {}
    if case.quick:
        for rotation in ROTATIONS[:2]:
            _run(case, found, NO_SLIP, rotation, COARSE, OFFSETS[0])
    else:
        for rotation in ROTATIONS:
            for offset in OFFSETS:
                _run(case, found, NO_SLIP, rotation, CELL, offset)
                _run(case, found, SLIP, rotation, CELL, offset)
            _run(case, found, NO_SLIP, rotation, COARSE, OFFSETS[0])
            _run(case, found, NO_SLIP, rotation, HALF, OFFSETS[0])
        _statements(case, found)
    case.figure("", draw(found))


def _run(
    case: Case, found: Found, roll: Roll, rotation: str, cell: float, offset: tuple[float, float]
) -> None:
    lower = [-1.6 - offset[0] * cell, -1.6 - offset[1] * cell]
    values = {**SERIES_ONLY, "grid.cell_size": cell, "grid.lower": lower}
    label = {"": {}} if rotation == "exact" else {rotation: {"bodies.cylinder.rotation": rotation}}
    for method, tree in case.runs(case.methods(settings=label), roll.scene, values):
        errors = measures(motion_of(tree), roll)
        kept = found.setdefault((roll.name, rotation, cell), {name: [] for name in NAMES})
        at = f"{roll.name}, h = {cell:g} m, offset ({offset[0]:g}, {offset[1]:g}) h"
        for name, what in NAMES.items():
            kept[name].append(errors[name])
            case.show(f"{at}: {what}, error", errors[name], unit="%", reference=0.0, method=method)


def _statements(case: Case, found: Found) -> None:
    """What lumping costs without slip, beside ε/3, and that both corrections are closer to the rigid cylinder."""
    for cell in (COARSE, CELL, HALF):
        runs = {rotation: found.get(("no slip", rotation, cell)) for rotation in ROTATIONS}
        means = {
            rotation: float(np.mean(errors["acceleration"])) for rotation, errors in runs.items() if errors
        }
        closed = 100.0 * float(lumping_loss(cell, 0.5 * cell)) / 3.0
        for rotation in ("exact", "local"):
            gained = means.get(rotation, np.nan) - means.get("lumped", np.nan)
            what = f"no slip, h = {cell:g} m: acceleration gained over lumped"
            case.show(
                what,
                gained,
                unit="%",
                reference=f"ε/3 = {closed:.3g} %",
                method=Method("penalty", "cpdi", {}, rotation),
            )
    for name in ("displacement", "acceleration"):
        exact, lumped = (
            float(np.max(np.abs(found["no slip", rotation, CELL][name]))) for rotation in ("exact", "lumped")
        )
        what = f"no slip, h = {CELL:g} m: {NAMES[name]}, error of exact over that of lumped"
        case.gate(what, exact / lumped, within=(0.0, 0.5), reference="below 1")
