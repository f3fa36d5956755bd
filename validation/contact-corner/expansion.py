"""Lateral displacement of the block's sides over its strain, from its surface."""

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

WIDTH, HEIGHT = 10e-3, 10e-3  #: of the block [m]
POISSON = 0.3
#: Free expansion in plane strain: σ_xx = 0, ε_zz = 0, hence ε_xx = −ν/(1 − ν) ε_yy; u of each side over the
#: strain [m].
SLOPE = POISSON * WIDTH / (2.0 * (1.0 - POISSON))
PLACES = {"mid-height": 0.5, "bottom corners": 0.0, "top corners": 1.0}  #: height over that of the block


def slopes(run: xr.DataTree) -> dict[str, float]:
    """Return errors of the slope at PLACES, their ``worst``, and kinetic over strain ``energy`` [%]."""
    found = expansion_of(run)
    errors = {name: found.slope_error(height) for name, height in PLACES.items()}
    return {**errors, "worst": max(errors.values(), key=abs), "energy": 100.0 * found.energy_ratio}


def change(runs: Sequence[CaseRun]) -> dict[str, float]:
    """Change of the slopes of penalty contact with CPDI at half the speed [%]."""
    found = {run.runs: expansion_of(run.results) for run in runs if str(run.method) == "penalty, cpdi"}
    slow, fast = found["half speed"], found["methods"]
    return {name: 100.0 * (slow.slope(height) / fast.slope(height) - 1.0) for name, height in PLACES.items()}


def placed(cell_size: float, offset: float) -> dict[str, object]:
    """Return values for a cell size [m], with the left side ``offset`` cells past −5 mm."""
    left, bottom = -5e-3 + offset * cell_size, -5e-3 + 0.13 * cell_size
    top = bottom + HEIGHT
    return {
        "grid.cell_size": cell_size,
        "bodies.block.geometry.lower": [left, bottom],
        "bodies.block.geometry.upper": [left + WIDTH, top],
        "bodies.bottom.geometry.lower": [-8e-3, bottom - 3e-3],
        "bodies.bottom.geometry.upper": [8e-3, bottom],
        "bodies.top.geometry.lower": [-8e-3, top],
        "bodies.top.geometry.upper": [8e-3, top + 3e-3],
    }


@dataclass(frozen=True)
class Expansion:
    """Motion of the block's surface."""

    strain: Array  #: (time,) shortening of the block over its height, positive
    height: Array  #: (k,) along a side, over that of the block
    lateral: Array  #: (time, k) outward displacement, mean of the left and right side [m]
    energy_ratio: float  #: kinetic over strain energy of the block, at most, in the second half of the motion

    def at(self, height: float) -> Array:
        """Outward displacement at a height, over the time [m]."""
        return np.array([np.interp(height, self.height, row) for row in self.lateral])

    def slope(self, height: float) -> float:
        """Least-squares slope of displacement over strain, through zero, over the last 80 % [m]."""
        chosen = self.strain > 0.2 * self.strain[-1]
        strain, lateral = self.strain[chosen], self.at(height)[chosen]
        return float(strain @ lateral / (strain @ strain))

    def slope_error(self, height: float) -> float:
        """The slope against ν W / (2 (1 − ν)) [%]."""
        return 100.0 * (self.slope(height) / SLOPE - 1.0)

    @property
    def profile(self) -> Array:
        """(k,) lateral displacement at the end over the closed form."""
        return np.asarray(self.lateral[-1] / (SLOPE * self.strain[-1]))


def expansion_of(tree: xr.DataTree) -> Expansion:
    """Measure the block; contact springs take a part of the sides' motion, so its strain is measured."""
    position = tree["surface/block"]["position"].values
    moved = position - position[0]
    lower, upper = position[0].min(axis=0), position[0].max(axis=0)
    on = [[np.abs(position[0, :, a] - side[a]) < 1e-9 for side in (lower, upper)] for a in range(2)]
    (left, right), (bottom, top) = on
    strain = (moved[:, bottom, 1].mean(axis=1) - moved[:, top, 1].mean(axis=1)) / (upper[1] - lower[1])
    height, inwards = _along(position[0], moved, left, lower, upper)
    _, outwards = _along(position[0], moved, right, lower, upper)
    series = tree["series"].to_dataset().sel(body="block")
    half = len(position) // 2
    ratio = (series["kinetic_energy"] / series["strain_energy"]).values[half:].max()
    return Expansion(strain, height, 0.5 * (outwards - inwards), float(ratio))


def _along(
    start: Array, moved: Array, side: npt.NDArray[np.bool_], lower: Array, upper: Array
) -> tuple[Array, Array]:
    """Return heights (k,) over the block's and x displacements (time, k) of a side's nodes, from below."""
    order = np.flatnonzero(side)[np.argsort(start[side, 1])]
    return (start[order, 1] - lower[1]) / (upper[1] - lower[1]), moved[:, order, 0]
