"""What every scene of the hard suite runs and must hold."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import closed
import criteria
import made
import plain
from placing import placed

from mpmfw.validation import CLASSICAL, Case, CaseRun, Place, Runs, by_method, full, methods, together

#: Penalty contact with its best settings, which gates bind as well.
STRONGEST = "penalty(kappa=16, linear_to=0.03)"
OTHERS = [*CLASSICAL, "nairn", "surfaces+impulse", "lcp"]
#: Every method runs a scene as it stands, and once more so.
MOVED: dict[str, Any] = {"shift": [0.31, 0.17], "turn": 30, "coarser": 1.4}
#: Limits of a scene with sharp corners, whose last node bears all.
SHARP = {"penetration": (0.0, 0.2)}
#: Gates of several cases: quantity, function, limits and unit; the function's name is the gate's key.
FRICTION = ("T/(mu N)", criteria.friction, (0.0, 1.0001), "1")
SYMMETRY = ("departure from mirror symmetry", criteria.symmetry, (0.0, 1e-6), "cells")
RESTS = ("drift at rest", closed.rests, (0.0, 0.01), "cells")
EVERYWHERE = (
    ("deepest penetration", criteria.penetration, (0.0, 0.1), "cells"),
    ("energy residual", criteria.energy, (0.0, 0.5), "%"),
    ("momentum made", criteria.momentum, (0.0, 1e-10), "1"),
)


def place(
    at: str,
    scene: Mapping[str, Any] | Callable[..., Any] = made.scene,
    sharp: bool = False,
    misses: Mapping[str, Any] | None = None,
    set: Mapping[str, Any] | None = None,
    when: str = "full",
    **make: Any,
) -> Place:
    """Return a scene of a field; ``make`` are the arguments of its function.

    ``misses``: limits, by key, that penalty contact with CPDI does not hold today, with the reason, or with
    reasons by method. They are shown and decide nothing.
    """
    reasons = misses or {}
    shown = {key: {"penalty, cpdi": why} if isinstance(why, str) else why for key, why in reasons.items()}
    return Place(at, set or {}, {"scene": scene, **make}, SHARP if sharp else {}, shown, when)


def built(scene: Any, turned: bool = False, **make: Any) -> Any:
    """Return the scene of a place, once more as MOVED if ``turned``."""
    given = scene(**make) if callable(scene) else scene
    return placed(given, **MOVED) if turned else given


def shared(
    name: str, sharp: bool = False, misses: Mapping[str, Any] | None = None, when: str = "full"
) -> Place:
    """Return a scene of :mod:`plain`, which other cases run as well."""
    return place(name, plain.SCENES[name], sharp, misses, when=when)


def scenes(places: Sequence[Place], set: Mapping[str, Any] | None = None) -> Runs:
    """Return the runs of a field's scenes."""
    strongest = methods([STRONGEST], settings={"safety 0.3": {"time.safety": 0.3}}, bound=True, when="full")
    twice = []
    for one in places:
        moved = {"make": {**one.make, "turned": True}, "open": {**one.open, "run": "it is moved"}}
        twice += [one, replace(one, when="full", **moved)]
    return Runs(
        "scenes",
        scene=built,
        methods=[*methods(), *methods(OTHERS, when="full"), *strongest],
        places=twice,
        set={"output.surface": False} if set is None else set,
    )


def held(run: CaseRun, *gates: tuple[Any, ...]) -> None:
    """Record what every scene must hold, and further gates, where it stands; ``run.broken``: keys missed."""
    run.broken = []
    for quantity, measure, tolerance, unit in (*EVERYWHERE, *gates):
        value, key = run.of(measure), measure.__name__
        most = run.place.within.get(key, tolerance)
        least, most = most if isinstance(most, tuple) else (-most, most)
        if value is not None and not least <= value <= most:
            run.broken.append(key)
        if not criteria.turned(run):
            run.gate(f"{run.place.at}: {quantity}", value, "", tolerance, unit, key=key)


def scored(every: Runs) -> Callable[[Case, list[CaseRun]], None]:
    """Return the test that records how much each method holds, which limits it breaks, and at what cost."""

    @full
    @together(every)
    def test(case: Case, runs: list[CaseRun]) -> None:
        for method, same in by_method(runs):
            for place in dict.fromkeys(run.place.at for run in same):
                here = [run for run in same if run.place.at == place]
                quantity = f"{place}: ways to place it in which all holds, of 2"
                broken = ", ".join(sorted({key for run in here for key in run.broken}))
                case.gate(quantity, criteria.placed_well(here), broken, (2.0, 2.0), "", method, binds=False)
            for quantity, measure, unit in (
                ("scenes in both ways in which all holds", criteria.share_held, "%"),
                ("scenes as they stand in which all holds", criteria.hold, "1"),
                ("largest dissipation of all scenes as they stand", criteria.largest_dissipation, "%"),
                ("CPU time of all scenes as they stand", criteria.cost, "s"),
            ):
                case.gate(quantity, measure(same), unit=unit, method=method)

    return test
