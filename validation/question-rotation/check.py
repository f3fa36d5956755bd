"""Rotational inertia by local spin, exact, lumped and local: rolling over grid offsets and cell sizes."""

# cost: 230

from __future__ import annotations

import numpy as np
from drawing import draw
from questions import SERIES_ONLY
from rolling import NO_SLIP, SLIP, Roll, lumping_loss, measures, motion_of

from mpmfw.validation import Case, Method

ROTATIONS = ("spin", "exact", "lumped", "local")
#: Converged elastic cylinder against the rigid one [%], as in ``rolling-convergence``.
ELASTIC = {("no slip", "acceleration"): -0.2, ("slip", "angular acceleration"): -1.25}
#: How far the local spin correction may be from the exact one [% of the rigid value].
CLOSE = {"acceleration": 0.3, "angular acceleration": 0.5}
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
    """Both rolls at the paper's cell size and two offsets, and at half of it."""
    found: Found = {}
    if case.quick:
        for rotation in ROTATIONS[:3]:
            _run(case, found, NO_SLIP, rotation, COARSE, OFFSETS[0])
        _close(case, found)
    else:
        for rotation in ROTATIONS:
            for offset in OFFSETS:
                _run(case, found, NO_SLIP, rotation, CELL, offset)
                _run(case, found, SLIP, rotation, CELL, offset)
            _run(case, found, NO_SLIP, rotation, COARSE, OFFSETS[0])
            _run(case, found, NO_SLIP, rotation, HALF, OFFSETS[0])
        for rotation in ROTATIONS[:2]:
            _run(case, found, SLIP, rotation, HALF, OFFSETS[0])
        _statements(case, found)
        _close(case, found)
    case.figure("", draw(found))


def _run(
    case: Case, found: Found, roll: Roll, rotation: str, cell: float, offset: tuple[float, float]
) -> None:
    lower = [-1.6 - offset[0] * cell, -1.6 - offset[1] * cell]
    values = {**SERIES_ONLY, "grid.cell_size": cell, "grid.lower": lower}
    label = {"": {}} if rotation == "spin" else {rotation: {"bodies.cylinder.rotation": rotation}}
    for method, tree in case.runs(case.methods(settings=label), roll.scene, values):
        errors = measures(motion_of(tree), roll)
        kept = found.setdefault((roll.name, rotation, cell), {name: [] for name in NAMES})
        at = f"{roll.name}, h = {cell:g} m, offset ({offset[0]:g}, {offset[1]:g}) h"
        for name, what in NAMES.items():
            kept[name].append(errors[name])
            elastic = ELASTIC.get((roll.name, name))
            against = 0.0 if elastic is None else f"rigid 0 %, elastic {elastic:+g} %"
            case.show(f"{at}: {what}, error", errors[name], unit="%", reference=against, method=method)


def _close(case: Case, found: Found) -> None:
    """That the local spin correction, which is causal, rolls as the exact one, which is not."""
    for (roll, rotation, cell), errors in found.items():
        if rotation != "spin" or (roll, "exact", cell) not in found:
            continue
        for name, limit in CLOSE.items():
            apart = np.subtract(errors[name], found[roll, "exact", cell][name])
            worst = float(apart[np.argmax(np.abs(apart))])
            what = f"{roll}, h = {cell:g} m: {NAMES[name]}, spin less exact"
            case.gate(what, worst, within=(-limit, limit), unit="%", reference=0.0)


def _statements(case: Case, found: Found) -> None:
    """What lumping costs without slip, beside ε/3, and that the corrections are closer to the rigid cylinder."""
    for cell in (COARSE, CELL, HALF):
        runs = {rotation: found.get(("no slip", rotation, cell)) for rotation in ROTATIONS}
        means = {
            rotation: float(np.mean(errors["acceleration"])) for rotation, errors in runs.items() if errors
        }
        closed = 100.0 * float(lumping_loss(cell, 0.5 * cell)) / 3.0
        for rotation in ("spin", "exact", "local"):
            gained = means.get(rotation, np.nan) - means.get("lumped", np.nan)
            what = f"no slip, h = {cell:g} m: acceleration gained over lumped"
            case.show(
                what,
                gained,
                unit="%",
                reference=f"ε/3 = {closed:.3g} %",
                method=Method("penalty", "cpdi", {}, "" if rotation == "spin" else rotation),
            )
    for rotation in ("spin", "exact"):
        for name in ("displacement", "acceleration"):
            mended, lumped = (
                float(np.max(np.abs(found["no slip", how, CELL][name]))) for how in (rotation, "lumped")
            )
            what = f"no slip, h = {CELL:g} m: {NAMES[name]}, error of {rotation} over that of lumped"
            case.gate(what, mended / lumped, within=(0.0, 0.5), reference="below 1")
