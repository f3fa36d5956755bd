"""What a closed surface of triangles cuts out of the cells of a cubic lattice: volumes, centroids and faces, without quadrature.

In edges of a cell, the part of cell (i, j, k) below a point of the surface at height z is clamp(z − k, 0, 1) high, so that

    V = ∮ clamp(z − k, 0, 1) n_z dA   over the surface's part in the column (i, j),

and likewise for moments: facets inside the cell give their own, those above it a whole column, those below nothing. Facets are
cut at the planes of the lattice first, so that each piece lies in one cell and every integrand is a polynomial. The area of a
cell's face inside the body follows from that of the face before, ΔA = −Σ n dA over the pieces in between: the vector areas of a
closed surface add up to nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmfw.geometry.layout import FloatArray, IntArray

#: Corners so near to a plane of the lattice are put on it [cells].
NEAR = 1e-9


@dataclass(frozen=True)
class Cuts:
    """Parts of the cells of a lattice inside a surface; lengths in edges of a cell.

    Attributes
    ----------
    volume : (n_x, n_y, n_z)
        Of the parts, 0 … 1.
    moment : (n_x, n_y, n_z, 3)
        ∫ x dV of each, from the lattice's origin.
    faces : three of (n_x, n_y, n_z)
        Area of each cell's lower face across x, y and z inside the body.
    """

    volume: FloatArray
    moment: FloatArray
    faces: tuple[FloatArray, FloatArray, FloatArray]


def cut_cells(corners: FloatArray, counts: tuple[int, int, int]) -> Cuts:
    """Cut the cells of a lattice by a closed surface inside of it.

    Parameters
    ----------
    corners : (n, 3, 3)
        Of the triangles, counter-clockwise as seen from outside; from the lattice's origin, in edges of a cell.
    counts
        Number of cells along each axis.
    """
    whole = np.round(corners)
    pieces = np.where(np.abs(corners - whole) < NEAR, whole, corners)
    for axis in range(3):
        pieces = _cut_at_planes(pieces, axis)
    centre = pieces.mean(axis=1)
    index = np.clip(np.floor(centre).astype(np.int64), 0, np.array(counts) - 1)
    cell = np.ravel_multi_index(tuple(index.T), counts)
    area = 0.5 * np.cross(pieces[:, 1] - pieces[:, 0], pieces[:, 2] - pieces[:, 0])

    def summed(values: FloatArray) -> FloatArray:
        sums = np.bincount(cell, weights=values, minlength=int(np.prod(counts)))
        return sums.astype(np.float64).reshape(counts)

    def below(values: FloatArray) -> FloatArray:
        """Sums over the pieces in the cells above each."""
        from_top = np.cumsum(summed(values)[:, :, ::-1], axis=2)[:, :, ::-1]
        return np.concatenate([from_top[:, :, 1:], np.zeros((*counts[:2], 1))], axis=2)

    up, high = area[:, 2], pieces[:, :, 2] - index[:, 2, np.newaxis]
    volume = summed(up * high.mean(axis=1)) + (above := below(up))
    moment = np.empty((*counts, 3))
    for axis in range(2):
        along = pieces[:, :, axis]
        moment[..., axis] = summed(up * _mean_product(along, high)) + below(up * centre[:, axis])
    layer = np.arange(counts[2])
    moment[..., 2] = summed(0.5 * up * _mean_product(high, high)) + 0.5 * above + layer * volume
    faces = (_lower_faces(summed(area[:, axis]), axis) for axis in range(3))
    return Cuts(volume, moment, tuple(faces))  # type: ignore[arg-type]


def _lower_faces(through: FloatArray, axis: int) -> FloatArray:
    """Areas of the cells' lower faces from the sums ∫ n dA of the pieces in every cell."""
    faces: FloatArray = through - np.cumsum(through, axis=axis)
    return faces


def _mean_product(u: FloatArray, v: FloatArray) -> FloatArray:
    """Mean over triangles of the product of two linear functions, given at their corners (n, 3)."""
    mean: FloatArray = (u.sum(axis=1) * v.sum(axis=1) + (u * v).sum(axis=1)) / 12.0
    return mean


def _cut_at_planes(pieces: FloatArray, axis: int) -> FloatArray:
    """The triangles cut at all planes of the lattice across an axis, each at the middle one of its planes first."""
    done: list[FloatArray] = []
    while len(pieces):
        along = pieces[:, :, axis]
        first, last = np.floor(along.min(axis=1)) + 1.0, np.ceil(along.max(axis=1)) - 1.0
        crossing = first <= last
        done.append(pieces[~crossing])
        plane = np.floor(0.5 * (first + last))[crossing]
        pieces = _cut_once(pieces[crossing], axis, plane)
    return np.concatenate(done)


def _cut_once(pieces: FloatArray, axis: int, plane: FloatArray) -> FloatArray:
    """Each triangle cut in three at its plane, which it crosses; those without an area are left out."""
    if not len(pieces):
        return pieces
    rows = np.arange(len(pieces))
    above = pieces[:, :, axis] >= plane[:, np.newaxis]
    # the corner that is alone on its side, and the two that follow it
    lone = np.argmax(above == (above.sum(axis=1) == 1)[:, np.newaxis], axis=1)
    a, b, c = (pieces[rows, (lone + k) % 3] for k in range(3))

    def crossing(end: FloatArray) -> FloatArray:
        share = (plane - a[:, axis]) / (end[:, axis] - a[:, axis])
        point: FloatArray = a + share[:, np.newaxis] * (end - a)
        point[:, axis] = plane
        return point

    p, q = crossing(b), crossing(c)
    parts = np.concatenate([np.stack(one, axis=1) for one in ((a, p, q), (p, b, c), (p, c, q))])
    area = np.cross(parts[:, 1] - parts[:, 0], parts[:, 2] - parts[:, 0])
    kept: FloatArray = parts[(area * area).sum(axis=1) > 0.0]
    return kept


def volume_of(nodes: FloatArray, facets: IntArray) -> float:
    """Volume [m^3] that a closed surface encloses; negative where its facets are turned inwards."""
    about = nodes - nodes.mean(axis=0)
    a, b, c = (about[facets[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


def centroid_of(nodes: FloatArray, facets: IntArray) -> FloatArray:
    """Centroid (3,) [m] of what a closed surface encloses."""
    middle = nodes.mean(axis=0)
    a, b, c = ((nodes - middle)[facets[:, k]] for k in range(3))
    sixfold = (a * np.cross(b, c)).sum(axis=1)
    centroid: FloatArray = middle + sixfold @ (a + b + c) / (4.0 * sixfold.sum())
    return centroid
