"""Hertz line contact: half-width and largest pressure, for every method and over the cell size.

b = sqrt(4 F' R / (π E*)), p0 = sqrt(F' E* / (π R)), p = p0 sqrt(1 − x²/b²); K. L. Johnson, Contact Mechanics (1985),
section 4.2(c).
"""

# cost: 100

from __future__ import annotations

import numpy as np
from figures import convergence_figure, pressure_figure
from pressure import HALF_WIDTH, WEIGHT, Profile, from_forces, from_stress, observed_order

from mpmfw.validation import SHAPES, Case
from mpmfw.validation.case import Method

#: Cell sizes [m]: 2, 3 and 4 cells in the half-width; that of the scene is the second.
SIZES = (0.075, 0.05, 0.0375)
SCENE = 0.05
SPECIFIED = {"contact.bardenhagen.normal": "specified", "contact.bardenhagen.direction": [0.0, -1.0]}
#: Of the reduced version: 2.5 cells in the half-width, settled less
QUICK = {"grid.cell_size": 0.06, "settle.tolerance": 1e-3}
STRONGEST = {**SPECIFIED, "contact.bardenhagen.criterion": "position"}


def check(case: Case) -> None:
    """Every method at the scene's cell size; convergence of the recommended ones; figures."""
    profiles: dict[tuple[str, float], Profile] = {}
    for method, tree in case.runs(_methods(case), set=QUICK if case.quick else None):
        profile, stress = None, from_stress(tree)
        if method.contact == "penalty":
            profile = from_forces(tree)
            _judge_forces(case, method, profile)
        _show_stress(case, method, stress)
        profiles[str(method), SCENE] = profile or stress
    if not case.quick:
        _convergence(case, profiles)


def _methods(case: Case) -> list[Method]:
    if case.quick:
        return case.methods(shape=("cpdi",))
    classical = {"": {}, "normal given": SPECIFIED, "normal given, position": STRONGEST}
    return [
        *case.methods(("penalty",), SHAPES),
        *case.methods(("bardenhagen",), SHAPES),
        *case.methods(("bardenhagen",), ("cpdi",), {k: v for k, v in classical.items() if k}),
        *case.methods(("none",), SHAPES),
    ]


def _judge_forces(case: Case, method: Method, profile: Profile) -> None:
    """The gates: largest pressure within 10 %, half-width within one cell, each measured in two ways."""
    case.judge(
        method, "largest pressure, error", profile.peak_error, within=(-10, 10), unit="%", reference=0.0
    )
    fitted = profile.fitted_peak_error
    case.judge(
        method, "p0 of the fitted semi-ellipse, error", fitted, within=(-10, 10), unit="%", reference=0.0
    )
    width = profile.width_error
    case.judge(method, "b of the fitted semi-ellipse, error", width, within=(-1, 1), unit="h", reference=0.0)
    touching = profile.touching_error
    case.judge(method, "b by the nodes in contact, error", touching, within=(-1, 1), unit="h", reference=0.0)
    load = 100.0 * (profile.force / WEIGHT - 1.0)
    case.show("contact force against the weight", load, unit="%", method=method, reference=0.0)


def _show_stress(case: Case, method: Method, stress: Profile) -> None:
    """The measure that every method has; decides nothing, at the same limits."""
    peak, width = stress.peak_error, stress.width_error
    case.show(
        "largest −σ_yy at the rim, error", peak, within=(-10, 10), unit="%", method=method, reference=0.0
    )
    case.show(
        "b of the ellipse fitted to −σ_yy, error",
        width,
        within=(-1, 1),
        unit="h",
        method=method,
        reference=0.0,
    )


def _convergence(case: Case, profiles: dict[tuple[str, float], Profile]) -> None:
    """Largest pressure and half-width over the cell size, by the forces."""
    for method in case.methods():
        for size in SIZES:
            if size == SCENE:
                continue
            for _, tree in case.runs([method], set={"grid.cell_size": size}):
                profile = from_forces(tree)
                profiles[str(method), size] = profile
                at = f"b/h = {HALF_WIDTH / size:.1f}"
                case.show(
                    f"largest pressure, error, {at}",
                    profile.peak_error,
                    unit="%",
                    method=method,
                    reference=0.0,
                )
                case.show(
                    f"b of the fit, error, {at}", profile.width_error, unit="h", method=method, reference=0.0
                )
        _orders(
            case,
            method,
            {size: profiles[str(method), size] for size in SIZES if (str(method), size) in profiles},
        )
    case.figure("", pressure_figure(profiles))
    case.figure("convergence", convergence_figure(profiles))


def _orders(case: Case, method: Method, curve: dict[float, Profile]) -> None:
    """Observed orders; the error must fall with every refinement."""
    sizes = np.array(list(curve))
    peak = np.abs([profile.peak_error for profile in curve.values()])
    fitted = np.abs([profile.fitted_peak_error for profile in curve.values()])
    width = np.abs([profile.width_error * profile.cell_size for profile in curve.values()])
    case.show("observed order, largest pressure", observed_order(sizes, peak), method=method)
    case.show("observed order, p0 of the fit", observed_order(sizes, fitted), method=method)
    case.show("observed order, b of the fit", observed_order(sizes, width), method=method)
    most = float(np.max(peak[1:] / peak[:-1]))
    case.judge(method, "largest pressure, error over that of the coarser cells, at most", most, within=(0, 1))
