"""Kernels of a time step for shape functions that are products of functions of one axis, φ_i = Π_d w_d.

Three nodes along each axis touch a point. Along a line of nodes, parallel to the last axis, all other
factors are the same: sums of one line are multiplied by them once. In space that takes half the time of a
table, whose 27 entries a point are not written either. All else is as in
:mod:`mpmfw.kernels.particle_grid`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.kernels import lanes, scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels.arithmetic import add_scaled_row, add_to_rows, set_scaled_row
from mpmfw.kernels.particle_grid import set_traction
from mpmfw.kernels.stencil import NodeRange, fill_tensor_product, fits, read_window
from mpmfw.kernels.types import Floats, Ints, Nodes, Points, Table

#: Nodes along each axis.
WIDTH = 3

#: As long as there are nodes along an axis: the size of scratch arrays.
NODES = (0.0,) * WIDTH

#: What ``factors.along`` has of every node: w, its derivative w' [1/m], and w q [m] with q = x_i − x_p.
VALUE, SLOPE, MOMENT = range(3)

_ONE, _FACTORS = (0.0,), (0.0,) * 9


@device
def fill_factors(
    weigh: Any, position: Floats, first: Ints, half_length: Floats | None, grid: Nodes, factors: Table,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Fill ``factors`` at points with the functions of a device, four points at a time. Return the first
    point outside its window, or −1.

    It is called as ``weigh(xi, l, inverse_h, d, base, weight, slope)`` and sets the first node and three
    functions along axis d of points at ``xi``, of a ``half_length`` (n,) [m] of l, both in cells."""
    dim, inverse_h = len(spacing), 1.0 / spacing[0]
    origin, shape, lowest = scratch.vector(spacing), scratch.integers(spacing), scratch.vector(spacing)
    x, l, base = lanes.matrix(_ONE, spacing), lanes.matrix(_ONE, _ONE), lanes.matrix(_ONE, spacing)
    weight, slope = lanes.matrix(spacing, NODES), lanes.matrix(spacing, NODES)
    along = lanes.matrix(_FACTORS, NODES)
    for f in range(len(first) - 1):
        read_window(grid, f, origin, shape, spacing)
        for p in range(first[f], first[f + 1], lanes.WIDTH):
            own = lanes.points_from(p, first[f + 1])
            lanes.read(position, own, x, spacing)
            if half_length is not None:
                lanes.read(half_length, own, l, spacing)
            for d in range(dim):
                xi = (x[0, d] - origin[d]) * inverse_h
                weigh(xi, l[0, 0] * inverse_h, inverse_h, d, base[0], weight, slope)
                to_base = base[0, d] * spacing[0] + origin[d] - x[0, d]
                for a in range(WIDTH):
                    along[3 * d + VALUE, a], along[3 * d + SLOPE, a] = weight[d, a], slope[d, a]
                    along[3 * d + MOMENT, a] = weight[d, a] * (to_base + a * spacing[d])
            lanes.write(factors.along, own, along, (spacing, NODES, NODES))
            for lane in range(min(lanes.WIDTH, first[f + 1] - p)):
                node = 0
                for d in range(dim):
                    lowest[d] = lanes.component(base, 0, d, lane)
                    node = node * shape[d] + int(lowest[d])
                    factors.shape[p + lane, d] = shape[d]
                if not fits(lowest, WIDTH, shape, spacing):
                    return p + lane
                factors.node[p + lane] = node + grid.offset[f]
    return -1


@kernel
def fill_products(factors: Table, table: Table, spacing: tuple[float, ...]) -> None:
    """Write the products to a table of 3**dim entries a point."""
    base, shape = scratch.vector(spacing), scratch.integers(spacing)
    weight, slope = scratch.matrix(spacing, NODES), scratch.matrix(spacing, NODES)
    for p in range(len(factors.node)):
        for d in range(len(spacing)):
            base[d], shape[d] = 0.0, factors.shape[p, d]
            for a in range(WIDTH):
                weight[d, a] = factors.along[p, d, VALUE, a]
                slope[d, a] = factors.along[p, d, SLOPE, a]
        k = p * WIDTH ** len(spacing)
        fill_tensor_product(k, WIDTH, base, weight, slope, shape, factors.node[p], table, spacing)


@device
def _line(
    factors: Table, p: int, a: int, b: int, slope: Floats, moment: Floats, spacing: tuple[float, ...]
) -> np.uint64:
    """Return the first node of a line, a-th along x and in space b-th along y, and set what its nodes share.

    With the axes e that are not the last, ``slope[0, d]`` is w'_d Π_{e≠d} w_e and ``moment[0, d]`` is (w q)_d
    Π_{e≠d} w_e; in the place of the last axis both are Π_e w_e."""
    along = factors.along
    if len(spacing) == 2:
        slope[0, 0], moment[0, 0] = along[p, 0, SLOPE, a], along[p, 0, MOMENT, a]
        slope[0, 1] = moment[0, 1] = along[p, 0, VALUE, a]
        return np.uint64(factors.node[p] + a * factors.shape[p, 1])
    w_a, w_b = along[p, 0, VALUE, a], along[p, 1, VALUE, b]
    slope[0, 0], moment[0, 0] = along[p, 0, SLOPE, a] * w_b, along[p, 0, MOMENT, a] * w_b
    slope[0, 1], moment[0, 1] = w_a * along[p, 1, SLOPE, b], w_a * along[p, 1, MOMENT, b]
    slope[0, 2] = moment[0, 2] = w_a * w_b
    return np.uint64(factors.node[p] + (a * factors.shape[p, 1] + b) * factors.shape[p, 2])


