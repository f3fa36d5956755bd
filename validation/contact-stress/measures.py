"""Stress at the interface of the two blocks, from the material points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import xarray as xr

Array = npt.NDArray[np.float64]

PRESSURE = 0.2e6  #: of the platen [Pa]
WIDTH = 1.0  #: of the blocks [m]
HEIGHT = 1.0  #: of the upper block [m]
BODIES = ("lower", "upper")


def shifted(cell_size: float, offset: float) -> dict[str, object]:
    """Values of the scene for a cell size [m] and the interface at ``offset`` cells above a grid line."""
    interface = 1.0 + offset * cell_size
    return {
        "grid.cell_size": cell_size,
        "bodies.lower.geometry.upper": [WIDTH, interface],
        "bodies.upper.geometry.lower": [0.0, interface],
        "bodies.upper.geometry.upper": [WIDTH, interface + HEIGHT],
    }


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
        """Largest departure of σ_yy from −p near the interface [%]; ``margin`` [cells] leaves out the walls."""
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


def observed_order(cell_sizes: Array, errors: Array) -> float:
    """Slope of the least-squares line of log(error) over log(cell size)."""
    return float(np.polyfit(np.log(cell_sizes), np.log(errors), 1)[0])
