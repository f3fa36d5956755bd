"""Closed forms of the hard scenes: bodies as rigid, friction as Coulomb's, and what each run has instead."""

from typing import Any

import numpy as np
import xarray as xr
from criteria import scene_of

#: Part of a run that is judged where it begins with a ramp, from here to its end: 0.155 s of 0.35 s.
AFTER = 0.444


def stops(run: xr.DataTree) -> float:
    """Way of a block by which it stops, against v²/2μg [% of it]."""
    scene = scene_of(run)
    speed = np.array(scene["bodies"]["block"]["velocity"])
    g = np.linalg.norm(scene["gravity"]["vector"])
    way = np.diff(_centre(run, "block")[[0, -1]], axis=0)[0] @ speed / np.linalg.norm(speed)
    return float(100.0 * (way / (speed @ speed / (2.0 * scene["contact"]["friction"] * g)) - 1.0))


def slides(run: xr.DataTree) -> float | None:
    """Return the acceleration down an incline against g (sin θ − μ cos θ) [% of it]; None if it sticks."""
    exact, along, time = _incline(run)
    return None if exact <= 0.0 else float(100.0 * (2.0 * np.polyfit(time, along, 2)[0] / exact - 1.0))


def creeps(run: xr.DataTree) -> float | None:
    """Mean speed of a block that must stick [mm/s]; None if it slides."""
    exact, along, time = _incline(run)
    return None if exact > 0.0 else float(1e3 * np.ptp(along) / np.ptp(time))


def _incline(run: xr.DataTree) -> tuple[float, np.ndarray, np.ndarray]:
    """Return a rigid block's acceleration [m/s²], below zero if it sticks, its way, and time."""
    scene = scene_of(run)
    given = scene["gravity"]
    table = np.array(given["table"])[:, 1:] if "table" in given else np.array([given["vector"]])
    first, last = table[0], table[-1]
    down = first / np.linalg.norm(first)
    face = np.array([-down[1], down[0]])
    exact = last @ face - scene["contact"]["friction"] * (last @ down)
    time = run["series"]["time"].values
    late = time >= AFTER * time[-1] - 1e-9
    return float(exact), (_centre(run, "block") @ face)[late], time[late]


def rolls(run: xr.DataTree) -> float:
    """Return the larger error of v and ω R [%]; a disc thrown flat comes to roll with 2/3 of its speed."""
    disc = scene_of(run)["bodies"]["disc"]
    exact = 2.0 / 3.0 * np.linalg.norm(disc["velocity"])
    series = run["series"].to_dataset().sel(body="disc")
    late = series["time"].values >= 0.9 * series["time"].values[-1]
    speed = np.ptp(_along(_centre(run, "disc")[late], disc["velocity"])) / np.ptp(series["time"].values[late])
    spin = -float(series["angular_velocity"].values[late].mean()) * disc["geometry"]["radius"]
    return float(100.0 * max((speed / exact - 1.0, spin / exact - 1.0), key=abs))


def climbs(run: xr.DataTree) -> float:
    """Force that pushes a wedge up a slope of 0.1 over its weight, F/G = (tan α + μ)/(1 − μ tan α) [% of it].

    What is left of a larger force accelerates it: F/G − a/(g (cos α − μ sin α)).
    """
    scene = scene_of(run)
    mu, g = scene["contact"]["friction"], np.linalg.norm(scene["gravity"]["vector"])
    cos = 1.0 / np.sqrt(1.01)
    pushed = np.linalg.norm(np.array(scene["loads"]["push"]["force"])[-1, 1:]) / (1000.0 * g)
    time, centre = run["series"]["time"].values, _centre(run, "wedge")
    late = time >= AFTER * time[-1] - 1e-9
    a = 2.0 * np.polyfit(time[late], _along(centre[late], centre[-1] - centre[0]), 2)[0]
    needed = pushed - a / (g * cos * (1.0 - 0.1 * mu))
    return float(100.0 * (needed / ((0.1 + mu) / (1.0 - 0.1 * mu)) - 1.0))


