"""The scenes of the shipped studies turned against the grid, and their errors along the turned axes."""

import math
import tomllib
from collections.abc import Sequence
from typing import Any

import numpy as np
import rolling
import xarray as xr
from placing import placed, rotation

from mpmfw.results.analysis import fitted_acceleration, impulse, value_at
from mpmfw.results.references import rings_table
from mpmfw.scene import load_scene
from mpmfw.units import to_si
from mpmfw.validation import CaseRun

ANGLES = (0.0, 0.35, 0.6)  #: [rad]
LAYOUTS = ("fitted", "lattice")
PRESSURE = 0.2e6  #: on both ends of the pressed blocks [Pa]
#: Nothing but the series of motion.
SERIES = {"output.gap": False, "output.particles": False, "output.surface": False, "output.ledger": False}


def turned(name: str, angle: float, layout: str, changes: dict[str, Any]) -> dict[str, Any]:
    """Return a shipped scene turned about the origin by ``angle`` [rad], its points in a layout."""
    scene = tomllib.loads(load_scene(name, set=changes).text)
    for table in (scene["grid"], *(body["geometry"] for body in scene["bodies"].values())):
        table.update({key: _metres(value) for key, value in table.items() if key != "type"})
    for body in scene["bodies"].values():
        body["particles"] = {**body["particles"], "layout": layout}
    scene.pop("reference", None)
    settle = scene.pop("settle", None)
    for table in filter(None, (scene, settle)):
        if "gravity" in table:
            table["gravity"] = _vector(table["gravity"])
    made = placed(scene, turn=math.degrees(angle))
    if settle is None:
        return made
    if "gravity" in settle:
        settle["gravity"] = {"vector": (rotation(angle) @ settle["gravity"]["vector"]).tolist()}
    return {**made, "settle": settle}


def pressed(angle: float, layout: str) -> dict[str, Any]:
    """Return two blocks of the shipped contact-stress without walls, with a pressure on both ends."""
    scene = tomllib.loads(load_scene("contact-stress", set=SERIES | {"output.particles": True}).text)
    for body, side in (("lower", "bottom"), ("upper", "top")):
        scene["bodies"][body]["sides"] = [{"side": side, "pressure": PRESSURE}]
        scene["bodies"][body]["particles"]["layout"] = layout
    scene.pop("reference")
    settle = scene.pop("settle")
    return {**placed(scene, turn=math.degrees(angle)), "settle": settle}


def _metres(value: Any) -> Any:
    return [_metres(one) for one in value] if isinstance(value, list) else float(to_si(value, "m"))


def _vector(gravity: dict[str, Any]) -> dict[str, Any]:
    tilt, g = float(to_si(gravity["tilt"], "rad")), float(gravity["magnitude"])
    return {"vector": [g * math.sin(tilt), -g * math.cos(tilt)]}


def slides(run: xr.DataTree, angle: float) -> dict[str, float]:
    """Return the error of the block's fitted acceleration [%], against g (sin 30° − μ cos 30°), μ = 0.3."""
    way, time = _way(run, "block", angle)
    exact = 10.0 * (math.sin(math.radians(30.0)) - 0.3 * math.cos(math.radians(30.0)))
    fitted = fitted_acceleration(time, way, 0.2 * time[-1], time[-1])
    return {"acceleration": 100.0 * (fitted / exact - 1.0)}


def rolls(run: xr.DataTree, angle: float, roll: rolling.Roll) -> dict[str, float]:
    """Return errors of the cylinder when the rigid one has moved by 10 m [%]."""
    way, time = _way(run, "cylinder", angle)
    spin = run["series"]["angular_velocity"].sel(body="cylinder").isel(rotation=-1).values
    exact = float(roll.solution.spin(roll.end))
    return {
        "displacement": 100.0 * (value_at(time, way, roll.end) / rolling.DISTANCE - 1.0),
        "spin": 100.0 * (value_at(time, spin, roll.end) / exact - 1.0),
    }


def collides(run: xr.DataTree, angle: float) -> dict[str, float]:
    """Return the largest departure of the rings' impulse from the finite elements' [% of the total]."""
    series, table = run["series"], rings_table("force")
    time, exact = series["time"].values, table["fine_impulse_Ns_per_m"]
    ours = impulse(time, -series["contact_force"].values[:, 0] @ rotation(angle)[:, 0])
    return {"impulse": 100.0 * float(np.abs(ours - np.interp(time, table["time"], exact)).max() / exact[-1])}


def presses(run: xr.DataTree, angle: float) -> dict[str, float]:
    """Return the departure of −n·σ·n from the pressure within a cell of the interface [%, root mean square].

    n is the turned y axis, along which the interface lies at 1.037 m."""
    n, near, volume = rotation(angle)[:, 1], [], []
    for body in ("lower", "upper"):
        points = run[f"particles/{body}"].to_dataset().isel(time=-1)
        chosen = np.abs(points["position"].values @ n - _interface(run, n)) < run.attrs["cell_size"]
        stress = np.einsum("i,pij,j->p", n, points["stress"].values[:, :2, :2], n)
        near.append(-stress[chosen] / PRESSURE - 1.0)
        volume.append(points["volume"].values[chosen])
    square = np.average(np.concatenate(near) ** 2, weights=np.concatenate(volume))
    return {"stress": 100.0 * math.sqrt(square)}


def _interface(run: xr.DataTree, n: np.ndarray) -> float:
    """Return where the interface lies along n [m]: midway between the innermost points of the blocks."""
    lower, upper = (
        run[f"particles/{body}"]["position"].isel(time=-1).values @ n for body in ("lower", "upper")
    )
    return 0.5 * float(lower.max() + upper.min())


def _way(run: xr.DataTree, body: str, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the way of a body's centre along the turned x axis (time,) [m], and the times [s]."""
    series = run["series"]
    centre = series["centre_of_mass"].sel(body=body).values
    return (centre - centre[0]) @ rotation(angle)[:, 0], series["time"].values


def worst(runs: Sequence[CaseRun], errors: Any, key: str, **args: Any) -> float:
    """Return the error of largest magnitude of these runs."""
    found = [run.of(errors, key, angle=run.place.make["angle"], **args) for run in runs]
    return max((value for value in found if value is not None), key=abs)
