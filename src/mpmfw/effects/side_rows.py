"""Conditions on the grid for a plane side that lies anywhere within its cells.

A column is a line of nodes along the axis to which the side's normal is nearest. Where it crosses the side,
the velocity of the body is Σ c_k v_k, with the weights c_k of the boundary basis, and that is one condition,
a row of A v = V. Rows of a second kind, v_k − 2 v_{k'} + v_{k''} = 0 with k' and k'' the two nodes next
inwards, hold what has no motion of its own: the last node where next to nothing of the body reaches it, and
beside an oblique side, which several nodes of a column reach, all of these.
:func:`mpmfw.effects.side_impulses.meet` brings the momentum to the rows."""

from __future__ import annotations

import numpy as np

from mpmfw.kernels import Struct, device, kernel
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw.state.fields import FloatArray

#: Share of c² m, m the mass of a full cell, below which a node counts as empty: under a straight side it has
#: c² m / 2.
LIGHT = 0.05

#: Weight below which a node outside of the side counts as empty as well: the little of the body that lies
#: there is of the size of its domains' own errors, and on a node of its own it would run away.
THIN = 0.05

#: Points of quadrature in a cell along an oblique side.
QUADRATURE = 16

#: Values in a cell of the tabulated weights of an oblique side.
TABULATED = 64


class PlaneSides(Struct):
    """The sides n·x = place, and the columns that cross them."""

    history = ("place",)

    normal: Floats  #: n, (n_sides, dim), outwards
    place: Floats  #: (n_sides,) [m]
    box_lower: Floats  #: columns outside of the box are another body's, (n_sides, dim) [m]
    box_upper: Floats
    alone: Ints  #: 1 where no other body shares the velocity field, else 0, (n_sides,)
    cell_mass: Floats  #: of a node within the body, (n_sides,) [kg/m]
    reach: Floats  #: distance along a column within which a side's weights are not 0, (n_sides,) [cells]
    tabulated: Ints  #: those of side s are ``weight[tabulated[s]:tabulated[s + 1]]``, (n_sides + 1,)
    weight: Floats  #: :func:`tabulate`
    #: first node of the velocity field and the one after its last, step along a column, its nodes, its axis
    column: Ints
    lower: Floats  #: the grid's first node (dim,) [m]
    grids: Ints  #: 1, or 2 where nodes of all even and of all odd indices are two grids, (1,)


#: Where in ``column`` (n_sides, 5) each stands.
START, STOP, STRIDE, COUNT, AXIS = range(5)


class SideTable(Struct):
    """Rows of all sides; V is ``target[r]`` times the side's velocity."""

    row: Ints  #: (n_rows + 1,)
    nodes: Ints  #: (n_entries,)
    weights: Floats  #: A_rk, (n_entries,)
    target: Floats  #: (n_rows,)
    side: Ints  #: of each row, (n_rows,)
    first: Ints  #: first row of each row's column, (n_rows,)
    factor: Floats  #: L of the rows of a column, (n_rows, most rows of a column): :func:`factor_column`
    missing: Floats  #: V − A v along the directions, (n_rows, dim) [m/s]
    divided: Floats  #: it, over A M⁻¹ Aᵀ of the columns [N s/m]
    answer: Floats  #: change of A v by these impulses
    search: Floats  #: impulses of a pass, their
    change: Floats  #: change of A v, and this over A M⁻¹ Aᵀ of the columns,
    step: Floats  #: all (n_rows, dim)
    push: Floats  #: change of the momentum by these impulses, (n_nodes, dim)
    c: Floats  #: weights of a column, as many as the longest has nodes
    distance: Floats  #: of its nodes from the side, outwards [cells]
    #: of each side on its body along its ``directions`` since it was set, (n_sides, dim) [N s/m]
    impulse: Floats
    applied: Floats  #: likewise of each row, (n_rows, dim); (0, dim) where no moment is asked for


@device
def cardinal_spline(x: Float, degree: int) -> Float:
    """B-spline β of degree p, Σ_j (−1)^j C(p+1, j) ((p+1)/2 − |x| − j)₊^p / p!, x cells from its node."""
    near = 0.5 * (degree + 1) - abs(x)
    total = 0.0
    factor = 1.0  # (−1)^j C(p + 1, j) / p!
    for j in range(1, degree + 1):
        factor /= j
    for j in range(degree + 1):
        if near > j:
            total += factor * (near - j) ** degree
        factor *= -(degree + 1.0 - j) / (j + 1.0)
    return total


@device
def compact_kernel(x: Float) -> Float:
    """1 − |x| + sin(2π|x|) / (2π) at x cells from its node, 0 beyond one cell."""
    r = min(abs(x), 1.0)
    return 1.0 - r + np.sin(2.0 * np.pi * r) / (2.0 * np.pi)


