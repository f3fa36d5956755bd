"""Triangles that fill a plane region, with all nodes of its outline and no others on it."""

from __future__ import annotations

import numpy as np
import shapely

from mpmfw.geometry.layout import FloatArray, IntArray, triangle_areas

#: Least distance of inner nodes from the outline, over the edge.
AWAY = 0.6


def plane_triangles(loops: tuple[FloatArray, ...], edge: float) -> tuple[FloatArray, IntArray]:
    """Nodes (n, 2) [m] and counter-clockwise triangles (k, 3) by Delaunay's rule; the loops' nodes come
    first.

    Parameters
    ----------
    loops : tuple of (m, 2)
        Closed polylines [m]: the outer one counter-clockwise, holes clockwise.
    edge
        Distance of the nodes inside [m], which form equilateral triangles.

    Raises
    ------
    ValueError
        Parts of the outline are nearer to each other than their nodes along it.
    """
    from scipy.spatial import Delaunay

    region = shapely.Polygon(loops[0], loops[1:])
    outline = np.concatenate(loops)
    inner = _inner_nodes(region, edge)
    nodes = np.concatenate([outline, inner])
    middle = outline.mean(axis=0)
    triangles = Delaunay((nodes - middle) / edge).simplices.astype(np.int64)
    area = triangle_areas(nodes[triangles])
    triangles = np.where(area[:, np.newaxis] < 0.0, triangles[:, ::-1], triangles)
    centre = nodes[triangles].mean(axis=1)
    shapely.prepare(region)
    triangles = triangles[
        (np.abs(area) > 1e-9 * edge**2) & shapely.contains_xy(region, centre[:, 0], centre[:, 1])
    ]
    covered = float(triangle_areas(nodes[triangles]).sum())
    if abs(covered - region.area) > 1e-9 * region.area or not _has_outline(loops, triangles):
        raise ValueError(
            f"the outline cannot be filled with triangles of {edge:.3g} m: parts of it are nearer to each "
            "other than its nodes; "
            "expected a smaller segment of the body"
        )
    return nodes, triangles


def _inner_nodes(region: object, edge: float) -> FloatArray:
    """Nodes (n, 2) [m] of equilateral triangles, symmetric about the middle of the box, not near the
    outline.
    """
    inside = shapely.buffer(region, -AWAY * edge)
    if inside.is_empty:
        return np.empty((0, 2))
    lower, upper = np.reshape(shapely.bounds(region), (2, 2))
    rows = int((upper[1] - lower[1]) / edge) + 1
    columns = int((upper[0] - lower[0]) / edge) + 1
    i, j = np.meshgrid(np.arange(-columns, columns + 1), np.arange(-rows, rows + 1), indexing="ij")
    points = np.stack([i + 0.5 * (j % 2), np.sqrt(0.75) * j], axis=-1).reshape(-1, 2)
    points = 0.5 * (lower + upper) + edge * points
    shapely.prepare(inside)
    within: FloatArray = points[shapely.contains_xy(inside, points[:, 0], points[:, 1])]
    return within


def _has_outline(loops: tuple[FloatArray, ...], triangles: IntArray) -> bool:
    """Whether every segment of the loops is a side of exactly one triangle, run in its direction."""
    sides = np.concatenate([triangles[:, [a, (a + 1) % 3]] for a in range(3)])
    key = sides[:, 0] * (triangles.max() + 1) + sides[:, 1]
    first, wanted = 0, []
    for loop in loops:
        here = first + np.arange(len(loop))
        wanted.append(here * (triangles.max() + 1) + first + (np.arange(len(loop)) + 1) % len(loop))
        first += len(loop)
    return bool(np.isin(np.concatenate(wanted), key).all())
