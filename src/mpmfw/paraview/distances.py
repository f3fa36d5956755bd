"""Signed distances of points from closed surfaces, negative inside the material."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from mpmfw.results.domains import loops
from mpmfw.state.fields import FloatArray, IntArray


def distances_in_plane(points: FloatArray, nodes: FloatArray, segments: IntArray) -> FloatArray:
    """Signed distance (n,) [m] of points (n, 2) from closed polylines.

    Parameters
    ----------
    nodes, segments : (s, 2), (s, 2)
        Of the polylines [m]; the first node of segment s is node s. The material lies inside an odd number of
        them.
    """
    rings = [shapely.Polygon(nodes[loop]) for loop in loops(segments[:, 1])]
    outlines = shapely.MultiLineString([ring.exterior for ring in rings])
    shapely.prepare(rings)
    inside = np.logical_xor.reduce([shapely.contains_xy(ring, points) for ring in rings])
    distance = shapely.distance(outlines, shapely.points(points))
    return np.asarray(np.where(inside, -distance, distance))


def distances_in_space(
    points: FloatArray, nodes: FloatArray, facets: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Signed distance of points from a closed surface of triangles, and the outward direction of the surface
    there.

    Where the nearest point lies on an edge or a node the angle-weighted normal decides (J. A. Bærentzen, H.
    Aanæs, 2005), as for ``min_gap``.

    Parameters
    ----------
    points : (n, 3)
        [m].
    nodes, facets : (s, 3), (k, 3)
        Of the surface [m], counter-clockwise as seen from outside.

    Returns
    -------
    tuple
        (n,) [m], and unit vectors (n, 3) along the distance; zero where the distance is zero.
    """
    import pyvista

    mesh: Any = pyvista.PolyData  # its annotations know no fixed width of integers
    surface = mesh.from_regular_faces(nodes, facets)
    cloud = mesh(points).compute_implicit_distance(surface)
    gap = np.asarray(cloud["implicit_distance"])
    nearest = surface.find_closest_cell(points, return_closest_point=True)[1]
    away = points - nearest
    outward = np.zeros_like(points)
    np.divide(away, gap[:, np.newaxis], out=outward, where=gap[:, np.newaxis] != 0.0)
    return gap, outward
