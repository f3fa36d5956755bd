"""Influence of the surface mesh: segments of h/8 to 2h in rolling, static contact stress and an impact."""

# cost: 70

from __future__ import annotations

import math
from collections.abc import Iterator

import xarray as xr
from drawing import Found, draw
from questions import (
    RINGS_COARSE,
    ROLLING_FINE,
    STRESS,
    cost_of,
    points_of,
    rings_noise,
    rolling_noise,
    segments,
)
from rings import SCENE, STIFF, measures_of
from rolling import SLIP, measures, motion_of

from mpmfw.validation import Case, Method

SIZES = (0.125, 0.25, 0.5, 1.0, 2.0)  #: length of a segment [h]
QUICK = (0.25, 1.0)
#: Lengths that put the blocks' nodes off the grid's: 34, 25, 15 and 8 segments over ten cells.
BETWEEN = (0.3, 0.4, 0.7, 1.4)
#: Up to which length the stress of a static contact must be within 3 %: the longest that the guide recommends.
SOUND, LIMIT = 0.5, 3.0


def check(case: Case) -> None:
    """Both bodies of every scene with the same segments."""
    found: Found = {}
    _stress(case, found)
    _rolling(case, found)
    if not case.quick:
        _rings(case, found)
        _stiff_rings(case, found)
    case.figure("", draw(found))


def _runs(
    case: Case, scene: str, values: dict[str, object], *bodies: str, more: tuple[float, ...] = ()
) -> Iterator[tuple[float, Method, xr.DataTree]]:
    for size in QUICK if case.quick else sorted({*SIZES, *more}):
        label = {f"segments {size:g} h": segments(size, *bodies)}
        for method, tree in case.runs(case.methods(settings=label), scene, values):
            yield size, method, tree


def _keep(found: Found, size: float, **values: float) -> None:
    for name, value in values.items():
        found.setdefault(name, {})[size] = value


def _stress(case: Case, found: Found) -> None:
    for size, method, tree in _runs(case, STRESS, {}, "lower", "upper", more=BETWEEN):
        points = points_of(tree)
        length = 10.0 / math.ceil(10.0 / size - 1e-9)  # of ten cells, in equal parts
        worst, inner = points.oscillation(), points.oscillation(margin=2.0)
        case.gate(
            "blocks: largest departure of σ_yy",
            worst,
            within=(0.0, LIMIT),
            unit="%",
            reference=0.0,
            method=method,
            binds=size <= SOUND,
        )
        case.show("blocks: largest departure off the walls", inner, unit="%", reference=0.0, method=method)
        _keep(found, length, **{"stress_between" if size in BETWEEN else "stress": worst})


def _rolling(case: Case, found: Found) -> None:
    values = {**ROLLING_FINE, "grid.cell_size": 0.8} if case.quick else ROLLING_FINE
    for size, method, tree in _runs(case, SLIP.scene, values, "cylinder", "plane"):
        motion, cost = measures(motion_of(tree), SLIP), cost_of(tree)
        for name in ("displacement", "acceleration", "spin"):
            case.show(f"rolling: {name}, error", motion[name], unit="%", reference=0.0, method=method)
        force = rolling_noise(tree)
        step = 1e3 * cost["cpu"] / cost["steps"]
        case.show("rolling: mean penetration", motion["penetration"], unit="h", method=method)
        case.show("rolling: noise of the normal force", force, unit="%", method=method)
        case.show("rolling: CPU time of a step", step, unit="ms", method=method)
        case.show("rolling: share of contact", 100.0 * cost["contact"] / cost["cpu"], unit="%", method=method)
        errors = {name: motion[name] for name in ("displacement", "acceleration", "spin")}
        _keep(found, size, **errors, rolling_noise=force, rolling_step=step)


def _rings(case: Case, found: Found) -> None:
    for size, method, tree in _runs(case, SCENE, RINGS_COARSE, "left", "right"):
        measured, cost, force = measures_of(tree), cost_of(tree), rings_noise(tree)
        step = 1e3 * cost["cpu"] / cost["steps"]
        curve, deepest = measured["impulse_curve_error"], measured["largest_penetration"]
        case.show("rings: impulse curve, largest error", curve, unit="%", method=method)
        case.show("rings: force over 100 us, L2 error", measured["force_error_100us"], method=method)
        case.show("rings: noise of the force", force, unit="%", method=method)
        case.show("rings: largest penetration", deepest, unit="h", method=method)
        case.show("rings: CPU time of a step", step, unit="ms", method=method)
        _keep(found, size, impulse=curve, rings_noise=force, rings_step=step)


def _stiff_rings(case: Case, found: Found) -> None:
    """The rings with κ = 1 instead of the shipped 0.25: whether long segments or stiff springs make the noise."""
    for size, method, tree in _runs(case, SCENE, {**RINGS_COARSE, **STIFF}, "left", "right"):
        measured, force = measures_of(tree), rings_noise(tree)
        curve, l2 = measured["impulse_curve_error"], measured["force_error_100us"]
        case.show("rings, kappa 1: impulse curve, largest error", curve, unit="%", method=method)
        case.show("rings, kappa 1: force over 100 us, L2 error", l2, method=method)
        case.show("rings, kappa 1: noise of the force", force, unit="%", method=method)
        _keep(found, size, stiff_impulse=curve, stiff_noise=force)
