"""Hertz line contact."""
# cost: 100

# Half-width and largest pressure of a line contact, for every method and over the cell size. Largest
# pressure within 10 %, half-width within one cell, each measured in two ways. What every method has
# decides nothing. 2 and 4 cells in the half-width; the scene has 3.

import drawn
import pressure

from mpmfw.validation import SHAPES, Place, Runs, full, methods, together

methods_runs = Runs(
    "methods",
    methods=[
        *methods(["penalty", "bardenhagen"], SHAPES, when="full"),
        *methods(
            ["bardenhagen"],
            settings={
                "normal given": {
                    "contact.bardenhagen.normal": "specified",
                    "contact.bardenhagen.direction": [0.0, -1.0],
                },
                "normal given, position": {
                    "contact.bardenhagen.normal": "specified",
                    "contact.bardenhagen.direction": [0.0, -1.0],
                    "contact.bardenhagen.criterion": "position",
                },
            },
            when="full",
        ),
        *methods(["none"], SHAPES, when="full"),
        *methods(when="quick"),
    ],
    quick={"grid.cell_size": 0.06, "settle.tolerance": 0.001},
)


@methods_runs
def test_methods_runs(run):
    if run.method.matches("penalty, *"):
        for quantity, key, tolerance, unit in (
            ("largest pressure, error", "peak", 10.0, "%"),
            ("p0 of the fitted semi-ellipse, error", "fitted peak", 10.0, "%"),
            ("b of the fitted semi-ellipse, error", "width", 1.0, "h"),
            ("b by the nodes in contact, error", "touching", 1.0, "h"),
            ("contact force against the weight", "load", None, "%"),
        ):
            run.gate(quantity, run.of(pressure.of_forces, key), 0.0, tolerance, unit)
    run.gate(
        "largest −σ_yy at the rim, error", run.of(pressure.of_stress, "peak"), 0.0, 10.0, "%", binds=False
    )
    run.gate(
        "b of the ellipse fitted to −σ_yy, error",
        run.of(pressure.of_stress, "width"),
        0.0,
        1.0,
        "h",
        binds=False,
    )


convergence = Runs(
    "convergence",
    places=[
        Place("b/h = 2.0", set={"grid.cell_size": 0.075}),
        Place("b/h = 4.0", set={"grid.cell_size": 0.0375}),
    ],
    when="full",
)


@convergence
def test_convergence(run):
    at = run.place.at
    run.gate(f"largest pressure, error, {at}", run.of(pressure.of_forces, "peak"), 0.0, unit="%")
    run.gate(f"b of the fit, error, {at}", run.of(pressure.of_forces, "width"), 0.0, unit="h")


@full
@together(methods_runs, convergence)
def test_together_1(case, runs):
    for method, same in runs.by_method("penalty, cpdi"):
        case.gate("observed order, largest pressure", same.of(pressure.orders, "peak"), method=method)
        case.gate("observed order, p0 of the fit", same.of(pressure.orders, "fitted peak"), method=method)
        case.gate("observed order, b of the fit", same.of(pressure.orders, "width"), method=method)
        case.gate(
            "largest pressure, error over that of the coarser cells, at most",
            same.of(pressure.orders, "most"),
            method=method,
            tolerance=(0.0, 1.0),
        )


@full
@together(methods_runs, convergence)
def test_figure(case, runs):
    case.figure("", drawn.pressures(runs))


@full
@together(methods_runs, convergence)
def test_figure_convergence(case, runs):
    case.figure("convergence", drawn.convergence(runs))
