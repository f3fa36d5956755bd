"""Lateral displacement of the block's sides over its strain, from its surface."""

import numpy as np
import xarray as xr

WIDTH = 10e-3  #: of the block [m]
POISSON = 0.3
#: Free expansion in plane strain: σ_xx = 0, ε_zz = 0, hence ε_xx = −ν/(1 − ν) ε_yy; u of each side over the
#: strain [m].
SLOPE = POISSON * WIDTH / (2.0 * (1.0 - POISSON))
PLACES = {"mid-height": 0.5, "bottom corners": 0.0, "top corners": 1.0}  #: height over that of the block


def slopes(run: xr.DataTree) -> dict[str, float]:
    """Return errors of the slope at PLACES, their ``worst``, and kinetic over strain ``energy`` [%].

    The ratio of energies is the block's largest in the second half of the motion.
    """
    errors = {place: 100.0 * (slope(run, place) / SLOPE - 1.0) for place in PLACES}
    series = run["series"].to_dataset().sel(body="block")
    ratio = (series["kinetic_energy"] / series["strain_energy"]).values[series.sizes["time"] // 2 :].max()
    return {**errors, "worst": max(errors.values(), key=abs), "energy": 100.0 * float(ratio)}


def slope(run: xr.DataTree, place: str) -> float:
    """Return the outward displacement of both sides over the strain [m], by least squares, through zero, over
    the last 80 %.

    Contact springs take a part of the sides' motion, so the block's strain is measured.
    """
    position = run["surface/block"]["position"].values
    start, moved = position[0], position - position[0]
    (left, bottom), (right, top) = start.min(axis=0), start.max(axis=0)
    below, above = (np.abs(start[:, 1] - y) < 1e-9 for y in (bottom, top))
    strain = (moved[:, below, 1].mean(axis=1) - moved[:, above, 1].mean(axis=1)) / (top - bottom)
    height = bottom + PLACES[place] * (top - bottom)
    outwards = np.zeros(len(position))
    for x, way in ((left, -0.5), (right, 0.5)):
        nodes = np.flatnonzero(np.abs(start[:, 0] - x) < 1e-9)
        nodes = nodes[np.argsort(start[nodes, 1])]
        outwards += way * np.array([np.interp(height, start[nodes, 1], row) for row in moved[:, nodes, 0]])
    chosen = strain > 0.2 * strain[-1]
    strain, outwards = strain[chosen], outwards[chosen]
    return float(strain @ outwards / (strain @ strain))
