"""Kernels of detection at grid nodes: which nodes two bodies share, and the rows there."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.kernels import Struct, add_scaled_row, device, kernel, scratch
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.types import Flags, Float, Floats, Ints, Points, Table

#: Largest distance of the mean positions of flush bodies at a node [cells]; it is 1.4 across a gap of a cell.
FLUSH = 1.3


class NodePairs(Struct):
    """Bodies of every pair, and weights of their volume gradients; of 0 and 0 the larger counts."""

    first: Ints  #: (pair,)
    second: Ints  #: (pair,)
    weight_first: Floats  #: (pair,)
    weight_second: Floats  #: (pair,)


class GridNodes(Struct):
    """The bodies' windows of the grid, and what was projected on their nodes."""

    window_lower: Ints  #: (n_bodies, dim) background index of the window's first node
    window_shape: Ints  #: (n_bodies, dim)
    offset: Ints  #: (n_bodies + 1,)
    nodes: Ints  #: (dim,) number of nodes of the background grid
    mass: Floats  #: (n_nodes,) [kg/m]
    start_velocity: Floats  #: (n_nodes, dim) [m/s]
    shared: Flags  #: (n_nodes,) whether two bodies have mass there
    #: (n_nodes,) last row of a node, 2 f where it is first and 2 f + 1 second, or −1; (0,) of two bodies
    last_row: Ints
    gradient: Floats  #: (n_nodes, dim) Σ V ∇φ at shared nodes; (0, dim) where it is not asked for
    #: (n_nodes, dim) mean position of the points [m] at shared nodes; (0, dim) where it is not asked for
    mean: Floats


class SharedNodes(Struct):
    """Nodes where both bodies of a pair have mass."""

    pair: Ints  #: (n,)
    first: Ints  #: (n,) flat node of the first body's window
    second: Ints  #: (n,) that of the second body's
    row_before: Ints  #: (2 n,) row of the same node before, as in ``GridNodes.last_row``
    side: Ints  #: (2 n,) nodes of both sides of one row


def room_for(rows: int) -> SharedNodes:
    """Return room for so many rows."""
    sizes = {"pair": rows, "first": rows, "second": rows, "row_before": 2 * rows, "side": 2 * rows}
    return SharedNodes(**{name: np.zeros(size, dtype=np.int64) for name, size in sizes.items()})


@kernel
def find_shared_nodes(pairs: NodePairs, grid: GridNodes, shared: SharedNodes) -> int:
    """List the nodes where both bodies of a pair have mass; return their number, stored or not."""
    lower, shape, offset = grid.window_lower, grid.window_shape, grid.offset
    dim = lower.shape[1]
    count = 0
    for p in range(len(pairs.first)):
        a, b = pairs.first[p], pairs.second[p]
        total = 1
        for d in range(dim):
            low = max(lower[a, d], lower[b, d])
            high = min(lower[a, d] + shape[a, d], lower[b, d] + shape[b, d])
            total *= max(high - low, 0)
        for flat in range(total):
            rest = flat
            i, j, stride_a, stride_b = 0, 0, 1, 1
            for reverse in range(dim):
                d = dim - 1 - reverse
                low = max(lower[a, d], lower[b, d])
                high = min(lower[a, d] + shape[a, d], lower[b, d] + shape[b, d])
                index = low + rest % (high - low)
                rest //= high - low
                i += (index - lower[a, d]) * stride_a
                j += (index - lower[b, d]) * stride_b
                stride_a *= shape[a, d]
                stride_b *= shape[b, d]
            i, j = offset[a] + i, offset[b] + j
            if grid.mass[i] > 0.0 and grid.mass[j] > 0.0:
                if count < len(shared.pair):
                    shared.pair[count], shared.first[count], shared.second[count] = p, i, j
                count += 1
    return count


@kernel
def mark_nodes(count: int, shared: SharedNodes, grid: GridNodes) -> bool:
    """Mark the first ``count`` listed nodes, on which alone things are projected, and link the rows of each;
    return whether three bodies share one."""
    three = False
    grid.shared[:] = False
    grid.last_row[:] = -1
    for f in range(count):
        for second in range(2):
            i = shared.second[f] if second else shared.first[f]
            grid.shared[i] = True
            if len(grid.last_row) > 0:
                three = three or grid.last_row[i] >= 0
                shared.row_before[2 * f + second], grid.last_row[i] = grid.last_row[i], 2 * f + second
    return three


