"""Finite elements as they stand in a mesh file: plane triangles and quadrilaterals."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from mpmfw.geometry.gmsh_file import read_blocks
from mpmfw.geometry.layout import FloatArray, quadrilateral_centroids, triangle_areas

IntArray = npt.NDArray[np.intp]
# gmsh's numbers of first-order triangles and quadrangles, and their nodes
KINDS = {2: 3, 3: 4}
#: Of the parallelogram of a corner over the square of the longest side: an element with less has no area.
FLAT = 1e-10


@dataclass(frozen=True)
class Elements:
    """Counter-clockwise elements of a plane mesh.

    Attributes
    ----------
    nodes : (n, 2)
        Coordinates [m].
    triangles, quadrilaterals : (k, 3), (m, 4)
        Node numbers.
    """

    nodes: FloatArray
    triangles: IntArray
    quadrilaterals: IntArray

    @property
    def pieces(self) -> FloatArray:
        """Quadrilaterals (3 k + m, 4, 2) [m]; a triangle gives three, which meet at its centroid."""
        corner = self.nodes[self.triangles]
        after = 0.5 * (corner + np.roll(corner, -1, axis=1))
        centroid = np.broadcast_to(corner.mean(axis=1, keepdims=True), corner.shape)
        thirds = np.stack([corner, after, centroid, np.roll(after, 1, axis=1)], axis=2).reshape(-1, 4, 2)
        return np.concatenate([thirds, self.nodes[self.quadrilaterals]])

    @property
    def area(self) -> float:
        """Total area [m^2]."""
        quadrilaterals = self.nodes[self.quadrilaterals]
        halves = np.concatenate([quadrilaterals[:, [0, 1, 2]], quadrilaterals[:, [0, 2, 3]]])
        return float(triangle_areas(self.nodes[self.triangles]).sum() + triangle_areas(halves).sum())

    @property
    def centroid(self) -> FloatArray:
        """Centroid (2,) [m] of the whole mesh."""
        pieces = self.pieces
        area = triangle_areas(pieces[:, [0, 1, 2]]) + triangle_areas(pieces[:, [0, 2, 3]])
        centroid: FloatArray = area @ quadrilateral_centroids(pieces) / area.sum()
        return centroid


def read_elements(path: Path) -> Elements:
    """Read the triangles and quadrilaterals of a gmsh file.

    Raises
    ------
    ValueError
        No such file, not a gmsh file, gmsh is not installed, coordinates that are no numbers, not in the x-y
        plane, elements of another kind, or degenerate ones.
    """
    if not path.is_file():
        raise ValueError(f"mesh file not found: {path}")
    points, blocks = read_blocks(path, KINDS)
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        raise ValueError(
            f"{path} has coordinates that are no finite numbers: {len(wrong)} nodes, the first number "
            f"{wrong[0]}, counted from 0"
        )
    if len(points) and np.ptp(points[:, 2:]) > 1e-9 * np.ptp(points):
        raise ValueError(f"{path} is not in a plane z = constant")
    if not any(map(len, blocks.values())):
        raise ValueError(f"{path} has no triangles or quads")
    triangles, quadrilaterals = (
        _counter_clockwise(points[:, :2], blocks[kind].astype(np.intp), path) for kind in KINDS
    )
    return Elements(points[:, :2], triangles, quadrilaterals)


def _counter_clockwise(nodes: FloatArray, elements: IntArray, path: Path) -> IntArray:
    """Elements (n, k) turned counter-clockwise; refused where a corner is flat or reentrant."""
    corner = nodes[elements]
    ahead, behind = np.roll(corner, -1, axis=1) - corner, corner - np.roll(corner, 1, axis=1)
    turn = behind[..., 0] * ahead[..., 1] - behind[..., 1] * ahead[..., 0]
    least = FLAT * (ahead**2).sum(axis=2).max(axis=1, keepdims=True)
    convex = (turn > least).all(axis=1) | (turn < -least).all(axis=1)
    if not convex.all():
        first = corner[~convex][0].mean(axis=0)
        raise ValueError(
            f"{path} has {np.count_nonzero(~convex)} degenerate or non-convex elements, the first at "
            f"({first[0]:.4g}, "
            f"{first[1]:.4g}) m"
        )
    return np.where(turn[:, :1] > 0, elements, elements[:, ::-1])
