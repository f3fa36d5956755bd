"""Geometry of a stored run: domains of CPDI, which follow from its scene, and surfaces."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from mpmfw.errors import MpmfwError
from mpmfw.geometry import discretise
from mpmfw.geometry.base import context_of_cells
from mpmfw.geometry.layout import parallelogram_corners
from mpmfw.results.stored_scene import scene_of
from mpmfw.scene.bodies import Body
from mpmfw.scene.sources import code_in
from mpmfw.state.fields import FloatArray, IntArray

#: Corners of the domains of material points at one output, (n, 4, 2) [m], counter-clockwise.
Corners = Callable[[xr.Dataset], FloatArray]


def corners_of(tree: xr.DataTree, body: str) -> Corners | None:
    """Return a function that gives the corners of the domains of a body's material points.

    CPDI2 stores them. Those of CPDI are x_p + F R_0 ξ, with R_0 from the stored scene. Return None for other
    shape functions and in 3D.
    """
    points = tree[f"particles/{body}"].to_dataset()
    if points.sizes.get("axis") != 2:
        return None
    if "corners" in points and points["corners"].sizes.get("corner") == 4:
        return lambda frame: np.asarray(frame["corners"].values, dtype=float)
    needed = {"position", "deformation_gradient", "mass"}
    if not str(tree.attrs.get("shape", "")).startswith("cpdi") or not needed <= set(points.data_vars):
        return None
    scene = scene_of({str(name): value for name, value in tree.attrs.items()})
    try:
        if next(code_in(scene["bodies"][body]), None):
            return None
        table = Body.model_validate(scene["bodies"][body], context=context_of_cells(scene))
        layout = discretise(table.geometry, table.particles, None)
    except (LookupError, TypeError, OSError, ValueError, MpmfwError):  # such as a mesh file that is gone
        return None
    mass = np.asarray(points["mass"].values, dtype=float)
    if len(layout.volume) != len(mass):
        return None
    half_edges, density = layout.half_edges, mass / layout.volume
    if not np.allclose(density, density[0], rtol=1e-9, atol=0.0):
        return None

    def corners(frame: xr.Dataset) -> FloatArray:
        deformed = np.asarray(frame["deformation_gradient"].values @ half_edges)
        return parallelogram_corners(np.asarray(frame["position"].values, dtype=float), deformed)

    return corners


def surfaces_of(tree: xr.DataTree) -> list[str]:
    """Return the bodies whose surfaces are stored."""
    groups = tree["surface"].children if "surface" in tree.children else {}
    return [str(body) for body, group in groups.items() if "position" in group.data_vars]


def facets_of(tree: xr.DataTree, body: str) -> IntArray:
    """Return segments (k, 2) of a stored surface, or triangles (k, 3)."""
    surface = tree[f"surface/{body}"].to_dataset()
    if "next" in surface:
        following = np.asarray(surface["next"].values)
        return np.stack([np.arange(len(following)), following], axis=1)
    return np.asarray(surface["triangles"].values)


def loops(following: IntArray) -> list[IntArray]:
    """Split segments into closed loops of nodes, the first node repeated."""
    left, closed = dict.fromkeys(range(len(following))), []
    while left:
        loop = [next(iter(left))]
        while loop[-1] in left:
            del left[loop[-1]]
            loop.append(int(following[loop[-1]]))
        closed.append(np.array(loop))
    return closed
