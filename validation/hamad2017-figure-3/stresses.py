"""Von Mises stresses and outlines of a run, and of the reference."""

from importlib.resources import files
from io import StringIO
from typing import Any, NamedTuple

import numpy as np
import shapely
import xarray as xr

from mpmfw.geometry.disc import Ring
from mpmfw.geometry.layout import parallelogram_corners

TIMES = (0.0, 0.4e-3, 1.6e-3, 3.2e-3)  #: of [H17] figure 3 [s]
BODIES = {"left": -0.042, "right": 0.042}  #: x of the rings' centres at the start [m]


class Stresses(NamedTuple):
    """Material points of both rings at TIMES."""

    von_mises: np.ndarray  #: (n_times, n_points) [Pa]
    volumes: np.ndarray  #: (n_points,) in the reference state [m²]
    domains: np.ndarray  #: (n_times, n_points, 4, 2) corners of the points' parallelograms, F R_0 [m]


def stresses_of(tree: xr.DataTree) -> Stresses:
    """Return both rings of a run of the shipped scene with the frames of TIMES among its outputs."""
    von_mises, volumes, domains = zip(*(_body(tree, *body) for body in BODIES.items()), strict=True)
    return Stresses(np.hstack(von_mises), np.concatenate(volumes), np.hstack(domains))


def of_run(tree: xr.DataTree) -> dict[str, float]:
    """Return the 95th percentile and the mean by reference volume at each time but the first [Pa]."""
    found = stresses_of(tree)
    measures = {}
    for time, stress in zip(TIMES[1:], found.von_mises[1:], strict=True):
        order = np.argsort(stress)
        filled = np.cumsum(found.volumes[order]) - 0.5 * found.volumes[order]
        at, below = f"{1e3 * time:.1f} ms", 0.95 * found.volumes.sum()
        measures[f"p95 {at}"] = float(np.interp(below, filled, stress[order]))
        measures[f"mean {at}"] = float(np.average(stress, weights=found.volumes))
    return measures


def _body(tree: xr.DataTree, body: str, centre: float) -> Stresses:
    """Lay out the half-edges R_0 again as the scene does: they are not stored with the results."""
    frames = tree[f"particles/{body}"].to_dataset().sel(time=list(TIMES), method="nearest")
    ring = Ring(centre=(centre, 0.0), inner_radius=0.030, outer_radius=0.040)
    layout = ring.fitted(0.25 * float(tree.attrs["cell_size"]))
    position, gradient = frames["position"].values, frames["deformation_gradient"].values
    if not np.allclose(layout.position, position[0], atol=1e-9):
        raise ValueError(f"material points of {body} are not where Ring.fitted lays them")
    edges = [f @ layout.half_edges for f in gradient]
    domains = [parallelogram_corners(*one) for one in zip(position, edges, strict=True)]
    return Stresses(frames["von_mises"].values, layout.volume, np.array(domains))


def outline_distance(tree: xr.DataTree) -> float:
    """Largest distance of a point of the fine outlines from the run's own, over TIMES [mm]."""
    text = files("mpmfw").joinpath("reference", "rings_fem_outline.csv").read_text(encoding="utf-8")
    table: Any = np.genfromtxt(StringIO(text), delimiter=",", names=True, dtype=None, encoding="utf-8")
    largest = 0.0
    for body in BODIES:
        surface = tree[f"surface/{body}"].to_dataset()
        after = surface["next"].values
        for time in TIMES:
            points = surface["position"].sel(time=time, method="nearest").values
            own = shapely.multilinestrings(np.stack([points, points[after]], axis=1))
            chosen = (np.abs(table["time_ms"] - 1e3 * time) < 1e-6) & (table["ring"] == body[0].upper())
            there = shapely.points(1e-3 * table["x_mm"][chosen], 1e-3 * table["y_mm"][chosen])
            largest = max(largest, float(shapely.distance(own, there).max()))
    return 1e3 * largest
