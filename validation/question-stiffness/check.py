"""The stiffness factor κ: penetration, accuracy and stable time step, from 0.01 to 100."""

# cost: 70

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr
from drawing import Found, draw
from questions import PRESSURE, RINGS_COARSE, SERIES_ONLY, STRESS, cost_of, points_of, rings_noise
from rings import SCENE, measures_of
from rolling import NO_SLIP, measures, motion_of

from mpmfw.validation import Case, Method

DECADES = (0.01, 0.1, 1.0, 10.0, 100.0)
HALVES = tuple(float(kappa) for kappa in np.logspace(-2.0, 2.0, 9))
QUICK = (0.1, 1.0, 10.0)
MODULUS, DENSITY = 20e6, 1000.0  #: K + 4 G / 3 [Pa] and density of the two blocks [kg/m³]
#: The penetration's exponent in κ, exact −1; from 0.1 on, below which it is deeper than a segment is long.
EXPONENT = (-1.03, -0.97)
LINEAR = 0.1


def check(case: Case) -> None:
    """Two blocks at rest, rolling without slip, and the rings."""
    found: Found = {}
    _blocks(case, found)
    _law(case, found)
    if not case.quick:
        _rolling(case, found)
        _rings(case, found)
    case.figure("", draw(found, PRESSURE / MODULUS))


def _runs(
    case: Case, scene: str, values: dict[str, object], kappas: Sequence[float]
) -> Iterator[tuple[float, Method, xr.DataTree]]:
    for kappa in kappas:
        label = {f"kappa {kappa:.3g}": {"contact.penalty.kappa": kappa}}
        for method, tree in case.runs(case.methods(settings=label), scene, values):
            yield kappa, method, tree


def _keep(found: Found, kappa: float, **values: float) -> None:
    for name, value in values.items():
        found.setdefault(name, {})[kappa] = value


def _blocks(case: Case, found: Found) -> None:
    """Penetration p h / (κ M), and the time step's limit 2 / sqrt(ω_bulk² + ω²) = (h/c) / sqrt(1 + κ)."""
    values = {"output.stability": True}
    for kappa, method, tree in _runs(case, STRESS, values, QUICK if case.quick else HALVES):
        series = tree["series"].to_dataset()
        size = float(tree.attrs["cell_size"])
        depth = -float(series["min_gap"].isel(pair=0, time=-1)) / size
        closed = PRESSURE / (kappa * MODULUS)
        case.show("blocks: penetration", depth, unit="h", reference=closed, method=method)
        limit = float(series["time_step_limit"][-1]) * math.sqrt(MODULUS / DENSITY) / size
        bound = 1.0 / math.sqrt(1.0 + kappa)
        case.show("blocks: limit of the time step", limit, unit="h/c", reference=bound, method=method)
        stress = points_of(tree).oscillation()
        case.show("blocks: largest departure of σ_yy", stress, unit="%", reference=0.0, method=method)
        _keep(found, kappa, depth=depth, limit=limit, stress=stress)


def _law(case: Case, found: Found) -> None:
    """How the measured penetration goes with κ."""
    kappas = np.array([kappa for kappa in found["depth"] if kappa >= LINEAR])
    depths = np.array([found["depth"][kappa] for kappa in kappas])
    exponent = float(np.polyfit(np.log(kappas), np.log(depths), 1)[0])
    case.gate("blocks: exponent of the penetration in kappa", exponent, within=EXPONENT, reference=-1.0)


def _rolling(case: Case, found: Found) -> None:
    for kappa, method, tree in _runs(case, NO_SLIP.scene, SERIES_ONLY, DECADES):
        measured, cost = measures(motion_of(tree), NO_SLIP), cost_of(tree)
        for name in ("displacement", "acceleration", "spin"):
            case.show(f"rolling: {name}, error", measured[name], unit="%", reference=0.0, method=method)
        case.show("rolling: mean penetration", measured["penetration"], unit="h", method=method)
        case.show("rolling: steps", cost["steps"], method=method)
        case.show("rolling: CPU time", cost["cpu"], unit="s", method=method)
        errors = {name: measured[name] for name in ("displacement", "acceleration", "spin")}
        depth = measured["penetration"]
        _keep(found, kappa, **errors, rolling_steps=cost["steps"], rolling_depth=depth)


def _rings(case: Case, found: Found) -> None:
    for kappa, method, tree in _runs(case, SCENE, RINGS_COARSE, DECADES):
        measured, cost, force = measures_of(tree), cost_of(tree), rings_noise(tree)
        curve, deepest = measured["impulse_curve_error"], measured["largest_penetration"]
        case.show("rings: impulse curve, largest error", curve, unit="%", method=method)
        case.show("rings: force over 100 us, L2 error", measured["force_error_100us"], method=method)
        case.show("rings: noise of the force", force, unit="%", method=method)
        case.show("rings: largest penetration", deepest, unit="h", method=method)
        case.show("rings: steps", cost["steps"], method=method)
        case.show("rings: CPU time", cost["cpu"], unit="s", method=method)
        _keep(found, kappa, impulse=curve, rings_depth=deepest, rings_steps=cost["steps"])
