"""Merging of small pieces of a clipped lattice with a neighbour."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from mpmfw.geometry.layout import FloatArray

#: Of equal faces that across x wins, then y, on every side alike: round-off cannot break a mirror symmetry
TIE_BREAK = 1e-9


def merge_small_pieces(
    index: npt.NDArray[np.intp],
    volume: FloatArray,
    centroid: FloatArray,
    small: npt.NDArray[np.intp],
    shared: FloatArray,
    least_volume: float,
) -> tuple[FloatArray, FloatArray]:
    """Join each small piece to the neighbour with which it shares the longest edge, in space the largest
    face.

    Parameters
    ----------
    index : (n, dim)
        Lattice indices of the pieces.
    volume, centroid : (n,), (n, dim)
        Areas or volumes, and centroids.
    small, shared : (k,), (k, 2 dim)
        The pieces below ``least_volume``, and the lengths or areas of what they share with the neighbours
        below and above along x, then y, then z.

    Returns
    -------
    volume, centroid : (m,), (m, dim)
        Those of the joint pieces. A small piece without a neighbour stays as it is.
    """
    dim = index.shape[1]
    preferred = shared * (1.0 - TIE_BREAK * np.repeat(np.arange(dim), 2))
    order = np.argsort(-preferred, axis=1, kind="stable")
    beside = np.where(shared > 0.0, _neighbours(index, small), -1)[
        np.arange(len(small))[:, np.newaxis], order
    ]
    owner = np.arange(len(volume))
    joint = volume.copy()
    for k in np.argsort(volume[small], kind="stable"):
        piece = int(small[k])
        # Pieces that joined this one may have made it large enough
        if joint[piece] < least_volume:
            owner[piece] = _most_shared(piece, beside[k], owner)
            joint[owner[piece]] += joint[piece]
    roots = owner.copy()
    for piece in small.tolist():
        roots[piece] = _root(owner, piece)
    total = np.bincount(roots, weights=volume, minlength=len(volume)).astype(np.float64)
    moment = np.column_stack(
        [np.bincount(roots, weights=volume * x, minlength=len(volume)) for x in centroid.T]
    )
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


def _most_shared(piece: int, beside: npt.NDArray[np.intp], owner: npt.NDArray[np.intp]) -> int:
    """The (joint) piece that shares most with ``piece``; ``piece`` itself where there is none.

    ``beside`` has its neighbours, those with the largest face first, −1 where there is none.
    """
    for other in beside.tolist():
        if other >= 0 and (root := _root(owner, other)) != piece:
            return root
    return piece


def _root(owner: npt.NDArray[np.intp], piece: int) -> int:
    """The piece that ``piece`` belongs to after all joins so far."""
    while owner[piece] != piece:
        piece = int(owner[piece])
    return piece
