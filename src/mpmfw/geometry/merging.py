"""Small clipped pieces join a neighbour."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from mpmfw.geometry.layout import FloatArray

NEIGHBOURS = ((-1, 0), (1, 0), (0, -1), (0, 1))
# Of two equal edges the x-neighbour wins on every side alike: round-off cannot break a mirror symmetry
TIE_BREAK = np.array([1.0, 1.0, 1.0 - 1e-9, 1.0 - 1e-9])


def merge_small_pieces(
    index: npt.NDArray[np.intp],
    area: FloatArray,
    centroid: FloatArray,
    small: npt.NDArray[np.intp],
    shared: FloatArray,
    least_area: float,
) -> tuple[FloatArray, FloatArray]:
    """Join each small piece to the neighbour with which it shares the longest edge.

    Parameters
    ----------
    index : (n, 2)
        Lattice indices of the pieces.
    area, centroid : (n,), (n, 2)
        Areas [m^2] and centroids [m].
    small, shared : (k,), (k, 4)
        The pieces below ``least_area`` [m^2], and the lengths [m] of the edges that they share with the
        neighbours in the order of ``NEIGHBOURS``.

    Returns
    -------
    area, centroid : (m,), (m, 2)
        Those of the joint pieces. A small piece without a neighbour stays as it is.
    """
    owner = np.arange(len(area))
    joint = area.copy()
    number = {(int(i), int(j)): p for p, (i, j) in enumerate(index)}
    for k in np.argsort(area[small], kind="stable"):
        piece = int(small[k])
        # Pieces that joined this one may have made it large enough
        if joint[piece] < least_area:
            owner[piece] = _longest_shared(piece, index, shared[k] * TIE_BREAK, number, owner)
            joint[owner[piece]] += joint[piece]
    roots = np.array([_root(owner, p) for p in range(len(area))])
    total = np.bincount(roots, weights=area, minlength=len(area)).astype(np.float64)
    moment = np.column_stack([np.bincount(roots, weights=area * x, minlength=len(area)) for x in centroid.T])
    kept = np.flatnonzero(owner == np.arange(len(area)))
    return total[kept], moment[kept] / total[kept, np.newaxis]


def _longest_shared(
    piece: int,
    index: npt.NDArray[np.intp],
    shared: FloatArray,
    number: dict[tuple[int, int], int],
    owner: npt.NDArray[np.intp],
) -> int:
    """The (joint) piece that shares the longest edge with ``piece``; ``piece`` itself where there is none."""
    for side in np.argsort(-shared, kind="stable"):
        i, j = index[piece] + NEIGHBOURS[side]
        neighbour = number.get((int(i), int(j)))
        if shared[side] > 0 and neighbour is not None and _root(owner, neighbour) != piece:
            return _root(owner, neighbour)
    return piece


def _root(owner: npt.NDArray[np.intp], piece: int) -> int:
    """The piece that ``piece`` belongs to after all joins so far."""
    while owner[piece] != piece:
        piece = int(owner[piece])
    return piece
