"""σ_yy of uniaxial strain, at every point of a block.

Closed form: Neo-Hookean (`split`) at F = diag(1, 1 − ε).
"""

import math

import numpy as np
from xarray import DataTree

from mpmfw.state.fields import FloatArray

BULK, SHEAR, STRAIN = 12e6, 6e6, 0.1  # Pa, Pa, 1: as in scene.toml
TURN = math.radians(30.0)
CENTRE = 0.5  # m


def exact() -> float:
    """σ_yy [Pa] at the last strain."""
    j = 1.0 - STRAIN
    return 0.5 * BULK * (j - 1.0 / j) + SHEAR * j ** (-5.0 / 3.0) * (j * j - (2.0 + j * j) / 3.0)


def stress(tree: DataTree, angle: float = 0.0) -> FloatArray:
    """Stress across the driven side over its closed form, at every point at the end."""
    n = np.array([-math.sin(angle), math.cos(angle)])
    found = tree["particles/block"]["stress"].isel(time=-1).values
    return np.asarray(np.einsum("d,pde,e->p", n, found, n) / exact())


def extremes(tree: DataTree) -> dict[str, float]:
    """Errors of the ``least`` and ``largest`` σ_yy [%]."""
    found = 100.0 * (stress(tree) - 1.0)
    return {"least": float(found.min()), "largest": float(found.max())}


def turned(tree: DataTree) -> dict[str, float]:
    """Errors of σ_yy in the turned block [%]: ``mean``, and the largest by the distance from sides at the
    start: ``far``, within three cells of ``one`` side, within three of ``two``."""
    found = 100.0 * (stress(tree, TURN) - 1.0)
    begin = tree["particles/block"]["position"].isel(time=0).values - CENTRE
    c, s = math.cos(TURN), math.sin(TURN)
    # Distance from the nearer of two opposite sides
    inside = 0.5 - np.abs(begin @ np.array([[c, -s], [s, c]]))
    near = inside < 3.0 * float(tree.attrs["cell_size"])
    one, two = near.any(axis=1) & ~near.all(axis=1), near.all(axis=1)
    chosen = {"far": ~near.any(axis=1), "one": one, "two": two}
    largest = {name: float(np.abs(found[own]).max()) for name, own in chosen.items()}
    return {"mean": float(found.mean()), **largest}
