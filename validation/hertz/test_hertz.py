"""Hertz line contact: half-width and largest pressure, for every method and over the cell size.

Largest pressure within 10 %, half-width within one cell, each measured in two ways. 2 and 4 cells in the
half-width; the scene has 3.
"""
# cost: 100

import figures
import pressure
from classical import POSITION, specified

from mpmfw.validation import SHAPES, Place, Runs, full, methods, together

DOWN = specified(0.0, -1.0)

every = Runs(
    "methods",
    methods=[
        *methods(["penalty", "bardenhagen"], SHAPES, when="full"),
        *methods(
            ["bardenhagen"],
            settings={"normal given": DOWN, "normal given, position": {**DOWN, **POSITION}},
            when="full",
        ),
        *methods(["none"], SHAPES, when="full"),
        *methods(when="quick"),
    ],
    quick={"grid.cell_size": 0.06, "settle.tolerance": 0.001},
)
convergence = Runs(
    "convergence",
    places=[
        Place("b/h = 2.0", set={"grid.cell_size": 0.075}),
        Place("b/h = 4.0", set={"grid.cell_size": 0.0375}),
    ],
    when="full",
)


@every
def test_every(run):
    if run.method.matches("penalty, *"):
        run.gates(
            pressure.of_forces,
            ("largest pressure, error", "peak", 0.0, 10.0, "%"),
            ("p0 of the fitted semi-ellipse, error", "fitted peak", 0.0, 10.0, "%"),
            ("b of the fitted semi-ellipse, error", "width", 0.0, 1.0, "h"),
            ("b by the nodes in contact, error", "touching", 0.0, 1.0, "h"),
            ("contact force against the weight", "load", 0.0, None, "%"),
        )
    run.gates(
        pressure.of_stress,
        ("largest −σ_yy at the rim, error", "peak", 0.0, 10.0, "%"),
        ("b of the ellipse fitted to −σ_yy, error", "width", 0.0, 1.0, "h"),
        binds=False,
    )


@convergence
def test_convergence(run):
    run.gates(
        pressure.of_forces,
        ("largest pressure, error, {at}", "peak", 0.0, None, "%"),
        ("b of the fit, error, {at}", "width", 0.0, None, "h"),
    )


@full
@together(every, convergence)
def test_orders(case, runs):
    penalty = runs.only("penalty, cpdi")
    for quantity, key, tolerance in (
        ("observed order, largest pressure", "peak", None),
        ("observed order, p0 of the fit", "fitted peak", None),
        ("observed order, b of the fit", "width", None),
        ("largest pressure, error over that of the coarser cells, at most", "most", (0.0, 1.0)),
    ):
        case.gate(quantity, penalty.of(pressure.orders, key), tolerance=tolerance, method="penalty, cpdi")
    case.figure("convergence", figures.convergence(penalty))
