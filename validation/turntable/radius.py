"""Way of a block on a turntable, against that of a rigid one."""

import tomllib

import numpy as np
import xarray as xr

GRAVITY = 10.0  # m/s², as in scene.toml
STEPS = 20000


def slid(radius: float, omega: float, friction: float, end: float) -> float:
    """Distance from the axis [m] at ``end`` [s] of a rigid block that begins to turn with the table.

    It sticks while ω² r ≤ μ g; beyond, a = −μ g w/|w| with w its velocity over the table, outwards at first.
    Integrated by the mid-point rule."""
    if omega**2 * radius <= friction * GRAVITY:
        return radius
    place, velocity, dt = np.array([radius, 0.0]), np.array([0.0, omega * radius]), end / STEPS

    def rate(x: np.ndarray, v: np.ndarray) -> np.ndarray:
        w = v - omega * np.array([-x[1], x[0]])
        size = float(np.linalg.norm(w))
        direction = w / size if size > 1e-9 else x / np.linalg.norm(x)
        return np.asarray(-friction * GRAVITY * direction)

    for _ in range(STEPS):
        half = velocity + 0.5 * dt * rate(place, velocity)
        velocity = velocity + dt * rate(place + 0.5 * dt * velocity, half)
        place = place + dt * half
    return float(np.linalg.norm(place))


def judge(run: xr.DataTree) -> dict[str, float]:
    """Mean speed ``creep`` away from the axis [mm/s], error ``way`` of the way outwards [%] where it slides,
    and the plate's ``turning`` at the end over that at the start, less 1 [%]."""
    series, scene = run["series"].to_dataset(), tomllib.loads(run.attrs["scene"])
    centre = series["centre_of_mass"]
    apart = (centre.sel(body="block") - centre.sel(body="plate")).values
    radius, time = np.hypot(apart[:, 0], apart[:, 2]), series["time"].values
    omega = scene["bodies"]["plate"]["angular_velocity"][1]
    exact = slid(radius[0], omega, scene["contact"]["friction"], time[-1]) - radius[0]
    spin = series["angular_velocity"].sel(body="plate").values[:, 1]
    return {
        "creep": 1e3 * float(np.polyfit(time, radius, 1)[0]),
        "way": 100.0 * float((radius[-1] - radius[0]) / exact - 1.0) if exact > 0.0 else float("nan"),
        "turning": 100.0 * float(spin[-1] / spin[0] - 1.0),
    }