@device
def moves_with(third: int, i: int, j: int, grid: GridNodes) -> bool:
    """Return True if a third body's slip from node i is below half of that from node j."""
    from_i, from_j = 0.0, 0.0
    for d in range(grid.start_velocity.shape[1]):
        from_i += (grid.start_velocity[third, d] - grid.start_velocity[i, d]) ** 2
        from_j += (grid.start_velocity[third, d] - grid.start_velocity[j, d]) ** 2
    return 4.0 * from_i < from_j


@device
def are_flush(i: int, k: int, j: int, grid: GridNodes, spacing: tuple[float, ...]) -> bool:
    """Return True if the mean positions of i and k are near each other, and j sees both on one side."""
    along, square = 0.0, 0.0
    for d in range(len(spacing)):
        along += (grid.mean[i, d] - grid.mean[j, d]) * (grid.mean[k, d] - grid.mean[j, d])
        square += (grid.mean[i, d] - grid.mean[k, d]) ** 2
    return along > 0.0 and square < (FLUSH * spacing[0]) ** 2


@device
def collect_sides(
    f: int, shared: SharedNodes, grid: GridNodes, spacing: tuple[float, ...]
) -> tuple[int, int]:
    """List the nodes of row f's first side, then of its second, in ``shared.side``; return the number of the
    first and of all.

    A third body with mass there is on the side with which it moves, if the two are flush: they are one to a
    body that slides over them.
    """
    count, of_first = 0, 0
    for second in range(2):
        i, j = (shared.second[f], shared.first[f]) if second else (shared.first[f], shared.second[f])
        shared.side[count] = i
        count += 1
        row = grid.last_row[i] if len(grid.last_row) > 0 else -1
        while row >= 0:
            third = shared.first[row // 2] if row % 2 else shared.second[row // 2]
            if third != j and moves_with(third, i, j, grid) and are_flush(i, third, j, grid, spacing):
                shared.side[count] = third
                count += 1
            row = shared.row_before[row]
        if second == 0:
            of_first = count
    return of_first, count


@device
def all_entries(row: Ints) -> range:
    """Entries of all points: unsigned, as those of :func:`mpmfw.kernels.entries`."""
    return range(np.uint64(row[0]), np.uint64(row[-1]))


@device
def point_of(row: Ints, k: int, p: int) -> int:
    """The point whose entry is k, which is p or one after it."""
    while np.uint64(row[p + 1]) <= k:
        p += 1
    return p


@kernel
def project_volume_gradient(
    table: Table, points: Points, grid: GridNodes, spacing: tuple[float, ...]
) -> None:
    """Σ_p V_p ∇φ_ip at shared nodes, out of the body."""
    grid.gradient[:] = 0.0
    p = 0
    for k in all_entries(table.row):
        i = table.nodes[k]
        if grid.shared[i]:
            p = point_of(table.row, k, p)
            add_scaled_row(grid.gradient, i, points.volume[p], table.gradient, k, spacing)


@kernel
def project_position(table: Table, points: Points, grid: GridNodes, spacing: tuple[float, ...]) -> None:
    """Σ_p φ_ip m_p x_p / m_i at shared nodes; 0 at others."""
    dim = len(spacing)
    grid.mean[:] = 0.0
    p = 0
    for k in all_entries(table.row):
        i = table.nodes[k]
        if grid.shared[i]:
            p = point_of(table.row, k, p)
            add_scaled_row(grid.mean, i, table.weight[k] * points.mass[p], points.position, p, spacing)
    for i in range(len(grid.mass)):
        if grid.shared[i]:
            for d in range(dim):
                grid.mean[i, d] /= grid.mass[i]


@device
def background_index(i: int, body: int, grid: GridNodes) -> int:
    """Index of a node of a body's window in the background grid."""
    dim = grid.window_lower.shape[1]
    index, rest, stride = 0, i - grid.offset[body], 1
    for reverse in range(dim):
        d = dim - 1 - reverse
        index += (grid.window_lower[body, d] + rest % grid.window_shape[body, d]) * stride
        rest //= grid.window_shape[body, d]
        stride *= grid.nodes[d]
    return index


@device
def sum_gradients(
    f: int, shared: SharedNodes, grid: GridNodes, gradient: Floats, spacing: tuple[float, ...]
) -> None:
    """Σ g over the nodes of each side of row f, (2, dim)."""
    of_first, count = collect_sides(f, shared, grid, spacing)
    gradient[:] = 0.0
    for k in range(count):
        for d in range(gradient.shape[1]):
            gradient[0 if k < of_first else 1, d] += grid.gradient[shared.side[k], d]


@device
def direction_out(
    f: int, shared: SharedNodes, pairs: NodePairs, grid: GridNodes, given: Floats, out: Floats,
    spacing: tuple[float, ...],
) -> bool:  # fmt: skip
    """n ∝ w_b g_b − w_a g_a of the sides' volume gradients, or the given one; False without one."""
    p, square, gradient = shared.pair[f], 0.0, scratch.matrix((0, 0), spacing)
    of_first, of_second = pairs.weight_first[p], pairs.weight_second[p]
    if len(grid.gradient) > 0:
        sum_gradients(f, shared, grid, gradient, spacing)
        if of_first + of_second == 0.0:
            for d in range(len(given)):
                square += gradient[0, d] ** 2 - gradient[1, d] ** 2
            of_first, of_second = 1.0 if square >= 0.0 else 0.0, 1.0 if square <= 0.0 else 0.0
            square = 0.0
    for d in range(len(given)):
        out[d] = -given[d]
        if len(grid.gradient) > 0:
            out[d] = of_second * gradient[1, d] - of_first * gradient[0, d]
        square += out[d] * out[d]
    length = math.sqrt(square)
    for d in range(len(given)):
        out[d] = out[d] / length if length > 0.0 else 0.0
    return length > 0.0


@device
def area_across(i: int, j: int, normal: Floats, grid: GridNodes) -> Float:
    """Area of both bodies across the ``normal``, S_i = Σ V ∇φ = ∮ φ n dS [m^(dim−1)]."""
    of_first, of_second = 0.0, 0.0
    if len(grid.gradient) > 0:
        for d in range(len(normal)):
            of_first -= grid.gradient[i, d] * normal[d]
            of_second += grid.gradient[j, d] * normal[d]
    return max(min(of_first, of_second), 0.0)


@device
def write_row(
    c: int, i: int, j: int, p: int, gap: Float, normal: Floats, pairs: NodePairs, grid: GridNodes, dt: float,
    rows: Rows, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Write row c: node i of the first body against node j of the second, pair p."""
    dim, size = len(spacing), 1
    for d in range(dim):
        size *= grid.nodes[d]
    rows.pair[c], rows.sign[c] = p, 1.0
    rows.identity[c] = p * size + background_index(i, pairs.first[p], grid)
    rows.gap[c] = gap
    rows.area[c], rows.tributary_area[c] = area_across(i, j, normal, grid), spacing[0] ** (dim - 1)
    for d in range(dim):
        rows.normal[c, d] = normal[d]
        rows.motion[c, d] = dt * (grid.start_velocity[i, d] - grid.start_velocity[j, d])
    rows.start[c] = 2 * c
    rows.dof[2 * c], rows.weight[2 * c] = i, 1.0
    rows.dof[2 * c + 1], rows.weight[2 * c + 1] = j, -1.0


@kernel
def write_rows(
    listed: int, shared: SharedNodes, pairs: NodePairs, grid: GridNodes, given: Floats, cut_off: float,
    least_mass: float, dt: float, rows: Rows, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """A row for each shared node with a normal where the bodies are near; their number. The gap is that of
    mean positions less the cut-off."""
    dim = len(spacing)
    n = scratch.vector(spacing)
    c = 0
    for f in range(listed):
        i, j, p = shared.first[f], shared.second[f], shared.pair[f]
        if least_mass > 0.0 and min(grid.mass[i], grid.mass[j]) < least_mass:
            continue
        if not direction_out(f, shared, pairs, grid, given, n, spacing):
            continue
        separation = 0.0
        for d in range(dim):
            if cut_off < math.inf:
                separation += (grid.mean[i, d] - grid.mean[j, d]) * n[d]
        if separation >= cut_off:
            continue
        gap = separation - cut_off if cut_off < math.inf else 0.0
        write_row(c, i, j, p, gap, n, pairs, grid, dt, rows, spacing)
        c += 1
    rows.start[c] = 2 * c
    return c
