"""What a closed surface of triangles cuts out of the cells of a cubic lattice: volumes, centroids and faces,
without quadrature.

In edges of a cell, the part of cell (i, j, k) below a point of the surface at height z is clamp(z − k, 0, 1)
high, so that

    V = ∮ clamp(z − k, 0, 1) n_z dA   over the surface's part in the column (i, j),

and likewise for moments: facets inside the cell give their own, those above it a whole column, those below
nothing. Facets are cut at the planes of the lattice first, so that each piece lies in one cell and every
integrand is a polynomial. The area of a cell's face inside the body follows from that of the face before, ΔA
= −Σ n dA over the pieces in between: the vector areas of a closed surface add up to nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmfw.geometry.layout import FloatArray, IntArray

#: Corners so near to a plane of the lattice are put on it [cells].
NEAR = 1e-9


@dataclass(frozen=True)
class Cuts:
    """Parts of the cells of a lattice inside a surface; lengths in edges of a cell."""

    volume: FloatArray  #: (n_x, n_y, n_z) of the parts, 0 … 1
    moment: FloatArray  #: (n_x, n_y, n_z, 3) ∫ x dV of each, from the lattice's origin
    faces: tuple[FloatArray, FloatArray, FloatArray]  #: of each cell's lower faces the area in the body


def cut_cells(corners: FloatArray, counts: tuple[int, ...]) -> Cuts:
    """Cut the cells of a lattice, ``counts`` along each axis, by a closed surface inside of it.

    ``corners`` (n, 3, 3) of its triangles are counter-clockwise as seen from outside; they are measured from
    the lattice's origin, in edges of a cell.
    """
    # (corner, axis, triangle): sums over three numbers that lie side by side cost numpy as much as over many
    pieces = np.ascontiguousarray(np.moveaxis(corners, 0, 2))
    whole = np.round(pieces)
    pieces = np.where(np.abs(pieces - whole) < NEAR, whole, pieces)
    for axis in range(3):
        pieces = _cut_at_planes(pieces, axis)
    centre = _sum(pieces) / 3.0
    index = np.clip(np.floor(centre).astype(np.int64), 0, np.array(counts)[:, np.newaxis] - 1)
    cell = np.ravel_multi_index(tuple(index), counts)
    area = 0.5 * _normals(pieces)

    def summed(values: FloatArray) -> FloatArray:
        sums = np.bincount(cell, weights=values, minlength=int(np.prod(counts)))
        return sums.astype(np.float64).reshape(counts)

    def below(values: FloatArray) -> FloatArray:
        """Sums over the pieces in the cells above each."""
        from_top = np.cumsum(summed(values)[:, :, ::-1], axis=2)[:, :, ::-1]
        return np.concatenate([from_top[:, :, 1:], np.zeros((*counts[:2], 1))], axis=2)

    up, high = area[2], pieces[:, 2] - index[2]
    volume = summed(up * (_sum(high) / 3.0)) + (above := below(up))
    moment = np.empty((*counts, 3))
    for axis in range(2):
        moment[..., axis] = summed(up * _mean_product(pieces[:, axis], high)) + below(up * centre[axis])
    layer = np.arange(counts[2])
    moment[..., 2] = summed(0.5 * up * _mean_product(high, high)) + 0.5 * above + layer * volume
    through = (summed(area[axis]) for axis in range(3))
    faces = (one - np.cumsum(one, axis=axis) for axis, one in enumerate(through))
    return Cuts(volume, moment, tuple(faces))  # type: ignore[arg-type]


def _sum(corners: FloatArray) -> FloatArray:
    return np.asarray(corners[0] + corners[1] + corners[2])


def _mean_product(u: FloatArray, v: FloatArray) -> FloatArray:
    """Mean over triangles of the product of two linear functions, given at their corners (3, n)."""
    return np.asarray((_sum(u) * _sum(v) + _sum(u * v)) / 12.0)


def _normals(pieces: FloatArray) -> FloatArray:
    """Twice the vector areas (3, n) of triangles (3, 3, n)."""
    (ux, uy, uz), (vx, vy, vz) = pieces[1] - pieces[0], pieces[2] - pieces[0]
    return np.stack([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx])


def _cut_at_planes(pieces: FloatArray, axis: int) -> FloatArray:
    """Cut the triangles at all planes of the lattice across an axis, the middle plane of each first."""
    done: list[FloatArray] = []
    while pieces.shape[2]:
        a, b, c = pieces[:, axis]
        first = np.floor(np.minimum(np.minimum(a, b), c)) + 1.0
        last = np.ceil(np.maximum(np.maximum(a, b), c)) - 1.0
        crossing = first <= last
        done.append(pieces[..., ~crossing])
        plane = np.floor(0.5 * (first + last))[crossing]
        pieces = _cut_once(pieces[..., crossing], axis, plane)
    return np.concatenate(done, axis=2)


def _cut_once(pieces: FloatArray, axis: int, plane: FloatArray) -> FloatArray:
    """Each triangle cut in three at its plane, which it crosses; those without an area are left out."""
    above = pieces[:, axis] >= plane
    # the corner that is alone on its side, and the two that follow it
    lone = np.argmax(above == (above.sum(axis=0) == 1), axis=0)
    a, b, c = (np.choose((lone + k) % 3, pieces) for k in range(3))

    def crossing(end: FloatArray) -> FloatArray:
        share = (plane - a[axis]) / (end[axis] - a[axis])
        point: FloatArray = a + share * (end - a)
        point[axis] = plane
        return point

    p, q = crossing(b), crossing(c)
    parts = np.concatenate([np.stack(one) for one in ((a, p, q), (p, b, c), (p, c, q))], axis=2)
    x, y, z = _normals(parts)
    return np.asarray(parts[..., x * x + y * y + z * z > 0.0])


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
    return np.asarray(middle + sixfold @ (a + b + c) / (4.0 * sixfold.sum()))
