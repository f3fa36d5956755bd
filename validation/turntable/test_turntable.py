"""Turntable: a block on a turning plate stays up to a speed, and slides outwards beyond."""
# cost: 450

import tomllib

import numpy as np

from mpmfw.validation import CLASSICAL, Place, Runs, methods

GRAVITY = 10.0  # m/s², as in scene.toml
STEPS = 20000


def slid(radius, omega, friction, end):
    """Return the distance from the axis [m] at ``end`` [s] of a rigid block that begins as the table.

    It sticks while ω² r ≤ μ g; beyond, a = −μ g w/|w| with w its velocity over the table, outwards at first.
    Integrated by the mid-point rule."""
    if omega**2 * radius <= friction * GRAVITY:
        return radius
    place, velocity, dt = np.array([radius, 0.0]), np.array([0.0, omega * radius]), end / STEPS

    def rate(x, v):
        w = v - omega * np.array([-x[1], x[0]])
        size = float(np.linalg.norm(w))
        direction = w / size if size > 1e-9 else x / np.linalg.norm(x)
        return np.asarray(-friction * GRAVITY * direction)

    for _ in range(STEPS):
        half = velocity + 0.5 * dt * rate(place, velocity)
        velocity = velocity + dt * rate(place + 0.5 * dt * velocity, half)
        place = place + dt * half
    return float(np.linalg.norm(place))


def outwards(run):
    """Return the mean speed ``creep`` away from the axis [mm/s], and the error ``way`` of the way [%]."""
    series, scene = run["series"].to_dataset(), tomllib.loads(run.attrs["scene"])
    centre = series["centre_of_mass"]
    apart = (centre.sel(body="block") - centre.sel(body="plate")).values
    radius, time = np.hypot(apart[:, 0], apart[:, 2]), series["time"].values
    omega = scene["bodies"]["plate"]["angular_velocity"][1]
    exact = slid(radius[0], omega, scene["contact"]["friction"], time[-1]) - radius[0]
    way = 100.0 * float((radius[-1] - radius[0]) / exact - 1.0) if exact > 0.0 else float("nan")
    return {"creep": 1e3 * float(np.polyfit(time, radius, 1)[0]), "way": way}


SHIFTED = {"grid.lower": [-1.569, -0.583, -1.577], "grid.upper": [1.631, 1.017, 1.623]}
FASTER = {
    "bodies.plate.angular_velocity": [0.0, 3.5, 0.0],
    "bodies.block.angular_velocity": [0.0, 3.5, 0.0],
    "bodies.block.velocity": [0.0, 0.0, -2.1],
}
COARSE = {"grid.cell_size": 0.15, "grid.lower": [-1.65, -0.6, -1.65], "grid.upper": [1.65, 1.05, 1.65]}


def at_speed(name, values, **quick):
    """Return the runs at one speed, with the grid as it stands and shifted."""
    return Runs(
        name,
        methods=[*methods(), *methods([*CLASSICAL, "lcp"], when="full")],
        places=[Place("as it stands"), Place("shifted", SHIFTED, when="full")],
        set=values,
        quick=COARSE | quick,
    )


stays, slides = at_speed("stays", {}, **{"time.end": 0.2}), at_speed("slides", FASTER)


@stays
def test_stays(run):
    run.gate(f"stays, {run.place.at}: creep", run.of(outwards, "creep"), 0.0, 1.0, "mm/s")


@slides
def test_slides(run):
    run.gate(f"slides, {run.place.at}: way outwards, error", run.of(outwards, "way"), 0.0, 1.5, "%")