@device
def _set_last_axis(factors: Table, p: int, last: int, out: Floats) -> None:
    """out = the factors along the last axis; in registers, as no kernel writes to them."""
    for kind in range(3):
        for c in range(WIDTH):
            out[kind, c] = factors.along[p, last, kind, c]


@device
def _last_node(factors: Table, p: int, spacing: tuple[float, ...]) -> int:
    """Return the last node of point ``p``; ``factors.node`` is its first."""
    last = factors.node[p] + WIDTH - 1
    for d in range(1, len(spacing)):
        rows = WIDTH - 1
        for e in range(d, len(spacing)):
            rows *= factors.shape[p, e]
        last += rows
    return int(last)


@device
def _add_to_line(
    out: Floats, i: np.uint64, along: Floats, kind: int, row: Floats, own_nodes: NodeRange | None,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """out[i + c, :] += along[kind, c] row[0, :] of the nodes of a line that are among ``own_nodes``."""
    if own_nodes is None:
        add_to_rows(out, i, along, kind, row, 0, spacing, NODES)
    else:
        for c in range(WIDTH):
            k = i + np.uint64(c)
            if own_nodes[0] <= k < own_nodes[1]:
                add_scaled_row(out, k, along[kind, c], row, 0, spacing)


@device
def _project(
    points: Points, affine: Floats | None, thickness: Floats | None, factors: Table, grid: Nodes,
    mass: Floats | None, force: Floats | None, spacing: tuple[float, ...], own_nodes: NodeRange | None,
) -> None:  # fmt: skip
    """Add to momentum, ``mass`` and ``force`` of the nodes. Most points have all or none of their nodes among
    ``own_nodes``."""
    for p in range(len(points.mass)):
        if own_nodes is None:
            _add_point(p, points, affine, thickness, factors, grid, mass, force, spacing, None)
        else:
            begin, end = factors.node[p], _last_node(factors, p, spacing) + 1
            if own_nodes[0] <= begin and end <= own_nodes[1]:
                _add_point(p, points, affine, thickness, factors, grid, mass, force, spacing, None)
            elif own_nodes[0] < end and begin < own_nodes[1]:
                _add_point(p, points, affine, thickness, factors, grid, mass, force, spacing, own_nodes)


@device
def _add_point(
    p: int, points: Points, affine: Floats | None, thickness: Floats | None, factors: Table, grid: Nodes,
    mass: Floats | None, force: Floats | None, spacing: tuple[float, ...], own_nodes: NodeRange | None,
) -> None:  # fmt: skip
    """Add what point ``p`` gives, line by line.

    With w, w' and w q of the last axis alone, and W = Π w of the other axes e: m_i += w W m, (m v)_i += w m
    (W v + Σ_e (w q)_e … C_e) + (w q) m W C_last, f_i −= w V Σ_e w'_e … σ_e + w' V W σ_last."""
    last, in_plane = len(spacing) - 1, len(spacing) == 2
    slope, moment = scratch.matrix(_ONE, spacing), scratch.matrix(_ONE, spacing)
    velocity, columns = scratch.matrix(_ONE, spacing), scratch.matrix(spacing, spacing)
    traction, along = scratch.matrix(spacing, spacing), scratch.matrix(NODES, NODES)
    value, change = scratch.matrix(_ONE, spacing), scratch.matrix(_ONE, spacing)
    across, down = scratch.matrix(_ONE, spacing), scratch.matrix(_ONE, spacing)
    m = points.mass[p]
    set_scaled_row(velocity, 0, m, points.velocity, p, spacing)
    if affine is not None:
        for d in range(len(spacing)):
            for e in range(len(spacing)):
                columns[e, d] = m * affine[p, d, e]
    if force is not None:
        set_traction(points, thickness, p, traction, spacing)
    _set_last_axis(factors, p, last, along)
    for a in range(WIDTH):
        for b in range(1 if in_plane else WIDTH):
            i = _line(factors, p, a, b, slope, moment, spacing)
            if not in_plane and slope[0, last] == 0.0:
                continue  # the domain does not reach the line; in the plane the branch costs more
            share = slope[0, last]
            set_scaled_row(value, 0, share, velocity, 0, spacing)
            if affine is not None:
                for d in range(last):
                    add_scaled_row(value, 0, moment[0, d], columns, d, spacing)
                set_scaled_row(change, 0, share, columns, last, spacing)
            if force is not None:
                set_scaled_row(across, 0, slope[0, 0], traction, 0, spacing)
                for d in range(1, last):
                    add_scaled_row(across, 0, slope[0, d], traction, d, spacing)
                set_scaled_row(down, 0, share, traction, last, spacing)
            _add_to_line(grid.momentum, i, along, VALUE, value, own_nodes, spacing)
            if affine is not None:
                _add_to_line(grid.momentum, i, along, MOMENT, change, own_nodes, spacing)
            if force is not None:
                _add_to_line(force, i, along, VALUE, across, own_nodes, spacing)
                _add_to_line(force, i, along, SLOPE, down, own_nodes, spacing)
            if mass is not None:
                for c in range(WIDTH):
                    k = i + np.uint64(c)
                    if own_nodes is None or own_nodes[0] <= k < own_nodes[1]:
                        mass[k] += along[VALUE, c] * (share * m)


@kernel
def project(
    points: Points, position: Floats, affine: Floats | None, factors: Table, grid: Nodes,  # noqa: ARG001
    mass: Floats | None, spacing: tuple[float, ...], own_nodes: NodeRange | None = None,
) -> None:  # fmt: skip
    """As :func:`mpmfw.kernels.particle_grid.project`."""
    _project(points, affine, None, factors, grid, mass, None, spacing, own_nodes)


@kernel
def project_with_force(
    points: Points, affine: Floats | None, thickness: Floats | None, factors: Table, grid: Nodes,
    spacing: tuple[float, ...], own_nodes: NodeRange | None = None,
) -> None:  # fmt: skip
    """As :func:`mpmfw.kernels.particle_grid.project_with_force`."""
    _project(points, affine, thickness, factors, grid, grid.mass, grid.force, spacing, own_nodes)


@kernel
def gather(
    points: Points, affine: Floats | None, rate: Floats | None, factors: Table, grid: Nodes,
    inverse_spread: float, flip: float, dt: float, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """As :func:`mpmfw.kernels.particle_grid.gather`.

    Of a line of nodes, along the last axis, come Σ w v, Σ w' v, Σ w q v and Σ w v⁰. As Σ w q = 0, D is
    diagonal, D_dd = Σ w q² = h Σ_a a (w q)_a with the nodes a = 0, 1, 2."""
    last, in_plane = len(spacing) - 1, len(spacing) == 2
    slope, moment = scratch.matrix(_ONE, spacing), scratch.matrix(_ONE, spacing)
    along = scratch.matrix(NODES, NODES)
    mean, mean_start = scratch.matrix(_ONE, spacing), scratch.matrix(_ONE, spacing)
    change, first_moment = scratch.matrix(_ONE, spacing), scratch.matrix(_ONE, spacing)
    new, start = scratch.matrix(_ONE, spacing), scratch.matrix(_ONE, spacing)
    gradient, columns = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)  # L_pᵀ, B_pᵀ
    for p in range(len(points.mass)):
        for d in range(len(spacing)):
            new[0, d] = start[0, d] = 0.0
            for e in range(len(spacing)):
                gradient[d, e] = columns[d, e] = 0.0
        _set_last_axis(factors, p, last, along)
        for a in range(WIDTH):
            for b in range(1 if in_plane else WIDTH):
                i = _line(factors, p, a, b, slope, moment, spacing)
                if not in_plane and slope[0, last] == 0.0:
                    continue  # the domain does not reach the line; in the plane the branch costs more
                for d in range(len(spacing)):
                    mean[0, d] = mean_start[0, d] = change[0, d] = first_moment[0, d] = 0.0
                for c in range(WIDTH):
                    k = i + np.uint64(c)
                    add_scaled_row(mean, 0, along[VALUE, c], grid.velocity, k, spacing)
                    add_scaled_row(mean_start, 0, along[VALUE, c], grid.start_velocity, k, spacing)
                    add_scaled_row(change, 0, along[SLOPE, c], grid.velocity, k, spacing)
                    if affine is not None:
                        add_scaled_row(first_moment, 0, along[MOMENT, c], grid.velocity, k, spacing)
                add_scaled_row(new, 0, slope[0, last], mean, 0, spacing)
                add_scaled_row(start, 0, slope[0, last], mean_start, 0, spacing)
                add_scaled_row(gradient, last, slope[0, last], change, 0, spacing)
                for d in range(last):
                    add_scaled_row(gradient, d, slope[0, d], mean, 0, spacing)
                    if affine is not None:
                        add_scaled_row(columns, d, moment[0, d], mean, 0, spacing)
                if affine is not None:
                    add_scaled_row(columns, last, slope[0, last], first_moment, 0, spacing)
        add_scaled_row(points.position, p, dt, new, 0, spacing)
        for d in range(len(spacing)):
            kept = points.velocity[p, d] + new[0, d] - start[0, d]
            points.velocity[p, d] = flip * kept + (1.0 - flip) * new[0, d]
            if rate is not None:
                for e in range(len(spacing)):
                    rate[p, d, e] = gradient[e, d]
        if affine is not None:
            for e in range(len(spacing)):
                moments = factors.along[p, e, MOMENT]
                inverse = inverse_spread or 1.0 / (spacing[e] * (moments[1] + 2.0 * moments[2]))
                for d in range(len(spacing)):
                    affine[p, d, e] = inverse * columns[e, d]
