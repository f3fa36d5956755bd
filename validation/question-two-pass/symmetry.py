"""How far the two rings are from each other's mirror image, over time."""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.spatial import cKDTree

from mpmfw.state.fields import FloatArray


def mirror_errors(tree: xr.DataTree) -> tuple[FloatArray, FloatArray]:
    """Times [s], and the largest distance of a surface node from the mirror image of its partner [h]."""
    surface = tree["surface/left"].to_dataset()
    left = surface["position"].values
    right = tree["surface/right"].to_dataset()["position"].values * np.array([-1.0, 1.0])
    _, partner = cKDTree(left[0]).query(right[0])
    apart = np.linalg.norm(left[:, partner] - right, axis=2).max(axis=1)
    return tree["series"]["time"].values, apart / float(tree.attrs["cell_size"])