@device
def first_of_grid(
    first: int, axis: int, lower: Floats, node_position: Floats, spacing: tuple[float, ...]
) -> int:
    """0 or 1, the first node of a column whose indices are all even or all odd; −1 where there is none."""
    begin, parity = 0, -1
    for d in range(len(spacing)):
        odd = round((node_position[first, d] - lower[d]) / spacing[d]) % 2
        if d == axis:
            begin = odd
        elif parity < 0:
            parity = odd
        elif parity != odd:
            return -1
    return (begin + parity) % 2


@device
def basis_at(x: Float, degree: int, grids: int) -> Float:
    """Boundary basis of a node that is x cells away, on one grid or on two."""
    return cardinal_spline(x, degree) if grids == 1 else compact_kernel(x)


@kernel
def basis_at_places(x: Floats, degree: int, grids: int, value: Floats) -> None:
    """:func:`basis_at` at many places."""
    for q in range(len(x)):
        value[q] = basis_at(x[q], degree, grids)


def tabulate(normal: FloatArray, axis: int, degree: int, grids: int) -> tuple[float, FloatArray]:
    """Return the reach of a side's weights along a column [cells], and a table of their values within it.

    c(x) = Σ_q w_q β(x − s_q), x cells from the place where the column crosses the side. The points s_q lie on
    the side round that place. Their w_q ∝ Π β(ξ_d) have the sum 1, with β the boundary basis of this
    ``degree`` and ξ the distances across. With them Σ c_k = 1 and Σ c_k d_k = 0, also where values of the
    table are interpolated linearly: a linear velocity is read exactly. A side along the grid has one point,
    and no table."""
    half, slopes = 0.5 * (degree + 1), np.delete(normal, axis) / abs(normal[axis])
    slopes = slopes[np.abs(slopes) > 1e-12]
    if len(slopes) == 0:
        return half, np.zeros(0)
    across = (np.arange(int(QUADRATURE * 2 * half)) + 0.5) / QUADRATURE - half
    value = np.empty_like(across)
    basis_at_places(across, degree, 1, value)
    value = 0.5 * (value + value[::-1]) / value.sum()
    shift, share = np.zeros(1), np.ones(1)
    for slope in slopes:
        shift = np.add.outer(shift, slope * across).ravel()
        share = np.multiply.outer(share, value).ravel()
    steps = int(np.ceil((half + np.abs(shift).max()) * TABULATED))
    x = np.arange(-steps, steps + 1) / TABULATED
    away = np.subtract.outer(x, shift)
    value = np.empty(away.size)
    basis_at_places(away.ravel(), degree, grids, value)
    return steps / TABULATED, value.reshape(away.shape) @ share


@device
def weight_at(x: Float, s: int, degree: int, sides: PlaneSides) -> Float:
    """c of side s at x cells from it along a column."""
    begin, count = sides.tabulated[s], sides.tabulated[s + 1] - sides.tabulated[s]
    if count == 0:
        return basis_at(x, degree, sides.grids[0])
    place = x * TABULATED + 0.5 * (count - 1)
    j = min(max(int(place), 0), count - 2)
    return sides.weight[begin + j] + (place - j) * (sides.weight[begin + j + 1] - sides.weight[begin + j])


@device
def weigh_column(
    first: int, stride: int, count: int, axis: int, inward: int, crossing: Float, degree: int, s: int,
    sides: PlaneSides, node_position: Floats, node_mass: Floats, table: SideTable, h: Float,
) -> Float:  # fmt: skip
    """Set weights and distances of a column; return its heaviest mass."""
    heaviest = 0.0
    for k in range(count):
        i = first + k * stride
        table.distance[k] = inward * (crossing - node_position[i, axis]) / h
        table.c[k] = 0.0
        if abs(table.distance[k]) < sides.reach[s]:
            table.c[k] = weight_at(table.distance[k], s, degree, sides)
            heaviest = max(heaviest, node_mass[i])
    return heaviest


