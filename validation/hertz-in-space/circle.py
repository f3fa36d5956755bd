"""Force and radius of the circle of contact, from the forces on the ball's surface nodes."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from convergence import observed_order

from mpmfw.validation import CaseRun

CENTRE = (0.022, 0.034)  #: of the ball in the plane of contact, x and z [m]
UNDERSIDE = 1.014  #: height of its centre [m]
WEIGHT = 1000.0 * 10.0 * 4.0 / 3.0 * np.pi  #: F [N]
#: Hertz: a³ = 3 F R / (4 E*), for which the moduli are chosen; K. L. Johnson, Contact Mechanics (1985),
#: section 4.2(a)
RADIUS = 0.2


def errors(run: xr.DataTree) -> dict[str, float]:
    """Errors [%] of the ``force``, and of the radius by the ``second moment`` of the pressure and by the
    ``outermost`` node.

    Of p = p0 √(1 − r²/a²) the mean of r² over the force is 2/5 a²: no area is needed, and no threshold says
    which node counts."""
    ball = run["surface/ball"].to_dataset().isel(time=-1)
    place, force = ball["position"].values, ball["force"].values[:, 1]
    low = place[:, 1] < UNDERSIDE
    place, force = place[low], force[low]
    square = (place[:, 0] - CENTRE[0]) ** 2 + (place[:, 2] - CENTRE[1]) ** 2
    total = float(force.sum())
    radius = np.sqrt(2.5 * float(force @ square) / total)
    outermost = np.sqrt(square[force > 1e-6 * WEIGHT].max())
    return {
        "force": 100.0 * (total / WEIGHT - 1.0),
        "second moment": 100.0 * (radius / RADIUS - 1.0),
        "outermost": 100.0 * (outermost / RADIUS - 1.0),
    }


def orders(runs: Sequence[CaseRun]) -> dict[str, float]:
    """Observed order of the radius by the second moment over all cell sizes, and its error [%] in the
    ``limit`` of small cells: that of the two smallest, extrapolated in the first order."""
    sizes = np.array([float(run.results.attrs["cell_size"]) for run in runs])
    error = np.array([errors(run.results)["second moment"] for run in runs])
    fine, next_fine = np.argsort(sizes)[:2]
    slope = (error[next_fine] - error[fine]) / (sizes[next_fine] - sizes[fine])
    return {
        "order": observed_order(sizes, error),
        "limit": float(error[fine] - slope * sizes[fine]),
    }
