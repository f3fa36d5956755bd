"""Von Mises stresses and outlines of a run, and of the reference."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from io import StringIO
from typing import Any

import numpy as np
import shapely
import xarray as xr

from mpmfw.geometry.disc import Ring
from mpmfw.geometry.layout import parallelogram_corners
from mpmfw.state.fields import FloatArray

TIMES = (0.0, 0.4e-3, 1.6e-3, 3.2e-3)  #: of [H17] figure 3 [s]
BODIES = {"left": -0.042, "right": 0.042}  #: x of the rings' centres at the start [m]


@dataclass(frozen=True)
class Stresses:
    """Material points of both rings at TIMES.

    Attributes
    ----------
    von_mises
        (n_times, n_points) [Pa].
    volumes
        (n_points,) in the reference state [m²].
    domains
        (n_times, n_points, 4, 2) corners of the points' parallelograms, F R_0 [m].
    """

    von_mises: FloatArray
    volumes: FloatArray
    domains: FloatArray

    def mean(self, k: int) -> float:
        """Mean by reference volume [Pa]."""
        return float(np.average(self.von_mises[k], weights=self.volumes))

    def percentile(self, k: int, share: float) -> float:
        """Stress [Pa] that ``share`` percent of the reference volume stay below."""
        order = np.argsort(self.von_mises[k])
        filled = np.cumsum(self.volumes[order]) - 0.5 * self.volumes[order]
        return float(np.interp(0.01 * share * self.volumes.sum(), filled, self.von_mises[k][order]))


def stresses_of(tree: xr.DataTree) -> Stresses:
    """Both rings of a run of the shipped scene with the frames of TIMES among its outputs."""
    parts = [_body(tree, body, centre) for body, centre in BODIES.items()]
    return Stresses(
        np.concatenate([part.von_mises for part in parts], axis=1),
        np.concatenate([part.volumes for part in parts]),
        np.concatenate([part.domains for part in parts], axis=1),
    )


def of_run(tree: xr.DataTree) -> dict[str, float]:
    """95th percentile and mean at each time but the first [Pa]."""
    stresses, found = stresses_of(tree), {}
    for k, time in enumerate(TIMES[1:], start=1):
        at = f"{1e3 * time:.1f} ms"
        found |= {f"p95 {at}": stresses.percentile(k, 95.0), f"mean {at}": stresses.mean(k)}
    return found


def _body(tree: xr.DataTree, body: str, centre: float) -> Stresses:
    """The half-edges R_0 are not stored with the results: they are laid out again as the scene does."""
    frames = tree[f"particles/{body}"].to_dataset().sel(time=list(TIMES), method="nearest")
    ring = Ring(centre=(centre, 0.0), inner_radius=0.030, outer_radius=0.040)
    layout = ring.fitted(0.25 * float(tree.attrs["cell_size"]))
    position, gradient = frames["position"].values, frames["deformation_gradient"].values
    if not np.allclose(layout.position, position[0], atol=1e-9):
        raise ValueError(f"material points of {body} are not where Ring.fitted lays them")
    domains = [
        parallelogram_corners(points, f @ layout.half_edges)
        for points, f in zip(position, gradient, strict=True)
    ]
    return Stresses(frames["von_mises"].values, layout.volume, np.array(domains))


def reference_stresses(time: float) -> dict[str, float]:
    """95th percentile and mean of the fine finite elements at one of TIMES [MPa]."""
    table = _table("vonmises")
    row = next(r for r in table if r["run"] == "fine" and abs(r["time_ms"] - 1e3 * time) < 1e-6)
    return {"p95": float(row["vm_p95_MPa"]), "mean": float(row["vm_mean_MPa"])}


def outline_distance(tree: xr.DataTree) -> float:
    """Largest distance of a point of the fine outlines from the run's own, over TIMES [mm]."""
    table = _table("outline")
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


def _table(name: str) -> np.ndarray[Any, Any]:
    text = files("mpmfw").joinpath("reference", f"rings_fem_{name}.csv").read_text(encoding="utf-8")
    return np.genfromtxt(StringIO(text), delimiter=",", names=True, dtype=None, encoding="utf-8")
