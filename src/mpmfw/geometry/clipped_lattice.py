"""Lattice layouts: square cells clipped by an outline, and tilings of rectangles and boxes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from mpmfw.geometry.layout import FloatArray, Layout, layout_of_boxes

# Pieces below this fraction of a cell would make light particles, with large accelerations
SMALLEST_PIECE = 0.25


@dataclass(frozen=True)
class Cells:
    """Square or cubic lattice cells: cell i has its lowest corner at origin + edge i."""

    origin: FloatArray  #: (dim,) lowest corner of the lattice [m]
    edge: float  #: of a cell [m]
    counts: tuple[int, ...]  #: cells along each axis

    def corner(self, index: npt.NDArray[np.intp]) -> FloatArray:
        """Lattice nodes (..., 2) [m]; one formula for all, so that neighbours share them exactly."""
        return np.asarray(self.origin + self.edge * index)


def covering_cells(bounds: FloatArray, size: float, offset: tuple[float, ...]) -> Cells:
    """The lattice that covers a bounding box (2, dim) [m], symmetric about its centre for zero ``offset``."""
    lower, upper = bounds
    counts = np.ceil((upper - lower) / size - 1e-9).astype(int)
    origin = 0.5 * (lower + upper) - 0.5 * size * counts
    # A shifted lattice needs one more cell on the side it leaves
    shifted = np.array(offset) > 0
    origin = origin + size * (np.array(offset) - shifted)
    counts = counts + shifted
    return Cells(origin, size, tuple(counts.tolist()))


def clipped_lattice(region: Any, size: float, offset: tuple[float, ...]) -> Layout:
    """Square cells of edge ``size`` [m], shifted by ``offset`` (fractions), clipped by a shapely polygon.

    A particle has the area and the centroid of its clipped piece, and a square domain of that area. Pieces
    below a quarter of a cell join the neighbour with which they share the longest edge.
    """
    cells = covering_cells(np.reshape(region.bounds, (2, 2)), size, offset)
    index = np.stack(np.meshgrid(*map(np.arange, cells.counts), indexing="ij"), axis=-1).reshape(-1, 2)
    area, centroid = _clip(region, cells, index)
    kept = area > 1e-12 * size**2
    index, area, centroid = index[kept], area[kept], centroid[kept]
    small = np.flatnonzero(area < SMALLEST_PIECE * size**2)
    shared = _shared_edges(region, cells, index[small])
    area, centroid = merge_small_pieces(index, area, centroid, small, shared, SMALLEST_PIECE * size**2)
    return layout_of_boxes(centroid, np.repeat(np.sqrt(area)[:, np.newaxis], 2, axis=1))


def _clip(region: Any, cells: Cells, index: npt.NDArray[np.intp]) -> tuple[FloatArray, FloatArray]:
    """Areas (n,) [m^2] and centroids (n, 2) [m] of the parts of the cells (n, 2) inside the region."""
    lower, upper = cells.corner(index), cells.corner(index + 1)
    boxes = shapely.box(lower[:, 0], lower[:, 1], upper[:, 0], upper[:, 1])
    shapely.prepare(region)
    covered = shapely.covers(region, boxes)
    area = np.where(covered, cells.edge**2, 0.0)
    centroid = 0.5 * (lower + upper)
    crossed = np.flatnonzero(~covered & shapely.intersects(region, boxes))
    pieces = shapely.intersection(boxes[crossed], region)
    area[crossed] = shapely.area(pieces)
    crossed, pieces = crossed[area[crossed] > 0], pieces[area[crossed] > 0]
    centroid[crossed] = shapely.get_coordinates(shapely.centroid(pieces))
    return area, centroid


def _shared_edges(region: Any, cells: Cells, index: npt.NDArray[np.intp]) -> FloatArray:
    """Lengths (k, 4) [m] inside the region of the left, right, lower and upper edges of cells (k, 2)."""
    ends = np.array([[[0, 0], [0, 1]], [[1, 0], [1, 1]], [[0, 0], [1, 0]], [[0, 1], [1, 1]]])
    edges = shapely.linestrings(cells.corner(index[:, np.newaxis, np.newaxis, :] + ends))
    return np.asarray(shapely.length(shapely.intersection(edges, region)))


def tiling(
    lower: tuple[float, ...], upper: tuple[float, ...], size: float, offset: tuple[float, ...]
) -> Layout:
    """Cells of edge length/ceil(length/size) along each axis, which fill the box between two corners [m].

    With an ``offset`` (fractions of a cell) the cells are shifted and cut at the faces; what is cut off too
    short joins the next cell.
    """
    dim = len(lower)
    faces = [_faces(lower[a], upper[a], size, offset[a], dim) for a in range(dim)]
    centres = np.meshgrid(*(0.5 * (x[1:] + x[:-1]) for x in faces), indexing="ij")
    edges = np.meshgrid(*(np.diff(x) for x in faces), indexing="ij")
    return layout_of_boxes(np.stack(centres, -1).reshape(-1, dim), np.stack(edges, -1).reshape(-1, dim))


def _faces(lower: float, upper: float, size: float, offset: float, dim: int) -> FloatArray:
    """Coordinates (n + 1,) [m] of the faces between cells along one axis."""
    n = max(1, math.ceil((upper - lower) / size - 1e-9))
    if offset == 0:
        return np.linspace(lower, upper, n + 1)
    edge = (upper - lower) / n
    inner = lower + edge * (np.arange(n) + offset)
    # The root keeps a piece cut in every direction above the smallest volume
    least = SMALLEST_PIECE ** (1 / dim) * edge
    inner = inner[(inner - lower >= least) & (upper - inner >= least)]
    return np.concatenate([[lower], inner, [upper]])


#: Largest distance in cells of joined pieces: farther surface nodes would lie on cells without mass.
FARTHEST = 2

#: Of equal faces that across x wins, then y, and inwards: round-off cannot break a mirror symmetry
TIE_BREAK = 1e-9


def merge_small_pieces(
    index: npt.NDArray[np.intp],
    volume: FloatArray,
    centroid: FloatArray,
    small: npt.NDArray[np.intp],
    shared: FloatArray,
    least_volume: float,
) -> tuple[FloatArray, FloatArray]:
    """Join each small piece to the neighbour with which it shares the longest edge, or the largest face.

    The pieces lie at lattice ``index`` (n, dim), with ``volume`` (n,) and ``centroid`` (n, dim); those
    numbered ``small`` (k,) are below ``least_volume``. ``shared`` (k, 2 dim) are the lengths or areas that
    these share with the neighbours below and above along x, then y, then z. Return volumes and centroids of
    the joint pieces. A small piece stays if it has no neighbour, or if one of its pieces would join another
    more than two cells away: else the end of a thin fin would have no point."""
    dim = index.shape[1]
    if len(index) == 0:
        raise ValueError("its volume is within rounding of zero; expected a larger body or smaller particles")
    beyond = np.round(index[small] - volume @ index / volume.sum(), 6)  # the centre of mass
    outward = np.stack([beyond < 0, beyond > 0], axis=2).reshape(len(small), 2 * dim)
    preferred = shared * (1.0 - TIE_BREAK * (np.repeat(np.arange(dim), 2) + 0.5 * outward))
    order = np.argsort(-preferred, axis=1, kind="stable")
    beside = np.take_along_axis(np.where(shared > 0.0, _neighbours(index, small), -1), order, axis=1)
    owner, joint = np.arange(len(volume)), volume.copy()
    ends = np.stack([index, index])  # lower and upper, of every joint piece
    # Equal ones from the middle outwards: a body and its mirror image have the same points
    for k in np.lexsort((abs(beyond).sum(axis=1), np.round(volume[small] / least_volume, 9))):
        piece = int(small[k])
        # Pieces that joined this one may have made it large enough
        if joint[piece] < least_volume:
            root = owner[piece] = _most_shared(piece, beside[k], owner, index, ends[:, piece])
            joint[root] += joint[piece]
            ends[0, root] = np.minimum(*ends[0, [root, piece]])
            ends[1, root] = np.maximum(*ends[1, [root, piece]])
    roots = owner.copy()
    for piece in small.tolist():
        roots[piece] = _root(owner, piece)
    total = np.bincount(roots, weights=volume, minlength=len(volume)).astype(np.float64)
    sums = [np.bincount(roots, weights=volume * x, minlength=len(volume)) for x in centroid.T]
    moment = np.column_stack(sums)
    kept = np.flatnonzero(owner == np.arange(len(volume)))
    return total[kept], moment[kept] / total[kept, np.newaxis]


def _neighbours(index: npt.NDArray[np.intp], small: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """Pieces (k, 2 dim) below and above the small ones along every axis; −1 where there is none."""
    dim = index.shape[1]
    lower = index.min(axis=0) - 1
    counts = tuple(index.max(axis=0) - lower + 2)
    number = np.full(counts, -1)
    number[tuple((index - lower).T)] = np.arange(len(index))
    steps = [side * (np.arange(dim) == axis) for axis in range(dim) for side in (-1, 1)]
    return np.stack([number[tuple((index[small] - lower + step).T)] for step in steps], axis=1)


def _most_shared(
    piece: int, beside: npt.NDArray[np.intp], owner: npt.NDArray[np.intp], index: npt.NDArray[np.intp],
    ends: npt.NDArray[np.intp],
) -> int:  # fmt: skip
    """Return the joint piece of the neighbours ``beside`` that shares most with ``piece`` and is near its
    ``ends``, or itself."""
    for other in beside.tolist():
        root = _root(owner, other) if other >= 0 else piece
        if root != piece and abs(index[root] - ends).max() <= FARTHEST:
            return root
    return piece


def _root(owner: npt.NDArray[np.intp], piece: int) -> int:
    while owner[piece] != piece:
        piece = int(owner[piece])
    return piece
