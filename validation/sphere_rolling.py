"""The sphere's motion against the rigid one's."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from mpmfw.geometry.solid import turning
from mpmfw.results.analysis import fitted_acceleration
from mpmfw.results.references import RollingReference, reference_of
from mpmfw.scene import shipped_scenes


def errors(
    run: xr.DataTree, scene: str | None = None, angles: Sequence[float] = (0.0, 0.0, 0.0)
) -> dict[str, float]:
    """Errors [%], fitted to the last 80 % of the time, and the deepest penetration [h].

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
        "penetration": -float(series["min_gap"].min()) / float(run.attrs["cell_size"]),
    }
