"""Layout: the material points of one body before the motion starts, and how facets of its surfaces hang
together."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Layout:
    """Material points of one body before the motion starts.

    Of a point's parallelogram or parallelepiped ``half_edges[p, :, a]`` is the half-edge vector r_a; det(2 r)
    > 0 is the volume.

    Surfaces are present if they were requested. In 2D they are polylines, first point not repeated: the
    material lies left of the direction of travel (outer ones counter-clockwise, holes clockwise), and a
    segment with tangent t has the outward normal (t_y, -t_x)/abs(t). Triangles are counter-clockwise as seen
    from outside.
    """

    position: FloatArray  #: (n, dim) centroids [m]
    volume: FloatArray  #: (n,) areas or volumes [m^dim]
    half_edges: FloatArray  #: (n, dim, dim) of the domains [m]
    corners: FloatArray | None  #: (n, 4, 2) of counter-clockwise quadrilateral domains [m]; None in 3D
    outlines: tuple[FloatArray, ...] = ()  #: nodes (m, dim) of every closed surface [m]
    facets: tuple[IntArray, ...] = ()  #: nodes (k, dim) of every surface's facets

    def moved(self, by: FloatArray) -> Layout:
        """The same at another place, ``by`` (dim,) [m] away."""
        return replace(
            self,
            position=self.position + by,
            corners=None if self.corners is None else self.corners + by,
            outlines=tuple(outline + by for outline in self.outlines),
        )


def layout_of_boxes(position: FloatArray, edges: FloatArray) -> Layout:
    """Return rectangular or cuboid domains: centres and edge lengths (n, dim) [m]."""
    dim = position.shape[1]
    half_edges = np.eye(dim) * (0.5 * edges)[:, np.newaxis, :]
    corners = parallelogram_corners(position, half_edges) if dim == 2 else None
    return Layout(position, np.prod(edges, axis=1), half_edges, corners)


def layout_of_quadrilaterals(corners: FloatArray) -> Layout:
    """Quadrilateral domains given by their corners (n, 4, 2) [m], counter-clockwise.

    The parallelogram of the same centre has the half-edge vectors
    r_1 = ((c_1 + c_2) - (c_0 + c_3))/4 and r_2 = ((c_2 + c_3) - (c_0 + c_1))/4. Since 2 r_1 and 2 r_2 join
    the midpoints of opposite sides, det(2 r) is the area of the quadrilateral: it is kept without scaling.
    """
    c0, c1, c2, c3 = (corners[:, k] for k in range(4))
    r1 = ((c1 + c2) - (c0 + c3)) / 4
    r2 = ((c2 + c3) - (c0 + c1)) / 4
    area = 4 * (r1[:, 0] * r2[:, 1] - r1[:, 1] * r2[:, 0])
    return Layout(quadrilateral_centroids(corners), area, np.stack([r1, r2], axis=2), corners)


def quadrilateral_centroids(corners: FloatArray) -> FloatArray:
    """Centroids (n, 2) [m] of quadrilaterals (n, 4, 2) [m], from the triangles c0 c1 c2 and c0 c2 c3."""
    first, second = corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]
    weight = np.stack([triangle_areas(first), triangle_areas(second)])
    weight = weight / weight.sum(axis=0)
    means = np.stack([first.mean(axis=1), second.mean(axis=1)])
    return np.asarray((weight[..., np.newaxis] * means).sum(axis=0))


def triangle_areas(corners: FloatArray) -> FloatArray:
    """Signed areas (n,) [m^2] of triangles (n, 3, 2) [m], positive counter-clockwise."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray(0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))


def parallelogram_corners(position: FloatArray, half_edges: FloatArray) -> FloatArray:
    """Corners (n, 4, 2) [m] x -+ r_1 -+ r_2 of parallelograms, counter-clockwise."""
    signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return np.asarray(position[:, np.newaxis, :] + np.einsum("nia,ka->nki", half_edges, signs))


def neighbours_of(facets: IntArray) -> IntArray:
    """Facet across the side opposite each corner (n_f, dim); a ValueError if the surface is not closed."""
    n, dim = facets.shape
    corners = [[b for b in range(dim) if b != a] for a in range(dim)]
    sides = np.sort(np.concatenate([facets[:, rest] for rest in corners]), axis=1)
    order = np.lexsort(sides.T[::-1])
    ordered = sides[order]
    in_pairs = len(ordered) % 2 == 0 and (ordered[::2] == ordered[1::2]).all()
    if not in_pairs or (ordered[1:-1:2] == ordered[2::2]).all(1).any():
        raise ValueError("the surface is not closed: a side of a facet has not exactly one other facet")
    across = np.empty(n * dim, dtype=np.int64)
    across[order[::2]], across[order[1::2]] = order[1::2] % n, order[::2] % n
    return np.ascontiguousarray(across.reshape(dim, n).T)


def stars_of(facets: IntArray, n_nodes: int) -> tuple[IntArray, IntArray]:
    """Facets round every node: ``star[first[s]:first[s + 1]]``; returns ``first`` and ``star``.

    In the plane the segment that ends at the node comes before the one that starts there.
    """
    node = facets.T[::-1].ravel()
    order = np.argsort(node, kind="stable")
    first = np.searchsorted(node[order], np.arange(n_nodes + 1))
    return first.astype(np.int64), (order % len(facets)).astype(np.int64)


def measures_of(position: FloatArray, facets: IntArray) -> FloatArray:
    """Length [m] or area [m^2] of every facet (n_f,)."""
    edges = position[facets[:, 1:]] - position[facets[:, :1]]
    if facets.shape[1] == 2:
        return np.asarray(np.linalg.norm(edges[:, 0], axis=1))
    return np.asarray(0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1))


def tributaries_of(position: FloatArray, facets: IntArray) -> FloatArray:
    """Length or area that every node stands for (n_s,): of each of its facets an equal part."""
    part = measures_of(position, facets) / facets.shape[1]
    tributary = np.zeros(len(position))
    for corner in facets.T[::-1]:
        np.add.at(tributary, corner, part)
    return tributary
