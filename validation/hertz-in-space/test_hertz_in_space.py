"""Hertz point contact in space: radius of contact of a ball on a block, over cell size and stiffness.

With the usual springs, what they add to the radius goes with the cell size.
"""
# cost: 260

import numpy as np
from common import observed_order

from mpmfw.validation import Place, Runs, each, full, known_red, methods, together

CENTRE = (0.022, 0.034)  #: of the ball in the plane of contact, x and z [m]
UNDERSIDE = 1.014  #: height of its centre [m]
WEIGHT = 1000.0 * 10.0 * 4.0 / 3.0 * np.pi  #: F [N]
#: Hertz: a³ = 3 F R / (4 E*), for which the moduli are chosen; K. L. Johnson, Contact Mechanics (1985),
#: section 4.2(a)
RADIUS = 0.2


def errors(run):
    """Return errors [%] of the ``force``, and of the radius by the ``second moment`` of the pressure.

    Of p = p0 √(1 − r²/a²) the mean of r² over the force is 2/5 a²: no area is needed, and no threshold says
    which node counts."""
    ball = run["surface/ball"].to_dataset().isel(time=-1)
    place, force = ball["position"].values, ball["force"].values[:, 1]
    low = place[:, 1] < UNDERSIDE
    place, force = place[low], force[low]
    square = (place[:, 0] - CENTRE[0]) ** 2 + (place[:, 2] - CENTRE[1]) ** 2
    total = float(force.sum())
    radius = np.sqrt(2.5 * float(force @ square) / total)
    return {"force": 100.0 * (total / WEIGHT - 1.0), "second moment": 100.0 * (radius / RADIUS - 1.0)}


MOMENT = "radius by the second moment of the pressure, error"
STIFF = "penalty, cpdi, kappa 8"

cells = Runs(
    "cells",
    methods=[*methods(), *methods(settings={"kappa 8": {"contact.penalty.kappa": 8.0}})],
    places=[Place("R/h = 5"), Place("R/h = 7", set={"grid.cell_size": 0.14285714})],
    binds=[STIFF],
    when="full",
)
convergence = Runs(
    "convergence",
    places=[Place(f"R/h = {n}", set={"grid.cell_size": h}) for n, h in ((10, 0.1), (14, 0.07142857))],
    when="full",
)
springs = Runs("springs", places=[Place("R/h = 5")], when="quick")


@known_red(
    STIFF,
    f"{MOMENT}, R/h = 5",
    "5.8 %; 4.6 % before the criterion of settling and the default kappa changed; the cause was not "
    "separated",
)
@each(cells, convergence)
def test_cells(run):
    at, stiff = run.place.at, run.method.matches(STIFF)
    force, moment = (run.of(errors, key) for key in ("force", "second moment"))
    run.gate(f"contact force against the weight, error, {at}", force, 0.0, 5.0, "%", binds=True)
    limit = 5.0 if run.runs == "cells" else None
    run.gate(f"{MOMENT}, {at}", moment, 0.0, limit, "%", binds=stiff)


@springs
def test_springs(run):
    """Judge what the usual springs add to the radius: 1.22 h / R, by the full version's R/h = 10 and 14."""
    force = run.of(errors, "force")
    run.gate("contact force against the weight, error, R/h = 5", force, 0.0, 5.0, "%")
    run.gate(f"{MOMENT}, R/h = 5", run.of(errors, "second moment"), 24.4, (19.4, 29.4), "%")


@full
@together(cells, convergence)
def test_orders(case, runs):
    """Judge the order of the radius, and its error by the two smallest cells, extrapolated in first order."""
    plain = [run for run in runs if run.method.matches("penalty, cpdi")]
    sizes = np.array([float(run.results.attrs["cell_size"]) for run in plain])
    error = np.array([run.of(errors, "second moment") for run in plain])
    (fine, coarse), method = np.argsort(sizes)[:2], "penalty, cpdi"
    slope, order = (error[coarse] - error[fine]) / (sizes[coarse] - sizes[fine]), observed_order(sizes, error)
    limit = error[fine] - slope * sizes[fine]
    case.gate("observed order of that radius, R/h = 5 to 14", order, 1.0, (0.7, 1.5), method=method)
    case.gate("that radius in the limit of small cells, error", limit, 0.0, 2.0, "%", method)