def rests(run: xr.DataTree) -> float:
    """Farthest that the centre of a body at rest goes [cells]."""
    centre = run["series"]["centre_of_mass"].values
    return float(np.linalg.norm(centre - centre[0], axis=-1).max()) / float(run.attrs["cell_size"])


def bounces(run: xr.DataTree) -> float:
    """Speed after a bounce over that before, less 1 [%]."""
    return -100.0 - _kept(run, "disc")


def hands_over(run: xr.DataTree) -> float:
    """Return the momentum that a bar keeps which meets a longer one of the same section and solid [%]."""
    return _kept(run, "short")


def _kept(run: xr.DataTree, body: str) -> float:
    """Return a body's momentum at the end along that at the start, over it [%]."""
    momentum = run["series"]["linear_momentum"].sel(body=body).values
    return float(100.0 * (momentum[-1] @ momentum[0]) / (momentum[0] @ momentum[0]))


def reverses(run: xr.DataTree) -> float:
    """Return the way of a block on a shaken plane against the rigid block's [% of its farthest]."""
    scene = scene_of(run)
    rows = np.array(scene["gravity"]["table"])
    down = rows[0, 1:] / np.linalg.norm(rows[0, 1:])
    face = np.array([-down[1], down[0]])
    grip = scene["contact"]["friction"] * np.linalg.norm(rows[0, 1:])
    fine = np.linspace(0.0, run["series"]["time"].values[-1], 20001)
    push, step = np.interp(fine, rows[:, 0], rows[:, 1:] @ face), fine[1]
    speed, way = 0.0, [0.0]
    for a in push[:-1]:
        free = speed + a * step
        speed = np.sign(free) * max(abs(free) - grip * step, 0.0)
        way.append(way[-1] + speed * step)
    along = _centre(run, "block") @ face
    return float(100.0 * (along[-1] - along[0] - way[-1]) / np.ptp(way))


def pushed(run: xr.DataTree) -> float:
    """Acceleration of a block that is pressed down and pushed, against (q b − μ p a)/m [% of it]."""
    scene = scene_of(run)
    block = scene["bodies"]["block"]
    (low, high), mu = (block["geometry"][key] for key in ("lower", "upper")), scene["contact"]["friction"]
    width, height = high[0] - low[0], high[1] - low[1]
    loads = {side["side"]: np.array(side["pressure"])[-1, 1] for side in block["sides"]}
    mass = scene["materials"][block["material"]]["density"] * width * height
    exact = (loads["left"] * height - mu * loads["top"] * width) / mass
    angle = block["geometry"]["angle"]
    way = _along(_centre(run, "block"), [np.cos(angle), np.sin(angle)])
    time = run["series"]["time"].values
    late = time >= 0.25 * time[-1]
    return float(100.0 * (2.0 * np.polyfit(time[late], way[late], 2)[0] / exact - 1.0))


def presses(run: xr.DataTree) -> float:
    """Return the share of force on a punch's middle half against 1/3, of p = F/(π √(a² − x²)) [% of it]."""
    ground = run["surface"]["ground"].to_dataset().isel(time=-1)
    down = np.array(scene_of(run)["gravity"]["vector"])
    x = ground["position"].values @ [-down[1], down[0]] / np.linalg.norm(down)
    force = ground["force"].values @ down
    middle = _centre(run, "punch")[-1] @ [-down[1], down[0]] / np.linalg.norm(down)
    order = np.argsort(x)
    borne = np.cumsum(force[order]) - 0.5 * force[order]
    ends = np.interp([middle - 0.5, middle + 0.5], x[order], borne)
    return float(100.0 * (3.0 * np.diff(ends)[0] / force.sum() - 1.0))


def _centre(run: xr.DataTree, body: str) -> Any:
    return run["series"]["centre_of_mass"].sel(body=body).values


def _along(points: np.ndarray, direction: Any) -> np.ndarray:
    return np.asarray(points @ direction / np.linalg.norm(direction))
