"""Reading an interpolation table."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from mpmfw.kernels._jit import device
from mpmfw.kernels.types import Indices, Ints

#: First node of a part of the nodes, and the one after its last.
NodeRange: TypeAlias = tuple[int, int]


@device
def entries(row: Ints, p: int) -> range:
    """Entries of point ``p``: unsigned, so that no index of the loop is asked whether it counts from the
    end."""
    return range(np.uint64(row[p]), np.uint64(row[p + 1]))


@device
def is_apart(row: Ints, nodes: Indices, p: int, own_nodes: NodeRange) -> bool:
    """Whether no node of point ``p`` is among ``own_nodes``; the nodes of a row ascend."""
    begin, end = np.uint64(row[p]), np.uint64(row[p + 1])
    return bool(begin == end or nodes[end - np.uint64(1)] < own_nodes[0] or nodes[begin] >= own_nodes[1])


@device
def own_entries(row: Ints, nodes: Indices, p: int, own_nodes: NodeRange | None) -> range:
    """Entries of point ``p`` whose nodes are among ``own_nodes``, all of them without one; the nodes of a row
    ascend.
    """
    one, begin, end = np.uint64(1), np.uint64(row[p]), np.uint64(row[p + 1])
    if own_nodes is not None:
        while begin < end and nodes[begin] < own_nodes[0]:
            begin += one
        while begin < end and nodes[end - one] >= own_nodes[1]:
            end -= one
    return range(begin, end)
