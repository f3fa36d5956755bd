"""A quantity that studies read off a run: replace it by your own."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.api import About, FloatArray, Measure, Measured

if TYPE_CHECKING:
    import xarray as xr

    from mpmfw.scene import Scene


class Template(Measure):
    """Length of the way of a body's centre of mass."""

    name = "template"
    unit = "m"
    kind = "number"
    keys = ("body",)

    def of(self, run: xr.DataTree, scene: Scene, about: About) -> Measured:
        """The way of the body that is named, else of the scene's first."""
        body = about.body or next(iter(scene.bodies))
        centre: FloatArray = np.asarray(run["series"]["centre_of_mass"].sel(body=body))
        way = np.diff(centre, axis=0)
        return Measured(np.array([np.sqrt((way**2).sum(axis=1)).sum()]), np.zeros(0))
