"""Contact stress under a block: σ_yy = −p at the interface, for every method and for wrong surface-to-grid maps.

Closed form: equilibrium of a column between frictionless walls without body force, dσ_yy/dy = 0 with σ_yy = −p under
the platen, hence σ_yy = −p everywhere, for any elastic law (the contact patch test of Taylor and Papadopoulos, 1991).
"""

# cost: 50

from __future__ import annotations

import numpy as np
from figures import convergence_figure, interface_figure
from measures import Points, observed_order, points_of, shifted

from mpmfw.validation import SHAPES, Case
from mpmfw.validation.case import Method

CELL = 0.1  #: of the scene [m]
OFFSETS = (0.37, 0.81)  #: of the interface above a grid line [cells]
LIMIT = 3.0  #: [%]
SIZES = (0.2, 0.1, 0.05)  #: [m]
SPECIFIED = {"contact.bardenhagen.normal": "specified", "contact.bardenhagen.direction": [0.0, 1.0]}
POSITION = {"contact.bardenhagen.criterion": "position"}
WRONG_MAP = {"contact.penalty.map": "mass_weighted"}
UNLIKE = {"bodies.upper.particles.size": "0.45 cells", "bodies.upper.segment": "0.22 cells"}

#: Stresses of the first offset by method, for the figure.
Results = dict[str, Points]


def check(case: Case) -> None:
    """Methods at two offsets of the interface, wrong maps, and the convergence."""
    results: Results = {}
    plain = case.methods(("penalty",), ("cpdi",)) if case.quick else _methods(case)
    wrong = case.methods(
        shape=("cpdi",) if case.quick else ("cpdi", "cpdi2"), settings={"wrong map": WRONG_MAP}
    )
    for offset in OFFSETS[:1] if case.quick else OFFSETS:
        _interface_stress(case, plain if offset == OFFSETS[0] else _few(case), offset, results)
        _wrong_maps_are_seen(case, wrong, offset, results)
    if not case.quick:
        case.figure("", interface_figure(results))
        _convergence(case)


def _methods(case: Case) -> list[Method]:
    classical = {"": {}, "normal given": SPECIFIED, "normal given, position": {**SPECIFIED, **POSITION}}
    return [
        *case.methods(("penalty",), SHAPES),
        *case.methods(("penalty",), ("cpdi", "cpdi2"), {"unlike points and segments": UNLIKE}),
        *case.methods(("penalty",), ("linear", "gimp"), {"plain map": {"contact.penalty.map": "plain"}}),
        *case.methods(("penalty",), ("bspline",), {"wrong map": WRONG_MAP}),
        *case.methods(("bardenhagen",), SHAPES, classical),
        *case.methods(("none",), SHAPES),
    ]


def _few(case: Case) -> list[Method]:
    """Those run at every offset: the recommended ones, and classical contact in both forms."""
    classical = case.methods(("bardenhagen",), ("cpdi",), {"": {}, "normal given": SPECIFIED})
    return [*case.methods(shape=("cpdi", "cpdi2")), *classical]


def _interface_stress(case: Case, methods: list[Method], offset: float, results: Results) -> None:
    for method, tree in case.runs(methods, set=shifted(CELL, offset)):
        points = points_of(tree)
        results.setdefault(str(method), points)
        at = f"at {offset} h"
        case.judge(
            method,
            f"mean σ_yy, error, {at}",
            points.mean_error,
            within=(-LIMIT, LIMIT),
            unit="%",
            reference=0.0,
        )
        worst = points.oscillation()
        case.judge(method, f"largest departure, {at}", worst, within=(0.0, LIMIT), unit="%", reference=0.0)
        inner = points.oscillation(margin=2.0)
        case.show(
            f"largest departure off the walls, {at}",
            inner,
            within=(0.0, LIMIT),
            unit="%",
            method=method,
            reference=0.0,
        )


def _wrong_maps_are_seen(case: Case, methods: list[Method], offset: float, results: Results) -> None:
    """The case has to tell a wrong map: it must miss the limit that the right one keeps."""
    for method, tree in case.runs(methods, set=shifted(CELL, offset)):
        points = points_of(tree)
        results.setdefault(str(method), points)
        case.gate(
            f"departure off the walls, must be seen, at {offset} h",
            points.oscillation(margin=2.0),
            within=(LIMIT, np.inf),
            unit="%",
            method=method,
        )


def _convergence(case: Case) -> None:
    """Departure and L2 error over the cell size, the interface kept at the same place within a cell."""
    methods = [
        *case.methods(("penalty",), ("cpdi", "cpdi2")),
        *case.methods(("bardenhagen",), ("cpdi",), {"": {}, "normal given": SPECIFIED}),
    ]
    curves: dict[str, list[Points]] = {}
    for size in SIZES:
        for method, tree in case.runs(methods, set=shifted(size, OFFSETS[0])):
            points = points_of(tree)
            curves.setdefault(str(method), []).append(points)
            case.show(
                f"L2 error of σ_yy, h = {size} m", points.l2_error, unit="%", method=method, reference=0.0
            )
    for label, curve in curves.items():
        sizes = np.array([points.cell_size for points in curve])
        l2 = np.array([points.l2_error for points in curve])
        inner = np.array([points.oscillation(margin=2.0) for points in curve])
        case.show("observed order, L2 error of σ_yy", observed_order(sizes, l2), method=label)
        case.show("observed order, departure off the walls", observed_order(sizes, inner), method=label)
    case.figure("convergence", convergence_figure(curves))
