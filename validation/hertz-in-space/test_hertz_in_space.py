"""Hertz point contact in space."""
# cost: 260

# Radius of contact of a ball on a block, over the cell size and the stiffness of the springs. The
# springs as they are usual, in smaller cells: what they add to the radius goes with the cell size.

import circle

from mpmfw.validation import Place, Runs, full, known_red, methods, together

cells = Runs(
    "cells",
    methods=[*methods(when="full"), *methods(settings={"kappa 8": {"contact.penalty.kappa": 8.0}})],
    places=[Place("R/h = 5"), Place("R/h = 7", set={"grid.cell_size": 0.14285714}, when="full")],
    binds=["penalty, cpdi, kappa 8"],
)


@known_red(
    "penalty, cpdi, kappa 8",
    "radius by the second moment of the pressure, error, R/h = 5",
    "5.8 %; 4.6 % before the criterion of settling and the default kappa changed; the cause was not "
    "separated",
)
@cells
def test_cells(run):
    at = run.place.at
    run.gate(
        f"contact force against the weight, error, {at}",
        run.of(circle.errors, "force"),
        0.0,
        5.0,
        "%",
        binds=run.method.matches("penalty, cpdi", "penalty, cpdi, kappa 8"),
    )
    run.gate(
        f"radius by the second moment of the pressure, error, {at}",
        run.of(circle.errors, "second moment"),
        0.0,
        5.0,
        "%",
        binds=run.method.matches("penalty, cpdi, kappa 8"),
    )
    run.gate(
        f"radius by the outermost node in contact, error, {at}",
        run.of(circle.errors, "outermost"),
        0.0,
        unit="%",
    )


convergence = Runs(
    "convergence",
    places=[
        Place("R/h = 10", set={"grid.cell_size": 0.1}),
        Place("R/h = 14", set={"grid.cell_size": 0.07142857}),
    ],
    when="full",
)


@convergence
def test_convergence(run):
    at = run.place.at
    run.gate(f"contact force against the weight, error, {at}", run.of(circle.errors, "force"), 0.0, 5.0, "%")
    run.gate(
        f"radius by the second moment of the pressure, error, {at}",
        run.of(circle.errors, "second moment"),
        0.0,
        unit="%",
    )


@full
@together(cells, convergence)
def test_together_1(case, runs):
    for method, same in runs.by_method("penalty, cpdi"):
        case.gate(
            "observed order of that radius, R/h = 5 to 14",
            same.of(circle.orders, "order"),
            1.0,
            (0.7, 1.5),
            method=method,
        )
        case.gate(
            "that radius in the limit of small cells, error",
            same.of(circle.orders, "limit"),
            0.0,
            2.0,
            "%",
            method=method,
        )
