"""Pulse of a one-dimensional impact: pressure, duration and velocities against d'Alembert's closed form."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from xarray import DataTree

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.state.fields import FloatArray
from mpmfw.validation import CaseRun

LENGTH, SPEED, THICKNESS, GAP = 10.0, 0.01, 0.25, 0.06  # m, m/s, m, m: as in scene.toml
# d'Alembert with ρ = c = 1: both ends of the pulse are fronts that run at c, and between them p = ρ c v.
PRESSURE = SPEED
DURATION = 2.0 * LENGTH
IMPACT = GAP / (2.0 * SPEED)  # s

GIVEN = "bardenhagen, cpdi, normal specified"
#: Drawn runs with their name in the legend, where CPDI goes without saying, and their look.
DRAWN = {
    "none, cpdi": ("none", {"color": "#009E73", "linestyle": (0, (8, 2))}),
    "penalty, cpdi": ("penalty", {"color": "#0072B2"}),
    "penalty, linear": ("penalty, linear", {"color": "#56B4E9", "linestyle": ":"}),
    "bardenhagen, cpdi": ("bardenhagen", {"color": "#D55E00", "linestyle": "--"}),
    GIVEN: ("bardenhagen, normal given", {"color": "#E69F00", "linestyle": "-."}),
}


def against_closed_form(tree: DataTree) -> dict[str, float] | None:
    """Return errors of plateau and duration, ripple over the pressure, and the gap [h] at contact.

    The pulse begins and ends at half of ρ c v, where a front that is smeared symmetrically has its true
    place. Its plateau is the middle 80 % of 2 L / c from the beginning; the ripple is the rms of what is left
    there.
    """
    time, pressure, _ = series(tree)
    if pressure is None:
        return None
    middle = time - 0.5 * np.diff(time, prepend=time[0])  # forces are means over output intervals
    acting = np.flatnonzero(pressure > 0.5 * PRESSURE)
    if len(acting) == 0:
        return dict.fromkeys(("plateau", "duration", "early", "ripple"), np.nan)
    begin, end = (
        crossing(middle, pressure, k) for k in ((acting[0] - 1, acting[0]), (acting[-1], acting[-1] + 1))
    )
    plateau = pressure[(middle > begin + 0.1 * DURATION) & (middle < begin + 0.9 * DURATION)]
    return {
        "plateau": float(plateau.mean()) / PRESSURE - 1.0,
        "duration": (end - begin) / DURATION - 1.0,
        "early": (IMPACT - begin) * 2.0 * SPEED / float(tree.attrs["cell_size"]),
        "ripple": 100.0 * float(plateau.std()) / PRESSURE,
    }


def rebound(tree: DataTree) -> float:
    """Relative error of the velocity of the left bar at the end."""
    return float(series(tree)[2][-1] / -SPEED - 1.0)


def series(tree: DataTree) -> tuple[FloatArray, FloatArray | None, FloatArray]:
    """Return time [s], pressure on the left bar [Pa], None without contact, and its velocity [m/s]."""
    data = tree["series"].to_dataset().sel(axis="x")
    velocity = data["mean_velocity"].sel(body="left").values
    if "contact_force" not in data:
        return data["time"].values, None, velocity
    thickness = 0.5 if float(tree.attrs["cell_size"]) == 0.5 else THICKNESS
    return data["time"].values, -data["contact_force"].isel(pair=0).values / thickness, velocity


def crossing(time: FloatArray, pressure: FloatArray, between: tuple[int, int]) -> float:
    """Return the time [s] at which the line through two outputs is at half the pressure."""
    i, j = max(between[0], 0), min(between[1], len(time) - 1)
    if pressure[i] == pressure[j]:
        return float(time[i])
    return float(time[i] + (0.5 * PRESSURE - pressure[i]) / (pressure[j] - pressure[i]) * (time[j] - time[i]))


def draw(runs: Sequence[CaseRun]) -> Figure:
    """Pressure and the left bar's mean velocity over time."""
    drawn = {str(run.method): run.results for run in runs}
    result = new_figure(1, 2, 50.0)
    above, below = result.subplots(2, 1, sharex=True)
    exact = {"color": "black", "linewidth": 0.8}
    stops = np.array([0.0, IMPACT, IMPACT, IMPACT + DURATION, IMPACT + DURATION, 30.0])
    above.plot(stops, 1e3 * PRESSURE * np.array([0, 0, 1, 1, 0, 0]), zorder=3, **exact)
    below.plot(stops, 1e3 * SPEED * np.array([1, 1, 1, -1, -1, -1]), zorder=3, **exact)
    handles = [Line2D([], [], label="closed form", **exact)]
    for name in (name for name in DRAWN if name in drawn):
        time, pressure, velocity = series(drawn[name])
        label, look = DRAWN[name]
        if pressure is not None:
            above.plot(time, 1e3 * pressure, linewidth=0.9, **look)
        below.plot(time, 1e3 * velocity, linewidth=0.9, **look)
        handles.append(Line2D([], [], label=label, linewidth=0.9, **look))
    dress(above, "", "contact pressure [mPa]")
    dress(below, "time [s]", "mean velocity, left bar [mm/s]")
    legend_below(result, [handles[k : k + 2] for k in range(0, len(handles), 2)])
    return result
