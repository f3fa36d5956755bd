"""Stress at the interface of the two blocks, from the material points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import xarray as xr

if TYPE_CHECKING:
    from mpmfw.validation import CaseRun

Array = npt.NDArray[np.float64]

PRESSURE = 0.2e6  #: of the platen [Pa]
WIDTH = 1.0  #: of the blocks [m]
BODIES = ("lower", "upper")


@dataclass(frozen=True)
class Points:
    """Material points of both blocks at rest."""

    x: Array  #: [m]
    height: Array  #: above the interface [m]
    volume: Array  #: [m²]
    ratio: Array  #: σ_yy / (−p), 1 where exact
    cell_size: float  #: [m]

    @property
    def near(self) -> npt.NDArray[np.bool_]:
        """Points whose centre lies within one cell of the interface."""
        return np.asarray(np.abs(self.height) < self.cell_size)

    @property
    def mean_error(self) -> float:
        """Volume-weighted mean of σ_yy near the interface against −p [%]."""
        near = self.near
        return float(100.0 * (np.average(self.ratio[near], weights=self.volume[near]) - 1.0))

    def oscillation(self, margin: float = 0.0) -> float:
        """Largest departure of σ_yy from −p near the interface [%], ``margin`` cells off the walls."""
        edge = margin * self.cell_size
        chosen = self.near & (self.x > edge) & (self.x < WIDTH - edge)
        return float(100.0 * np.abs(self.ratio[chosen] - 1.0).max())

    @property
    def l2_error(self) -> float:
        """sqrt(∫ (σ_yy + p)² dV / ∫ p² dV) over both blocks [%]."""
        return float(100.0 * np.sqrt(np.average((self.ratio - 1.0) ** 2, weights=self.volume)))

    def row(self, upper: bool) -> tuple[Array, Array]:
        """x [m] and ratio of the points nearest to the interface in one block, one for each column."""
        own = self.near & ((self.height > 0.0) == upper)
        distance = np.abs(self.height[own])
        nearest = distance < distance.min() + 0.2 * self.cell_size
        x, ratio = self.x[own][nearest], self.ratio[own][nearest]
        order = np.argsort(x)
        return x[order], ratio[order]


def points_of(tree: xr.DataTree) -> Points:
    """The points of the last output."""
    frames = [tree[f"particles/{body}"].to_dataset().isel(time=-1) for body in BODIES]
    position = np.concatenate([frame["position"].values for frame in frames])
    return Points(
        x=position[:, 0],
        height=position[:, 1] - _interface(tree),
        volume=np.concatenate([frame["volume"].values for frame in frames]),
        ratio=np.concatenate([-frame["stress"].values[:, 1, 1] / PRESSURE for frame in frames]),
        cell_size=float(tree.attrs["cell_size"]),
    )


def _interface(tree: xr.DataTree) -> float:
    """Mean height of the nodes of both surfaces that met at the start [m]."""
    heights = []
    for body, at in zip(BODIES, (np.max, np.min), strict=True):
        y = tree[f"surface/{body}"]["position"].values[..., 1]
        heights.append(y[-1][np.abs(y[0] - at(y[0])) < 0.05 * tree.attrs["cell_size"]].mean())
    return float(np.mean(heights))


def stress(tree: xr.DataTree) -> dict[str, float]:
    """Return errors of σ_yy [%]: ``mean``, largest ``departure``, two cells ``off the walls``, ``l2``."""
    points = points_of(tree)
    departure, off = points.oscillation(), points.oscillation(margin=2.0)
    return {"mean": points.mean_error, "departure": departure, "off the walls": off, "l2": points.l2_error}


def orders(runs: Sequence[CaseRun]) -> dict[str, float]:
    """Observed orders of the errors of :func:`stress` over the cell size."""
    sizes = np.array([float(run.results.attrs["cell_size"]) for run in runs])
    errors = [stress(run.results) for run in runs]
    return {
        name: observed_order(sizes, np.array([one[name] for one in errors]))
        for name in ("l2", "off the walls")
    }


def observed_order(cell_sizes: Array, errors: Array) -> float:
    """Slope of the least-squares line of log(error) over log(cell size)."""
    return float(np.polyfit(np.log(cell_sizes), np.log(errors), 1)[0])
