"""Layout: the material points of one body before the motion starts."""

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

    Surfaces are there where they were asked for. In 2D they are polylines, first point not repeated: the
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
