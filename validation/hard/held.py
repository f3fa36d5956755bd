"""What every scene of the hard suite runs and must hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import criteria
import made
from matrix import matrix
from placing import placed

from mpmfw.validation import Case, CaseRun, Place, Runs, RunSet, Version, methods

#: Penalty contact in its strongest form; what it holds are gates as well.
STRONGEST = "penalty(kappa=16, linear_to=0.03)"
OTHERS = [
    "bardenhagen",
    "bardenhagen(criterion=position, normal=master)",
    "nairn",
    "surfaces+impulse",
    "lcp",
]
#: Every method runs at every place, with every cell.
MOVES: dict[str, dict[str, Any]] = {
    "shifted": {"shift": [0.31, 0.17]},
    "turned": {"turn": 30},
    "both": {"shift": [0.31, 0.17], "turn": 30},
}
COARSER = {"coarser": {"coarser": 1.4}} | {
    f"coarser, {at}": {"coarser": 1.4, **move} for at, move in MOVES.items()
}


def scenes(places: Sequence[Place], set: Mapping[str, Any] | None = None) -> Runs:
    """Return the runs of a field's scenes."""
    return Runs(
        "scenes",
        scene=made.scene,
        methods=[
            *methods(),
            *methods(OTHERS, when="full"),
            *methods([STRONGEST], settings={"safety 0.3": {"time.safety": 0.3}}, bound=True, when="full"),
        ],
        places=places,
        versions=[
            Version(),
            *(
                Version(at, change=placed, args=args, when="full")
                for at, args in {**MOVES, **COARSER}.items()
            ),
        ],
        set={"output.surface": False} if set is None else set,
    )


def held(run: CaseRun) -> None:
    """Record what every scene must hold."""
    at = run.place.at
    for quantity, measure, most, unit in (
        ("deepest penetration", criteria.penetration, 0.1, "cells"),
        ("energy residual", criteria.energy, 0.5, "%"),
        ("momentum made", criteria.momentum, 1e-10, "1"),
    ):
        run.gate(f"{at}: {quantity}", run.of(measure), tolerance=(0.0, most), unit=unit, key=measure.__name__)


def scores(case: Case, runs: RunSet) -> None:
    """Record of each method how many scenes, places and cells it holds, and at what cost; draw the
    matrices.
    """
    for method, same in runs.by_method():
        for place in dict.fromkeys(run.place.at for run in same):
            here = [run for run in same if run.place.at == place]
            quantity = f"{place}: places and cells at which all holds, of 8"
            case.gate(quantity, criteria.placed_well(here), tolerance=(8.0, 8.0), method=method, binds=False)
        for quantity, measure, unit in (
            ("scenes, places and cells at which all holds", criteria.share_held, "%"),
            ("scenes as they stand in which all holds", criteria.hold, "1"),
            ("largest dissipation of all scenes as they stand", criteria.largest_dissipation, "%"),
            ("CPU time of all scenes as they stand", criteria.cost, "s"),
        ):
            case.gate(quantity, same.of(measure), unit=unit, method=method)
    case.figure("", matrix(runs.only("penalty*", "lcp*")))
    case.figure("others", matrix(runs.only("bardenhagen*", "nairn*", "surfaces+impulse*")))
