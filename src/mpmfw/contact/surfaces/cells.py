"""Facets by the cells that two bodies reach: steps 1 and 2 of the search ([H17] section 3.2)."""

from __future__ import annotations

import math

from mpmfw.contact.surfaces.candidates import SearchGrid
from mpmfw.contact.surfaces.outline import Outline
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.gaps import bounding_boxes
from mpmfw.kernels.types import Float, Floats, Ints


@device
def boxes_apart(a: int, b: int, lower: Floats, upper: Floats, reach: Float) -> bool:
    """Whether the bounding boxes of bodies a and b are farther apart than ``reach`` [m] along an axis."""
    beyond = False
    for d in range(lower.shape[1]):
        if lower[a, d] - upper[b, d] > reach or lower[b, d] - upper[a, d] > reach:
            beyond = True
    return beyond


@kernel
def near_boxes(
    first: Ints, second: Ints, reach: float, wide: float, outline: Outline, grid: SearchGrid
) -> bool:
    """Bounding boxes of all bodies, and of what of each may be within ``reach`` + ``wide`` [m] of another,
    empty for most; whether any two boxes are within ``reach``.

    Of pairs with boxes closer than both it is the part within the other's box, widened by both; of more than
    one the box round them.
    """
    near, lower, upper = False, grid.box_lower, grid.box_upper
    bounding_boxes(outline.body_first, outline.position, lower, upper)
    near_lower, near_upper = grid.near_lower, grid.near_upper
    near_lower[:] = math.inf
    near_upper[:] = -math.inf
    for c in range(len(first)):
        if boxes_apart(first[c], second[c], lower, upper, reach + wide):
            continue
        near = near or not boxes_apart(first[c], second[c], lower, upper, reach)
        for way in range(2):
            a, b = (first[c], second[c]) if way == 0 else (second[c], first[c])
            for d in range(lower.shape[1]):
                near_lower[a, d] = min(near_lower[a, d], max(lower[a, d], lower[b, d] - reach - wide))
                near_upper[a, d] = max(near_upper[a, d], min(upper[a, d], upper[b, d] + reach + wide))
    return near


@device
def reach_of_facet(
    m: int, position: Floats, facets: Ints, lower: Floats, upper: Floats, spacing: tuple[float, ...]
) -> None:
    """Bounding box of facet m, into ``lower`` and ``upper`` (dim,) [m]."""
    for d in range(len(spacing)):
        lower[d] = upper[d] = position[facets[m, 0], d]
        for a in range(1, len(spacing)):
            lower[d] = min(lower[d], position[facets[m, a], d])
            upper[d] = max(upper[d], position[facets[m, a], d])


@device
def outside_near(b: int, lower: Floats, upper: Floats, grid: SearchGrid, spacing: tuple[float, ...]) -> bool:
    """Whether the box from ``lower`` to ``upper`` has nothing in the near box of body b."""
    outside = False
    for d in range(len(spacing)):
        if upper[d] < grid.near_lower[b, d] or lower[d] > grid.near_upper[b, d]:
            outside = True
    return outside


@device
def cell_of(x: Float, d: int, grid: SearchGrid, spacing: tuple[float, ...]) -> int:
    """Index along axis d of the cell that holds x, limited to the grid."""
    cell: int = min(max(math.floor((x - grid.lower[d]) / spacing[0]), 0), grid.nodes[d] - 2)
    return cell


@device
def flat_index(index: Ints, grid: SearchGrid, spacing: tuple[float, ...]) -> int:
    """Flat index of a grid node, or of the cell whose lowest node it is."""
    flat: int = index[0]
    for d in range(1, len(spacing)):
        flat = flat * grid.nodes[d] + index[d]
    return flat


@device
def cell_beside(own: Ints, code: int, index: Ints, grid: SearchGrid, spacing: tuple[float, ...]) -> int:
    """Flat index of a cell beside the cell ``own``, −1 if it is outside of the grid; its indices into
    ``index``.

    ``code`` has a digit 0 … 2 for each axis, the last axis lowest.
    """
    inside = True
    for back in range(len(spacing)):
        d = len(spacing) - 1 - back
        index[d] = own[d] - 1 + code % 3
        code //= 3
        inside = inside and index[d] >= 0 and index[d] <= grid.nodes[d] - 2
    if not inside:
        return -1
    flat: int = flat_index(index, grid, spacing)
    return flat


@device
def cells_of(
    lower: Floats, upper: Floats, wide: Float, first: Ints, last: Ints, grid: SearchGrid,
    spacing: tuple[float, ...]
) -> None:  # fmt: skip
    """First and last cell along every axis that the box from ``lower`` to ``upper`` touches, widened by
    ``wide`` [m]."""
    for d in range(len(spacing)):
        first[d] = cell_of(lower[d] - wide, d, grid, spacing)
        last[d] = cell_of(upper[d] + wide, d, grid, spacing)


