"""Contact pressure from forces on the nodes of a surface, and means over windows along it."""

import numpy as np
import xarray as xr


def nodes_of(tree: xr.DataTree, body: str, k: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return positions [m] and forces [N/m], (n, 2) each, and lengths (n,) [m] of a body's surface nodes.

    They are those of output ``k``; half of each segment belongs to each of its nodes.
    """
    surface = tree[f"surface/{body}"].to_dataset().isel(time=k)
    position, after = surface["position"].values, surface["next"].values
    length = 0.5 * np.linalg.norm(position[after] - position, axis=1)
    length += np.bincount(after, length, len(length))
    return position, surface["force"].values, length
