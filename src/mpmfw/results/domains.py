"""Geometry of a stored run that follows from its scene: domains of CPDI (2D), triangles of surfaces (3D)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from mpmfw.errors import MpmfwError
from mpmfw.geometry import discretise
from mpmfw.geometry.base import context_of_cells
from mpmfw.geometry.layout import parallelogram_corners
from mpmfw.geometry.solid import joined
from mpmfw.results.references import cell_size_of, scene_of
from mpmfw.results.selection import frame_of
from mpmfw.scene.content import code_in
from mpmfw.scene.tables import Body
from mpmfw.state.fields import FloatArray, IntArray

#: Corners of the domains of material points at one output, (n, 4, 2) [m], counter-clockwise.
Corners = Callable[[xr.Dataset], FloatArray]


def corners_of(tree: xr.DataTree, body: str) -> Corners | None:
    """Return a function that gives the corners of the domains of a body's material points.

    CPDI2 stores them. Those of CPDI are x_p + F R_0 ξ, with the half-edges R_0 of the stored scene's layout.
    None in 3D, with other shape functions, and where the layout's areas do not fit the stored masses.
    """
    points = tree[f"particles/{body}"].to_dataset()
    if points.sizes.get("axis") != 2:
        return None
    if "corners" in points and points["corners"].sizes.get("corner") == 4:
        return lambda frame: np.asarray(frame["corners"].values, dtype=float)
    needed = {"position", "deformation_gradient", "mass"}
    if not str(tree.attrs.get("shape", "")).startswith("cpdi") or not needed <= set(points.data_vars):
        return None
    if (found := _body(tree, body)) is None:
        return None
    try:
        layout = discretise(found[0].geometry, found[0].particles, None)
    except (OSError, ValueError, MpmfwError):  # a mesh file that is no longer there
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


def triangles_of(tree: xr.DataTree, body: str) -> IntArray | None:
    """Return the triangles (k, 3) of a body's surface in space, by node."""
    if (found := _body(tree, body)) is None:
        return None
    table, cell_size = found
    try:
        return joined(table.geometry.surfaces(table.segment_length(cell_size)))[1]
    except (TypeError, OSError, ValueError, MpmfwError):
        return None


def surface_in_space(tree: xr.DataTree, body: str, frame: int) -> tuple[FloatArray, IntArray] | None:
    """Return nodes (n, 3) [m] and triangles (k, 3) of a stored surface."""
    stored = "surface" in tree.children and body in tree["surface"].children
    facets = triangles_of(tree, body) if stored else None
    if facets is None:
        return None
    return np.asarray(frame_of(tree, f"surface/{body}", frame)["position"].values, dtype=float), facets


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


def _body(tree: xr.DataTree, body: str) -> tuple[Body, float] | None:
    """Return a body of the stored scene, if it names no code, and the cell size [m]."""
    scene = scene_of({str(name): value for name, value in tree.attrs.items()})
    try:
        table = scene["bodies"][body]
        if next(code_in(table), None):
            return None
        return Body.model_validate(table, context=context_of_cells(scene)), cell_size_of(scene)
    except (KeyError, TypeError, ValueError, OSError, MpmfwError):
        return None
