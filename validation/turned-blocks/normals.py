"""Stress of the turned blocks along their common axis."""

import numpy as np
import xarray as xr

from mpmfw.geometry.solid import turning

PRESSURE = 2e3  #: on both ends [Pa]
AXIS = turning(tuple(np.radians([20.0, 35.0, 50.0])))[:, 2]  #: of the stack, n


def stress(run: xr.DataTree) -> dict[str, float]:
    """−n·σ·n over the pressure, less one [%], at the points of all blocks: ``mean`` by volume, ``largest``
    magnitude, and both ``beside`` an interface, within a cell of it; and the root of the mean square,
    ``l2``."""
    bodies = list(run["particles"].children)
    ratio, along, volume, ends = [], [], [], []
    for name in bodies:
        points = run["particles"][name].to_dataset().isel(time=-1)
        ratio.append(np.einsum("a,nab,b->n", AXIS, points["stress"].values, AXIS) / -PRESSURE)
        along.append(points["position"].values @ AXIS)
        volume.append(run["particles"][name].to_dataset().isel(time=0)["volume"].values)
        ends.append(along[-1].mean() + 0.5)
    interfaces, error = np.array(ends[:-1]), 100.0 * (np.concatenate(ratio) - 1.0)
    weights, h = np.concatenate(volume), float(run.attrs["cell_size"])
    near = np.abs(np.concatenate(along)[:, None] - interfaces).min(axis=1) < h
    return {
        "mean": float(np.average(error[near], weights=weights[near])),
        "beside": float(np.abs(error[near]).max()),
        "largest": float(np.abs(error).max()),
        "l2": float(np.sqrt(np.average(error**2, weights=weights))),
    }
