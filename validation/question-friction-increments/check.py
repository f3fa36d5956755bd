"""Literal friction increments of [H17] against the return map, over the time step and over μ."""

# cost: 140

from __future__ import annotations

import itertools
import math
from typing import Any

from drawing import Curve, draw
from questions import CYLINDER_MASS, GRAVITY, SERIES_ONLY
from rolling import DISTANCE, NO_SLIP, SLIP, Roll, measures, motion_of
from viscous import displacement_after, viscosity

from mpmfw.validation import Case, Method

#: Without the interface layer, beside which the inertia of rotation is not corrected.
LAWS: dict[str, dict[str, Any]] = {
    "": {"contact.hamad2017.interface_thickness": 0.0},
    "literal": {"contact.hamad2017.interface_thickness": 0.0, "contact.hamad2017.friction_law": "literal"},
}
#: Fractions of the stability limit.
STEPS = {NO_SLIP: (0.1, 0.2, 0.4, 0.8), SLIP: (0.2, 0.4, 0.8)}
QUICK = {NO_SLIP: (0.4, 0.8)}
#: tan θ / 3 = 0.577 divides slip from none at 60°; the least is as good as none.
FRICTIONS = (0.001, 0.1, 0.286, 0.45, 0.8)
TILTS = {NO_SLIP: math.pi / 4.0, SLIP: math.pi / 3.0}
SCATTER = 0.1  #: what the return map's displacement may change by between time steps [%]
VISCOUS = 1.0  #: what the literal law's may be away from that of viscous friction [%]
MODULUS, CELL, SEGMENT = 10e6, 0.4, 0.1  #: M of the cylinder [Pa], h [m], length of a segment [m]


def check(case: Case) -> None:
    """Both laws at every time step, then over μ at one."""
    curves: dict[tuple[str, str], Curve] = {}
    for roll, steps in (QUICK if case.quick else STEPS).items():
        for label, law in LAWS.items():
            for step in steps:
                _run(case, roll, label, law, step, curves)
        _independent(case, roll, curves[roll.name, ""])
        if not case.quick:
            _depends(case, roll, curves[roll.name, "literal"])
    over_friction = {} if case.quick else _over_friction(case)
    case.figure("", draw(curves, over_friction))


def _run(
    case: Case, roll: Roll, label: str, law: dict[str, Any], step: float, curves: dict[tuple[str, str], Curve]
) -> None:
    """One law at one time step; beside the literal law, what a viscous friction of the same size would do."""
    values = {**SERIES_ONLY, **law, "time.safety": step, "output.stability": True}
    name = ", ".join(filter(None, (label, f"safety {step:g}")))
    method = Method("hamad2017", "cpdi", {}, name)
    for _, tree in case.runs([method], roll.scene, values):
        series = tree["series"].to_dataset()
        found = measures(motion_of(tree), roll)
        time_step = float(series["time_step"][1:].mean())
        for quantity in ("displacement", "acceleration", "spin"):
            case.show(
                f"{roll.name}: {quantity}, error", found[quantity], unit="%", reference=0.0, method=method
            )
        curves.setdefault((roll.name, label), {})[step] = (1e3 * time_step, found["displacement"])
        if label:
            width = float(series["contact_count"][1:].mean()) * SEGMENT
            drag = viscosity(MODULUS, width, CELL, time_step)
            moved = displacement_after(roll.end, drag, CYLINDER_MASS, GRAVITY, TILTS[roll])
            error = 100.0 * (moved / DISTANCE - 1.0)
            case.show(f"{roll.name}: displacement, error of viscous friction", error, unit="%", method=method)
            case.gate(
                f"{roll.name}: displacement, literal less viscous",
                found["displacement"] - error,
                within=(-VISCOUS, VISCOUS),
                unit="%",
                reference=0.0,
                method=method,
            )
            curves.setdefault((roll.name, "viscous"), {})[step] = (1e3 * time_step, error)


def _independent(case: Case, roll: Roll, curve: Curve) -> None:
    errors = [error for _, error in curve.values()]
    case.gate(
        f"{roll.name}: return map, displacement, range over time steps",
        max(errors) - min(errors),
        within=(0.0, SCATTER),
        unit="%",
    )


def _depends(case: Case, roll: Roll, curve: Curve) -> None:
    """The statement that the answer rests on: the literal law's answer moves with the step, and does not settle."""
    errors = [error for _, (_, error) in sorted(curve.items())]
    least = min(fine - coarse for fine, coarse in itertools.pairwise(errors))
    case.gate(
        f"{roll.name}: literal, least growth of displacement as the step is halved",
        least,
        within=(1.0, math.inf),
        unit="%",
    )


def _over_friction(case: Case) -> dict[str, dict[float, float]]:
    """Fitted acceleration at 60° [m/s²] by law and μ."""
    found: dict[str, dict[float, float]] = {}
    for label, law in LAWS.items():
        for friction in FRICTIONS:
            pair = {"bodies": ["cylinder", "plane"], "friction": friction}
            values = {**SERIES_ONLY, **law, "time.safety": 0.8, "contact.pairs": [pair]}
            name = ", ".join(filter(None, (label, f"mu {friction:g}")))
            method = Method("hamad2017", "cpdi", {}, name)
            for _, tree in case.runs([method], SLIP.scene, values):
                error = measures(motion_of(tree), SLIP)["acceleration"]
                value = SLIP.solution.acceleration * (1.0 + error / 100.0)
                found.setdefault(label, {})[friction] = value
                exact = acceleration(friction)
                case.show(
                    "60°: fitted acceleration", value, unit="m/s²", reference=round(exact, 3), method=method
                )
    return found


def acceleration(friction: float) -> float:
    """Rigid cylinder at 60° [m/s²]: g (sin θ − μ cos θ) if it slips, tan θ > 3 μ, else 2 g sin θ / 3."""
    tilt = TILTS[SLIP]
    return GRAVITY * max(math.sin(tilt) - friction * math.cos(tilt), 2.0 * math.sin(tilt) / 3.0)
