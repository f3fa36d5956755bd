"""The rolling cylinder of [H17], section 4.1: closed forms, and what the cases about it measure of a run.

[H17] is Hamad, Giridharan & Moormann (2017), Procedia Engineering 175, 116-123.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from mpmfw.geometry.solid import turning
from mpmfw.report.table import gap_measures
from mpmfw.results.analysis import RollingSolution, fitted_acceleration, value_at
from mpmfw.results.references import RollingReference, reference_of
from mpmfw.scene import shipped_scenes
from mpmfw.state.fields import FloatArray

RADIUS, GRAVITY = 1.6, 10.0  #: R [m], g [m/s²]
DISTANCE = 10.0  #: along the plane, at which displacement and spin are judged [m]
BODY = "cylinder"

#: Nothing but the series of motion is looked at; the shipped scenes measure an energy balance besides, at
#: every step.
SERIES_ONLY = {"output.particles": False, "output.surface": False, "output.ledger": False}
#: Grid inertia as lumping leaves it.
LUMPED = {"bodies.cylinder.rotation": "lumped"}


class Roll(NamedTuple):
    """One of the two cases of [H17]."""

    scene: str  #: name of the shipped scene
    solution: RollingSolution  #: rigid cylinder: eq. 13 of [H17], and the spin that belongs to it

    @property
    def name(self) -> str:
        """``slip`` or ``no slip``, as in [H17]."""
        return "slip" if self.solution.slips else "no slip"

    @property
    def end(self) -> float:
        """Time at which the rigid cylinder has moved by 10 m [s]: 1.663 and 2.060."""
        return self.solution.time_to(DISTANCE)


def _roll(scene: str) -> Roll:
    """Return the rigid cylinder of a shipped scene (eq. 13 of [H17]), with the scene's friction, 0.286."""
    known = reference_of({"scene": shipped_scenes()[scene]})
    assert isinstance(known, RollingReference)
    return Roll(scene, known.solution)


#: 60°: g (sin θ − μ cos θ), α = 2 μ g cos θ / R.
SLIP = _roll("rolling-cylinder-slip")
#: 45°: d = (5√2/3) t² (eq. 13), α = a / R.
NO_SLIP = _roll("rolling-cylinder-no-slip")


class Motion(NamedTuple):
    """Series of one run, (time,)."""

    time: FloatArray  #: [s]
    displacement: FloatArray  #: of the centre of mass along the plane [m]
    velocity: FloatArray  #: of it [m/s]
    spin: FloatArray  #: clockwise, positive when rolling down [rad/s]
    gap: FloatArray  #: least distance of the surfaces in cells, negative where they penetrate


def motion_of(tree: xr.DataTree) -> Motion:
    """Take the motion from the results of a run."""
    series = tree["series"].to_dataset()
    along = series.sel(body=BODY, axis="x")
    x = along["centre_of_mass"].values
    return Motion(
        series["time"].values,
        x - x[0],
        along["mean_velocity"].values,
        -series["angular_velocity"].sel(body=BODY, rotation="z").values,
        series["min_gap"].isel(pair=0).values / float(tree.attrs["cell_size"]),
    )


def measures(motion: Motion, roll: Roll) -> dict[str, float]:
    """Return errors against the rigid cylinder [%], ``gap`` and ``penetration`` [cells].

    ``displacement`` and ``spin`` are those when it has moved by 10 m, ``acceleration`` and ``angular
    acceleration`` are fitted to the last 80 % of that time. The ``gap`` is that at the end of the run, the
    ``penetration`` the mean over all outputs of the deepest.
    """
    exact, end = roll.solution, roll.end
    fitted = fitted_acceleration(motion.time, motion.displacement, 0.2 * end, end)
    alpha = fitted_slope(motion.time, motion.spin, 0.2 * end, end)
    gaps = gap_measures(motion.gap)
    return {
        "displacement": 100.0 * (value_at(motion.time, motion.displacement, end) / DISTANCE - 1.0),
        "acceleration": 100.0 * (fitted / exact.acceleration - 1.0),
        "spin": 100.0 * (value_at(motion.time, motion.spin, end) / -float(exact.spin(end)) - 1.0),
        "angular acceleration": 100.0 * (alpha / -exact.angular_acceleration - 1.0),
        "gap": gaps["gap"],
        "penetration": gaps["penetration"],
    }


def errors(run: xr.DataTree, roll: str) -> dict[str, float]:
    """The measures of a run with ``slip`` or ``no slip``."""
    return measures(motion_of(run), SLIP if roll == "slip" else NO_SLIP)


def sphere_errors(
    run: xr.DataTree, scene: str | None = None, angles: Sequence[float] = (0.0, 0.0, 0.0)
) -> dict[str, float]:
    """Errors of the sphere [%] against the rigid one, fitted to the last 80 % of the time.

    ``scene`` is the shipped one with the plane along the grid, where it is not the run's own; ``angles``
    [deg] are those by which it is turned; the columns of the turn are the axes along the plane, across it,
    and of the rolling."""
    reference = reference_of(run.attrs if scene is None else {"scene": shipped_scenes()[scene]})
    assert isinstance(reference, RollingReference)
    series, solution = run["series"].to_dataset(), reference.solution
    axes, time = turning(tuple(np.radians(angles))), series["time"].values
    way = series["centre_of_mass"].sel(body="sphere").values @ axes[:, 0]
    spin = series["angular_velocity"].sel(body="sphere").values @ axes[:, 2]
    end = float(time[-1])
    late = time >= 0.2 * end
    spinning_up = float(np.polyfit(time[late], spin[late], 1)[0])
    fitted = fitted_acceleration(time, way, 0.2 * end, end)
    return {
        "displacement": 100.0 * ((way[-1] - way[0]) / float(solution.displacement(end)) - 1.0),
        "fitted acceleration": 100.0 * (fitted / solution.acceleration - 1.0),
        "fitted angular acceleration": 100.0 * (spinning_up / solution.angular_acceleration - 1.0),
    }


def fitted_slope(time: FloatArray, values: FloatArray, start: float, end: float) -> float:
    """Slope of the least-squares line between ``start`` and ``end``; NaN if a value there is missing."""
    inside = (time >= start - 1e-9) & (time <= end + 1e-9)
    if time[-1] < end or not np.all(np.isfinite(values[inside])):
        return math.nan
    return float(np.polyfit(time[inside], values[inside], 1)[0])


def lumping_loss(cell_size: Any, particle_size: Any) -> Any:
    """Relative surplus ε of the grid's rotational inertia under CPDI with a lumped mass.

    I_grid = I + m (h² + l_p²)/3 with I = m R²/2, see the guide's page on rotation. Rolling without slip, a =
    g sin θ / (1 + I/(m R²)), then loses ε/3 of its acceleration, and the spin of a slipping cylinder ε, to
    first order."""
    return (cell_size**2 + particle_size**2) / 3.0 / (0.5 * RADIUS**2)


#: The closed form, on top of all curves.
EXACT: dict[str, Any] = {"color": "black", "linewidth": 0.8, "zorder": 5}