@device
def number_of(first: Ints, last: Ints, spacing: tuple[float, ...]) -> int:
    """Number of the cells or nodes from ``first`` to ``last``."""
    number = 1
    for d in range(len(spacing)):
        number *= last[d] - first[d] + 1
    return number


@device
def advance(index: Ints, first: Ints, last: Ints, spacing: tuple[float, ...]) -> None:
    """The next of the cells or nodes from ``first`` to ``last``, the last axis fastest."""
    dim = len(spacing)
    index[dim - 1] += 1
    for back in range(1, dim):
        d = dim - back
        if index[d] > last[d]:
            index[d] = first[d]
            index[d - 1] += 1


@device
def mark_shared_nodes(
    stamp: int, wide: Float, outline: Outline, grid: SearchGrid, spacing: tuple[float, ...]
) -> bool:
    """Step 1: mark the grid nodes that the surfaces of two bodies reach; return whether there are any.

    Only what lies in its body's near box counts (:func:`near_boxes`); such facets, and their bounding boxes,
    are listed. A facet reaches the nodes of all cells that its bounding box, widened by ``wide``, touches.
    ``owner`` holds stamp * n_bodies + body of the first to arrive.
    """
    any_shared, count = False, 0
    lower, upper = scratch.vector(spacing), scratch.vector(spacing)
    first, last, index = scratch.integers(spacing), scratch.integers(spacing), scratch.integers(spacing)
    base = stamp * (len(outline.body_first) - 1)
    for m in range(len(outline.facets)):
        reach_of_facet(m, outline.position, outline.facets, lower, upper, spacing)
        body = outline.body[outline.facets[m, 0]]
        if outside_near(body, lower, upper, grid, spacing):
            continue
        grid.near[count] = m
        count += 1
        for d in range(len(spacing)):
            grid.facet_lower[m, d], grid.facet_upper[m, d] = lower[d], upper[d]
        mine = base + body
        cells_of(lower, upper, wide, first, last, grid, spacing)
        for d in range(len(spacing)):
            last[d] += 1  # nodes, of which there is one more
            index[d] = first[d]
        for _ in range(number_of(first, last, spacing)):
            node = flat_index(index, grid, spacing)
            if grid.owner[node] < base:
                grid.owner[node] = mine
            elif grid.owner[node] != mine:
                grid.shared[node] = stamp
                any_shared = True
            advance(index, first, last, spacing)
    grid.near_count[0] = count
    return any_shared


@device
def tagged(cell: int, stamp: int, grid: SearchGrid, spacing: tuple[float, ...]) -> bool:
    """Whether a corner of a cell, given by its flat index, is shared."""
    shared_now = False
    for corner in range(2 ** len(spacing)):
        step, stride = 0, 1
        for back in range(len(spacing)):
            d = len(spacing) - 1 - back
            step += (corner >> back & 1) * stride
            stride *= grid.nodes[d]
        if grid.shared[cell + step] == stamp:
            shared_now = True
            break
    return shared_now


@kernel
def list_facets(
    stamp: int, wide: float, outline: Outline, grid: SearchGrid, spacing: tuple[float, ...]
) -> int:
    """Steps 1 and 2: linked lists of the near facets in every tagged cell; return the number of entries,
    stored or not.

    There are none where no two bodies share a node. Facets count as larger by ``wide`` [m] all round.
    """
    count = 0
    if not mark_shared_nodes(stamp, wide, outline, grid, spacing):
        return 0
    first, last, index = scratch.integers(spacing), scratch.integers(spacing), scratch.integers(spacing)
    for k in range(grid.near_count[0]):
        m = grid.near[k]
        body = outline.body[outline.facets[m, 0]]
        cells_of(grid.facet_lower[m], grid.facet_upper[m], wide, first, last, grid, spacing)
        for d in range(len(spacing)):
            index[d] = first[d]
        for _ in range(number_of(first, last, spacing)):
            cell = flat_index(index, grid, spacing)
            if tagged(cell, stamp, grid, spacing):
                if count < len(grid.link):
                    begun = grid.head_stamp[cell] == stamp
                    grid.link[count] = grid.head[cell] if begun else -1
                    grid.link_facet[count], grid.link_body[count] = m, body
                    grid.head_body[cell] = body if not begun or grid.head_body[cell] == body else -1
                    grid.head[cell], grid.head_stamp[cell] = count, stamp
                count += 1
            advance(index, first, last, spacing)
    return count
