"""A quantity that studies read off a run: replace it by your own."""

from __future__ import annotations

import numpy as np
import xarray as xr

from mpmfw.api import FloatArray
from mpmfw.campaigns.measures import About, Measured, measure
from mpmfw.scene import Scene


@measure("template", "m", "number", ("body",))
def template(run: xr.DataTree, scene: Scene, about: About) -> Measured:
    """Length of the way of a body's centre of mass."""
    body = about.body or next(iter(scene.bodies))
    centre: FloatArray = np.asarray(run["series"]["centre_of_mass"].sel(body=body))
    way = np.diff(centre, axis=0)
    return Measured(np.array([np.sqrt((way**2).sum(axis=1)).sum()]), np.zeros(0))
