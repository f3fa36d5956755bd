"""Question: contact at surface nodes or at quadrature points."""

# cost: 360

from __future__ import annotations

import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from impacts import energy_gained
from quadrature import PlainSprings, Quadrature
from questions import BLOCK, STRESS, cost_of, points_of
from rolling import NO_SLIP, SERIES_ONLY, measures, motion_of

import mpmfw
from mpmfw.errors import ResultsWarning, SimulationError
from mpmfw.validation import Case, Method

FOLDER = Path(__file__).parents[1]
sys.path += [str(FOLDER / name) for name in ("contact-corner", "question-two-pass", "hertz", "hard")]
from criteria import energy, penetration  # noqa: E402
from expansion import PLACES, expansion_of, placed  # noqa: E402
from plain import SCENES  # noqa: E402
from pressure import of_forces  # noqa: E402
from sliding import acceleration_error  # noqa: E402

from mpmfw.contact.surfaces import Surfaces  # noqa: E402
from mpmfw_contact.penalty import Penalty  # noqa: E402

OFFSETS = (0.0, 0.23, 0.5, 0.75)  #: of the block's left side past a grid line [cells]
IMPACTS, OTHERS, FEW = 200, 40, 6  #: random impacts of nodes, of other variants, and in the quick version
GAIN = 0.3  #: of energy by an impact, at most [%]
PLAIN = PlainSprings.joined_with(Quadrature)
VARIANTS: dict[str, Any] = {
    "nodes": Penalty,
    "nodes, no rules for changes": PlainSprings.joined_with(Surfaces),
    "1 point": lambda: PLAIN(points=1),
    "2 points": lambda: PLAIN(points=2),
    "3 points": lambda: PLAIN(points=3),
    "3 points, one pass": lambda: PLAIN(points=3, passes="one"),
}
QUICK = ("nodes", "2 points")  #: the quick version, and the scenes where no rule is at stake or many are
#: Scenes of the suite ``hard`` with sharp corners.
SHARP = ("spikes", "spike-in-wedge", "spike-in-hole", "cliff-edges", "vertex-on-vertex", "golf-ball", "slot")
#: Cells of the Hertz contact [m] and the tolerance to which it settles.
HERTZ = {0.06: 1e-3, 0.05: 5e-4}


def test_question_points_on_surfaces(case: Case) -> None:
    """Every variant. What nodes gain without their rules is shown."""
    for name in QUICK if case.quick else VARIANTS:
        method = Method("penalty", "cpdi", label="" if name == "nodes" else name)
        _impacts(case, method, name)
        found = points_of(_run(name, STRESS)).oscillation()
        case.show("contact-stress: largest departure of σ_yy", found, unit="%", reference=0.0, method=method)
        if not case.quick:
            _corner(case, method, name)
            _motions(case, method, name)
        if name in QUICK and not case.quick:
            _hertz(case, method, name)
            _hard(case, method, name)


def _run(name: str, scene: Any, values: dict[str, Any] | None = None) -> Any:
    place = (
        str(FOLDER / "question-two-pass" / scene)
        if isinstance(scene, str) and scene.startswith("..")
        else scene
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResultsWarning)
        return mpmfw.run(place, contact=VARIANTS[name](), set=values)


def _impacts(case: Case, method: Method, name: str) -> None:
    count = FEW if case.quick else IMPACTS if name == "nodes" else OTHERS
    gained = np.array([energy_gained(seed, VARIANTS[name]()) for seed in range(count)])
    met = gained[np.isfinite(gained)]
    case.show("impacts: pairs that met", float(len(met)), method=method)
    case.show("impacts: pairs that gain more", float((met > GAIN).sum()), method=method)
    gains = {
        "tolerance": (-100.0, GAIN),
        "unit": "%",
        "method": method,
        "binds": name != "nodes, no rules for changes",
    }
    case.gate("impacts: largest gain of energy", float(met.max()), **gains)


def _corner(case: Case, method: Method, name: str) -> None:
    for offset in OFFSETS:
        tree = _run(name, str(FOLDER / "contact-corner" / "scene.toml"), placed(0.5e-3, offset))
        expansion = expansion_of(tree)
        worst = max((expansion.slope_error(height) for height in PLACES.values()), key=abs)
        quantity = f"contact-corner, side at {offset:g} h: worst slope, error"
        case.show(quantity, worst, 0.0, (-5.0, 5.0), "%", method)


def _motions(case: Case, method: Method, name: str) -> None:
    series = _run(name, BLOCK, {"output.particles": False})["series"].to_dataset()
    error = acceleration_error(series)
    case.show("sliding block: fitted acceleration, error", error, unit="%", reference=0.0, method=method)
    tree = _run(name, NO_SLIP.scene, SERIES_ONLY)
    found = measures(motion_of(tree), NO_SLIP)
    for quantity in ("displacement", "spin"):
        case.show(f"rolling, no slip: {quantity}, error", found[quantity], 0.0, unit="%", method=method)
    cost = cost_of(tree)
    quantity = "rolling, no slip: CPU time of a step"
    case.show(quantity, 1e3 * cost["cpu"] / cost["steps"], unit="ms", method=method)


def _hertz(case: Case, method: Method, name: str) -> None:
    for cell, tolerance in HERTZ.items():
        settings = {"grid.cell_size": cell, "settle.tolerance": tolerance}
        found = of_forces(_run(name, str(FOLDER / "hertz" / "scene.toml"), settings))
        for key, unit, limit in (("peak", "%", 10.0), ("fitted peak", "%", 10.0), ("width", "h", 1.0)):
            quantity = f"hertz, h = {cell:g} m: {key}, error"
            case.show(quantity, found[key], 0.0, (-limit, limit), unit, method)


def _hard(case: Case, method: Method, name: str) -> None:
    """Record plain scenes of the suite ``hard``, with their limits of penetration."""
    for scene, mapping in sorted(SCENES.items()):
        deepest = 0.2 if scene in SHARP else 0.1
        try:
            tree = _run(name, mapping)
        except SimulationError as error:
            case.failed(method, str(error), False, scene)
            continue
        for key, unit, measure, most in (
            ("penetration", "cells", penetration, deepest),
            ("energy", "%", energy, 0.5),
        ):
            value = measure(tree)
            case.show(f"{scene}: {key}", value, tolerance=(0.0, most), unit=unit, method=method)
