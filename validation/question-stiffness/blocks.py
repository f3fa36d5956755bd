"""Penetration and stable time step of two blocks at rest, and what the figure of the case is drawn of."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from questions import PRESSURE

from mpmfw.results.references import scene_of

if TYPE_CHECKING:
    import xarray as xr

    from mpmfw.validation import CaseRun

MODULUS, DENSITY = 20e6, 1000.0  #: K + 4 G / 3 [Pa] and density of the two blocks [kg/m³]
LINEAR = 0.1  #: least κ of the fit


def of_blocks(tree: xr.DataTree) -> dict[str, float]:
    """Penetration ``depth`` [h] and ``limit`` of the time step [h/c], and the closed forms of both."""
    series = tree["series"].to_dataset()
    size = float(tree.attrs["cell_size"])
    kappa = float(scene_of(tree.attrs)["contact"]["penalty"]["kappa"])
    return {
        "depth": -float(series["min_gap"].isel(pair=0, time=-1)) / size,
        "closed depth": PRESSURE / (kappa * MODULUS),
        "limit": float(series["time_step_limit"][-1]) * math.sqrt(MODULUS / DENSITY) / size,
        "closed limit": 1.0 / math.sqrt(1.0 + kappa),
    }


def exponent(runs: Sequence[CaseRun]) -> float:
    """How the measured penetration goes with κ."""
    depths = {kappa_of(run): run.of(of_blocks, "depth") for run in runs}
    kappas = np.array([kappa for kappa in depths if kappa >= LINEAR])
    return float(np.polyfit(np.log(kappas), np.log([depths[kappa] for kappa in kappas]), 1)[0])


def kappa_of(run: CaseRun) -> float:
    """The stiffness factor of a run."""
    return float(run.method.set["contact.penalty.kappa"])
