"""The surfaces of all bodies as one array of nodes and facets."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from mpmfw.geometry.layout import neighbours_of, stars_of, tributaries_of
from mpmfw.kernels.sides import minimum_gaps
from mpmfw.state.fields import AnyArray, FloatArray, IntArray
from mpmfw.state.structs import Body, Grid, Surface


def make_surface(bodies: tuple[Body, ...], n_fields: int, stage: str) -> Surface:
    """Join the bodies' surfaces; stage ``gap`` is of the diagnostic alone."""
    position, facets, owner, facet_owner = [], [], [], []
    start = 0
    for body in bodies:
        for nodes, corners in zip(body.outlines, body.facets, strict=True):
            position.append(nodes)
            facets.append(start + corners)
            owner.append(np.full(len(nodes), body.index))
            facet_owner.append(np.full(len(corners), body.index))
            start += len(nodes)
    places, joined = np.ascontiguousarray(np.concatenate(position)), np.concatenate(facets).astype(np.int64)
    of_body, index = np.concatenate(owner).astype(np.int64), np.arange(len(bodies) + 1)
    star_first, star = stars_of(joined, len(places))
    body_first = np.searchsorted(of_body, index)
    return Surface(
        position=places,
        displacement=np.zeros_like(places),
        tributary=tributaries_of(places, joined),
        facets=joined,
        neighbours=neighbours_of(joined),
        star_first=star_first,
        star=star,
        body=of_body,
        first=body_first if n_fields == len(bodies) else np.array([0, len(places)]),
        body_first=body_first,
        facet_first=np.searchsorted(np.concatenate(facet_owner), index),
        stage=stage,
        rigid_nodes=sum(len(nodes) for body in bodies if body.rigid for nodes in body.outlines),
    )


def outer_facets(surface: Surface, grid: Grid) -> IntArray:
    """Return the facets that others may touch (n,): all but those on the axis of a body of revolution."""
    return np.flatnonzero(~grid.on_axis(surface.position[surface.facets]).all(axis=1))


def nodes_left(surface: Surface) -> AnyArray:
    """Return which nodes have left their points, (n_s,): the table of the step gives them no weights."""
    if surface.table is None:
        return np.zeros(surface.count, dtype=bool)
    row = surface.table.row[: surface.count + 1]
    return ~np.logical_or.reduceat(surface.table.weight[: row[-1]] != 0.0, row[:-1])


def closed_surface(surface: Surface) -> Surface:
    """Return the surface with a membrane between the others instead of nodes that have left their points. A
    closed part of which all nodes have left stays as it is."""
    left = nodes_left(surface)
    if not left.any():
        return surface
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components, laplacian
    from scipy.sparse.linalg import splu

    ends = surface.facets.ravel(), np.roll(surface.facets, 1, axis=1).ravel()
    edges = csr_array((np.ones(len(ends[0])), ends), shape=(surface.count,) * 2)
    part = connected_components(edges, directed=False)[1]
    left &= np.isin(part, part[~left])
    pull, position = laplacian(edges, symmetrized=True).tocsr()[left], surface.position.copy()
    if left.any():
        position[left] = splu(pull[:, left].tocsc()).solve(-pull[:, ~left] @ position[~left])
    return dataclasses.replace(surface, position=position)


def least_gaps(surface: Surface, first: IntArray, second: IntArray, spacing: tuple[float, ...]) -> FloatArray:
    """Return the least node-to-facet distance of every two bodies, (n,) [m]."""
    gaps = np.zeros(len(first))
    minimum_gaps(first, second, surface.body_first, surface.facet_first, surface, gaps, spacing)
    return gaps


def moments_of(
    outlines: tuple[FloatArray, ...], facets: tuple[Any, ...]
) -> tuple[float, FloatArray, FloatArray]:
    """Return volume, centroid and ∫ r rᵀ about it of what closed surfaces enclose, of their simplices."""
    corners = np.concatenate([nodes[own] for nodes, own in zip(outlines, facets, strict=True)])
    dim = corners.shape[1]
    origin = corners.mean(axis=(0, 1))
    corners = corners - origin
    part = np.linalg.det(corners) / (2.0 if dim == 2 else 6.0)
    total, volume = corners.sum(axis=1), float(part.sum())
    centre = part @ total / (dim + 1) / volume
    second = np.einsum("k,kad,kae->de", part, corners, corners) + np.einsum("k,kd,ke->de", part, total, total)
    second = second / ((dim + 1) * (dim + 2)) - volume * np.outer(centre, centre)
    return volume, origin + centre, second
