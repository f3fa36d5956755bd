"""σ_yy at the interface of the two blocks at rest of the case contact-stress, from the material points."""

import numpy as np
import xarray as xr

PRESSURE = 0.2e6  #: of the platen [Pa]
WIDTH = 1.0  #: of the blocks [m]
BODIES = ("lower", "upper")


def stress(tree: xr.DataTree) -> dict[str, float]:
    """Return errors of σ_yy against −p at the last output [%].

    Within a cell of the interface: the ``mean`` by volume, the largest ``departure``, and the largest one two
    cells ``off the walls``. Over both blocks: ``l2`` = sqrt(∫ (σ_yy + p)² dV / ∫ p² dV).
    """
    h = float(tree.attrs["cell_size"])
    frames = [tree[f"particles/{body}"].to_dataset().isel(time=-1) for body in BODIES]
    x, y = np.concatenate([frame["position"].values for frame in frames]).T
    volume = np.concatenate([frame["volume"].values for frame in frames])
    ratio = np.concatenate([-frame["stress"].values[:, 1, 1] / PRESSURE for frame in frames])
    near = np.abs(y - _interface(tree)) < h
    off_walls = near & (x > 2.0 * h) & (x < WIDTH - 2.0 * h)
    return {
        "mean": 100.0 * (np.average(ratio[near], weights=volume[near]) - 1.0),
        "departure": 100.0 * np.abs(ratio[near] - 1.0).max(),
        "off the walls": 100.0 * np.abs(ratio[off_walls] - 1.0).max(),
        "l2": 100.0 * np.sqrt(np.average((ratio - 1.0) ** 2, weights=volume)),
    }


def _interface(tree: xr.DataTree) -> float:
    """Mean height of the nodes of both surfaces that met at the start [m]."""
    heights = []
    for body, at in zip(BODIES, (np.max, np.min), strict=True):
        y = tree[f"surface/{body}"]["position"].values[..., 1]
        heights.append(y[-1][np.abs(y[0] - at(y[0])) < 0.05 * tree.attrs["cell_size"]].mean())
    return float(np.mean(heights))
