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

#: Function from a body's material points at one output to the corners of their domains, (n, 4, 2) [m],
#: counter-clockwise.
Corners = Callable[[xr.Dataset], FloatArray]


def corners_of(tree: xr.DataTree, body: str) -> Corners | None:
    """Return a function that gives the corners of the domains of a body's material points.

    CPDI2 stores its corners. Those of CPDI are x_p + F R_0 ξ: x_p and F are stored, and the half-edges R_0 at
    the start follow from the scene, which the file carries, by the same discretisation as that of the run.
    None in 3D, with other shape functions, and where the scene does not give the stored points back: their
    masses over the initial areas must be one density, to 1e-9.
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
    """Triangles (k, 3) of a body's surfaces in space, by its nodes, from the scene that the results carry;
    None if it has none. Of a mesh file that has changed only the number of its nodes tells.
    """
    if (found := _body(tree, body)) is None:
        return None
    table, cell_size = found
    try:
        return joined(table.geometry.surfaces(table.segment_length(cell_size)))[1]
    except (TypeError, OSError, ValueError, MpmfwError):
        return None


def surface_in_space(tree: xr.DataTree, body: str, frame: int) -> tuple[FloatArray, IntArray] | None:
    """Return nodes (n, 3) [m] and triangles (k, 3) of a body's surface at one output, if it is stored."""
    stored = "surface" in tree.children and body in tree["surface"].children
    facets = triangles_of(tree, body) if stored else None
    if facets is None:
        return None
    return np.asarray(frame_of(tree, f"surface/{body}", frame)["position"].values, dtype=float), facets


def loops(following: IntArray) -> list[IntArray]:
    """Split the segments of a surface into closed loops of nodes, the first node repeated at the end."""
    left = dict.fromkeys(range(len(following)))
    found = []
    while left:
        start = next(iter(left))
        loop, node = [start], int(following[start])
        left.pop(start)
        while node in left:
            left.pop(node)
            loop.append(node)
            node = int(following[node])
        found.append(np.array([*loop, start]))
    return found


def _body(tree: xr.DataTree, body: str) -> tuple[Body, float] | None:
    """A body of the scene that results carry, and its cell size [m]; None where the scene has none, is of
    another version, or the body names code, which is not imported.
    """
    scene = scene_of({str(name): value for name, value in tree.attrs.items()})
    try:
        table = scene["bodies"][body]
        if next(code_in(table), None):
            return None
        return Body.model_validate(table, context=context_of_cells(scene)), cell_size_of(scene)
    except (KeyError, TypeError, ValueError, OSError, MpmfwError):
        return None
