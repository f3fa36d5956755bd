"""Impact of two equal bars: pressure, duration and velocities, for every method.

A coarse cell is thicker than the bars, which then are one cell of their own thick.
"""
# cost: 60

import numpy as np
from common import POSITION, rectangle, specified
from matplotlib.lines import Line2D

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CLASSICAL, RECOMMENDED, SHAPES, Runs, methods, together

LENGTH, SPEED, THICKNESS, GAP = 10.0, 0.01, 0.25, 0.06  # m, m/s, m, m: as in scene.toml
# d'Alembert with ρ = c = 1: both ends of the pulse are fronts that run at c, and between them p = ρ c v.
PRESSURE = SPEED
DURATION = 2.0 * LENGTH
IMPACT = GAP / (2.0 * SPEED)  # s

#: Drawn runs with their name in the legend, where CPDI goes without saying, and their look.
DRAWN = {
    "none, cpdi": ("none", {"color": "#009E73", "linestyle": (0, (8, 2))}),
    "penalty, cpdi": ("penalty", {"color": "#0072B2"}),
    "penalty, linear": ("penalty, linear", {"color": "#56B4E9", "linestyle": ":"}),
    "bardenhagen, cpdi": ("bardenhagen", {"color": "#D55E00", "linestyle": "--"}),
    "bardenhagen, cpdi, normal specified": (
        "bardenhagen, normal given",
        {"color": "#E69F00", "linestyle": "-."},
    ),
}


def against_closed_form(tree):
    """Return errors of plateau and duration.

    The pulse begins and ends at half of ρ c v, where a front that is smeared symmetrically has its true
    place. Its plateau is the middle 80 % of 2 L / c from the beginning.
    """
    time, pressure, _ = series(tree)
    if pressure is None:
        return None
    middle = time - 0.5 * np.diff(time, prepend=time[0])  # forces are means over output intervals
    acting = np.flatnonzero(pressure > 0.5 * PRESSURE)
    if len(acting) == 0:
        return dict.fromkeys(("plateau", "duration"), np.nan)
    begin, end = (
        crossing(middle, pressure, k) for k in ((acting[0] - 1, acting[0]), (acting[-1], acting[-1] + 1))
    )
    plateau = pressure[(middle > begin + 0.1 * DURATION) & (middle < begin + 0.9 * DURATION)]
    return {"plateau": float(plateau.mean()) / PRESSURE - 1.0, "duration": (end - begin) / DURATION - 1.0}


def rebound(tree):
    """Relative error of the velocity of the left bar at the end."""
    return float(series(tree)[2][-1] / -SPEED - 1.0)


def series(tree):
    """Return time [s], pressure on the left bar [Pa], None without contact, and its velocity [m/s]."""
    data = tree["series"].to_dataset().sel(axis="x")
    velocity = data["mean_velocity"].sel(body="left").values
    if "contact_force" not in data:
        return data["time"].values, None, velocity
    thickness = 0.5 if float(tree.attrs["cell_size"]) == 0.5 else THICKNESS
    return data["time"].values, -data["contact_force"].isel(pair=0).values / thickness, velocity


def crossing(time, pressure, between):
    """Return the time [s] at which the line through two outputs is at half the pressure."""
    i, j = max(between[0], 0), min(between[1], len(time) - 1)
    if pressure[i] == pressure[j]:
        return float(time[i])
    return float(time[i] + (0.5 * PRESSURE - pressure[i]) / (pressure[j] - pressure[i]) * (time[j] - time[i]))


def draw(runs):
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


ALONG = specified(1.0, 0.0)
COARSE = {
    "grid.cell_size": 0.5,
    "bodies.left.geometry": rectangle(-9.95, 0.0, 0.05, 0.5)["geometry"],
    "bodies.right.geometry": rectangle(0.11, 0.0, 10.11, 0.5)["geometry"],
}
GIVEN = {"": {}, "normal specified": ALONG, "position, normal specified": {**POSITION, **ALONG}}
CELLS = {"L/h = 20": COARSE, "L/h = 40": {"grid.cell_size": 0.25}}

bars = Runs(
    "bars",
    methods=[
        *methods(["none", CLASSICAL[1], "penalty"], SHAPES, when="full"),
        *methods(["bardenhagen"], SHAPES, GIVEN, when="full"),
        *methods(["separate"], when="full"),
        *methods(["penalty", "bardenhagen"], settings=CELLS, when="full"),
        *methods(shape=RECOMMENDED, when="quick"),
    ],
    set={"output.particles": False, "output.surface": False, "output.gap": False},
)


@bars
def test_bars(run):
    for quantity, key, tolerance in (("plateau", "plateau", 3.0), ("contact duration", "duration", 5.0)):
        run.gate(f"{quantity}, error", run.of(against_closed_form, key, 100.0), 0.0, tolerance, "%")
    run.gate("velocity after it, error", run.of(rebound, scale=100.0), 0.0, 2.0, "%")


@together(bars)
def test_figure(case, runs):
    case.figure("", draw(runs))
