"""Surface nodes of one part of a body: those near each other along the surface, or with material between."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw.kernels import Struct, device, kernel
from mpmfw.kernels.types import Ints
from mpmfw.state.fields import FloatArray, IntArray
from mpmfw.state.structs import Surface


class OnePart(Struct):
    """Which surface nodes are of one part: those of node s are ``node[first[s]:first[s + 1]]``, ascending."""

    first: Ints  #: (n_s + 1,)
    node: Ints  #: (n,)


@device
def are_joined(s: int, t: int, one_part: OnePart) -> bool:
    """Return True if surface nodes s and t are of one part."""
    low, high = one_part.first[s], one_part.first[s + 1]
    while low < high:
        middle = (low + high) // 2
        if one_part.node[middle] < t:
            low = middle + 1
        else:
            high = middle
    joined: bool = low < one_part.first[s + 1] and one_part.node[low] == t
    return joined


@kernel
def mark_apart(pairs: Ints, one_part: OnePart, apart: Any) -> None:
    """Write which ``pairs`` of surface nodes (n, 2) are of two parts."""
    for c in range(len(pairs)):
        apart[c] = not are_joined(pairs[c, 0], pairs[c, 1], one_part)


@kernel
def remove_joined(near: NearFacets, outline: Surface, one_part: OnePart, last: Ints) -> None:
    """Remove facets of a node's own body that have a node of one part with it.

    ``last`` (n_s,) is scratch: the last node that was of one part with each."""
    count, end = 0, 0
    last[:] = -1
    for s in range(len(near.first) - 1):
        begin, end = end, near.first[s + 1]
        for j in range(one_part.first[s], one_part.first[s + 1]):
            last[one_part.node[j]] = s
        for k in range(begin, end):
            m, kept = near.facet[k], True
            for a in range(outline.facets.shape[1]):
                kept = kept and last[outline.facets[m, a]] != s
            if kept:
                near.facet[count], near.away[count] = m, near.away[k]
                count += 1
        near.first[s + 1] = count


#: Surface nodes from which distances along the surface are found at a time.
CHUNK = 256


def dots(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return Σ a_d b_d of every row (n,)."""
    return np.asarray(np.einsum("nd,nd->n", a, b))


def joined_nodes(surface: Surface, own: slice, facets: IntArray, normal: FloatArray, length: float) -> Any:
    """Return which surface nodes of a body are of one part, (n_s, n_s) sparse: those within ``length`` [m]
    along the surface, and those with material between them."""
    x, n = surface.position, surface.count
    ends = np.concatenate([facets[:, [a, (a + 1) % facets.shape[1]]] for a in range(facets.shape[1])])
    edge = np.linalg.norm(x[ends[:, 0]] - x[ends[:, 1]], axis=1)
    edges = csr_array(coo_array((edge, ends.T), shape=(n, n)))
    rows, columns = [], []
    for begin in range(own.start, own.stop, CHUNK):
        part = np.arange(begin, min(begin + CHUNK, own.stop))
        a, b = np.nonzero(dijkstra(edges, directed=False, indices=part, limit=length) < np.inf)
        rows.append(part[a])
        columns.append(b)
    tree = cKDTree(x[own])
    s, t = own.start + tree.query_pairs(length, output_type="ndarray").T
    through = (dots(x[t] - x[s], normal[s]) < 0.0) & (dots(x[t] - x[s], normal[t]) > 0.0)
    for part in np.arange(1, 8) / 8:
        s, t = s[through], t[through]
        place = (1.0 - part) * x[s] + part * x[t]
        next_to = own.start + tree.query(place)[1]
        through = dots(place - x[next_to], normal[next_to]) < 0.0
    s, t = s[through], t[through]
    at = (np.concatenate([*rows, s, t]), np.concatenate([*columns, t, s]))
    return csr_array(coo_array((np.ones(len(at[0]), dtype=np.int8), at), shape=(n, n)))


def one_part_of(joined: Any) -> OnePart:
    """Return the rows of a sparse array for kernels."""
    return OnePart(first=joined.indptr.astype(np.int64), node=joined.indices.astype(np.int64))