@device
def add_column(
    rows: int, first: int, stride: int, count: int, inward: int, reach: Float, oblique: bool, alone: bool,
    light: Float,
    node_mass: Floats, table: SideTable,
) -> int:  # fmt: skip
    """Add the rows of one column, none if the body does not reach the side there; return the number of rows
    then.

    An empty node outside is read by linear extrapolation, which keeps Σ c_k = 1 and Σ c_k d_k = 0. So is,
    outwards, a node without mass inside of an oblique side, at whose ends columns leave the body."""
    begin = rows
    c, distance, row = table.c, table.distance, table.row
    for step in range(2, count):
        k = step - 2 if inward < 0 else count + 1 - step
        if oblique and distance[k] <= 0.0 and c[k] != 0.0 and node_mass[first + k * stride] == 0.0:
            c[k - inward] += 2.0 * c[k]
            c[k - 2 * inward] -= c[k]
            c[k] = 0.0
    for step in range(count - 2):
        k = count - 1 - step if inward < 0 else step
        one, two = k + inward, k + 2 * inward
        mass = node_mass[first + k * stride]
        if distance[k] >= reach + 1.0:
            continue
        thin = c[k] < THIN and (alone or mass <= light)
        empty = distance[k] > 0.0 and (thin or mass <= light * c[k] * c[k])
        if empty:
            c[one] += 2.0 * c[k]
            c[two] -= c[k]
            c[k] = 0.0
        elif c[k] != 0.0 and mass == 0.0:
            return begin
        in_line = empty or (oblique and distance[k] > 2.0 - reach)
        lightest = min(mass, node_mass[first + one * stride], node_mass[first + two * stride])
        if in_line and lightest > 0.0:
            for j in range(3):
                table.nodes[row[rows] + j] = first + (k + j * inward) * stride
                table.weights[row[rows] + j] = -2.0 if j == 1 else 1.0
            row[rows + 1] = row[rows] + 3
            table.target[rows] = 0.0
            rows += 1
    entry = row[rows]
    for k in range(count):
        if c[k] != 0.0:
            table.nodes[entry] = first + k * stride
            table.weights[entry] = c[k]
            entry += 1
    row[rows + 1] = entry
    table.target[rows] = 1.0
    return rows + 1


@device
def add_side(
    rows: int, s: int, degree: int, sides: PlaneSides, node_position: Floats, node_mass: Floats,
    table: SideTable,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Add the rows of side s; return the number of rows then."""
    dim, h, normal, axis = len(spacing), sides.grids[0] * spacing[0], sides.normal[s], sides.column[s, AXIS]
    along, total = sides.column[s, STRIDE], sides.column[s, COUNT]
    inward = -1 if normal[axis] > 0.0 else 1
    reach, oblique = sides.reach[s], sides.tabulated[s + 1] > sides.tabulated[s]
    for column in range((sides.column[s, STOP] - sides.column[s, START]) // total):
        first = sides.column[s, START] + column // along * along * total + column % along
        stride, count, inside = along, total, True
        if sides.grids[0] == 2:
            own = first_of_grid(first, axis, sides.lower, node_position, spacing)
            if own < 0:
                continue
            first, stride, count = first + own * along, 2 * along, (total - own + 1) // 2
        crossing = sides.place[s]
        for d in range(dim):
            if d != axis:
                crossing -= normal[d] * node_position[first, d]
                inside = inside and sides.box_lower[s, d] <= node_position[first, d] <= sides.box_upper[s, d]
        if not inside:
            continue
        crossing /= normal[axis]
        # Nodes that the side reaches, one more outwards and three inwards, from which the others are read
        middle = (crossing - node_position[first, axis]) / h
        low = max(0, int(np.floor(middle - reach - (3.0 if inward < 0 else 1.0))))
        high = min(count, int(np.ceil(middle + reach + (1.0 if inward < 0 else 3.0))) + 1)
        first += low * stride
        heaviest = weigh_column(
            first, stride, high - low, axis, inward, crossing, degree, s, sides, node_position, node_mass,
            table, h
        )  # fmt: skip
        if heaviest > 0.0:
            light = LIGHT * min(sides.cell_mass[s], 4.0 * heaviest)
            begin = rows
            rows = add_column(
                rows, first, stride, high - low, inward, reach, oblique, sides.alone[s] == 1, light,
                node_mass, table
            )  # fmt: skip
            factor_column(begin, rows, node_mass, table)
    return rows


@device
def factor_column(begin: int, end: int, node_mass: Floats, table: SideTable) -> None:
    """Set L of the rows of a column, A M⁻¹ Aᵀ = L Lᵀ (Cholesky)."""
    row, nodes, weights, factor = table.row, table.nodes, table.weights, table.factor
    for r in range(begin, end):
        table.first[r] = begin
        for q in range(begin, r + 1):
            left = 0.0
            for a in range(row[r], row[r + 1]):
                for b in range(row[q], row[q + 1]):
                    if nodes[a] == nodes[b]:
                        left += weights[a] * weights[b] / node_mass[nodes[a]]
            for k in range(q - begin):
                left -= factor[r, k] * factor[q, k]
            if q == r:
                factor[r, r - begin] = np.sqrt(max(left, 0.0))
            else:
                pivot = factor[q, q - begin]
                factor[r, q - begin] = left / pivot if pivot > 0.0 else 0.0


@kernel
def list_rows(
    degree: int, sides: PlaneSides, node_position: Floats, node_mass: Floats, table: SideTable,
    spacing: tuple[float, ...]
) -> int:  # fmt: skip
    """Fill the table with the rows of all sides; return their number."""
    rows = 0
    for s in range(len(sides.place)):
        before = rows
        rows = add_side(rows, s, degree, sides, node_position, node_mass, table, spacing)
        for r in range(before, rows):
            table.side[r] = s
    return rows
