"""C_n with and without the Q term of [H17], eq. 7: what it changes in rolling and in the rings."""

# cost: 40

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from drawing import draw
from questions import RINGS_COARSE, SERIES_ONLY
from rings import SCENE, force_of, measures_of, series_of
from rolling import DISTANCE, NO_SLIP, SLIP, Roll, measures, motion_of

from mpmfw.analysis import impulse
from mpmfw.fields import FloatArray
from mpmfw.validation import Case

#: Largest effect on a displacement at the end of the roll [%], from the list of benchmarks' notes.
LIMIT = 0.06
WITH_Q = {"contact.penalty.normal_variation": "hamad2017"}
#: Something that should change nothing: a shorter time step. What it changes is the scatter of a run.
SHORTER = {"time.safety": 0.35}
SOFT = {"contact.penalty.kappa": 0.1}
COARSE = 0.8  #: cells of the quick version [m]


@dataclass(frozen=True)
class Difference:
    """How far a run is from the one it is compared with, over time."""

    time: FloatArray  #: [s]
    values: FloatArray  #: [% of 10 m, or of the total impulse]


def check(case: Case) -> None:
    """Runs in pairs, and with a shorter time step as a measure of their scatter."""
    found: dict[tuple[str, str], Difference] = {}
    for roll in (NO_SLIP,) if case.quick else (NO_SLIP, SLIP):
        _rolling(case, roll, found)
    if not case.quick:
        _rings(case, found)
    case.figure("", draw(found))


def _settings(soft: bool) -> dict[str, dict[str, object]]:
    settings: dict[str, dict[str, object]] = {"": {}, "with Q": WITH_Q, "shorter step": SHORTER}
    if soft:
        settings |= {"kappa 0.1": SOFT, "kappa 0.1, with Q": {**SOFT, **WITH_Q}}
    return settings


def _rolling(case: Case, roll: Roll, found: dict[tuple[str, str], Difference]) -> None:
    values = {**SERIES_ONLY, "grid.cell_size": COARSE} if case.quick else SERIES_ONLY
    motions = {}
    settings = _settings(soft=roll is NO_SLIP and not case.quick)
    for method, tree in case.runs(case.methods(settings=settings), roll.scene, values):
        label, motion = method.label, motion_of(tree)
        motions[label] = motion
        measured = measures(motion, roll)
        for name in ("displacement", "spin"):
            case.show(f"{roll.name}: {name}, error", measured[name], unit="%", reference=0.0, method=method)
        case.show(f"{roll.name}: mean penetration", measured["penetration"], unit="h", method=method)
        beside = "kappa 0.1" if label == "kappa 0.1, with Q" else ""
        if label in ("", "kappa 0.1") or beside not in motions:
            continue
        apart = 100.0 * (motion.displacement - motions[beside].displacement) / DISTANCE
        found[roll.name, label] = Difference(motion.time, apart)
        end = float(np.interp(roll.end, motion.time, apart))
        case.gate(
            f"{roll.name}: change of the displacement at 10 m",
            end,
            within=(-LIMIT, LIMIT),
            unit="%",
            method=method,
            binds=label == "with Q",
        )


def _rings(case: Case, found: dict[tuple[str, str], Difference]) -> None:
    curves = {}
    for method, tree in case.runs(case.methods(settings=_settings(soft=False)), SCENE, RINGS_COARSE):
        time, force = force_of(series_of(tree))
        curves[method.label] = impulse(time, force)
        measured = measures_of(tree)
        case.show(
            "rings: impulse curve, largest error", measured["impulse_curve_error"], unit="%", method=method
        )
        case.show("rings: largest penetration", measured["largest_penetration"], unit="h", method=method)
        if method.label and "" in curves:
            apart = 100.0 * (curves[method.label] - curves[""]) / curves[""][-1]
            found["rings", method.label] = Difference(time, apart)
            largest = float(np.abs(apart).max())
            case.show("rings: largest change of the impulse curve", largest, unit="%", method=method)
