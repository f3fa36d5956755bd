"""Impulses that bring the momentum to the rows of sides, A v = V (:mod:`mpmfw.effects.side_rows`)."""

from __future__ import annotations

from mpmfw.effects.side_rows import SideTable
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.arithmetic import add_scaled_row
from mpmfw.kernels.types import Float, Floats


@device
def read_rows(
    rows: int, table: SideTable, directions: Floats, velocity: Floats, node_mass: Floats, momentum: Floats,
    out: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """out = A M⁻¹ p along the prescribed directions, 0 along others."""
    dim, row, nodes = len(spacing), table.row, table.nodes
    own = scratch.matrix((0.0,), spacing)
    for r in range(rows):
        s = table.side[r]
        for d in range(dim):
            own[0, d] = 0.0
        for a in range(row[r], row[r + 1]):
            add_scaled_row(own, 0, table.weights[a] / node_mass[nodes[a]], momentum, nodes[a], spacing)
        for e in range(dim):
            out[r, e] = 0.0
            if velocity[s, e] == velocity[s, e]:
                for d in range(dim):
                    out[r, e] += own[0, d] * directions[s, e, d]


@device
def add_impulses(
    rows: int, table: SideTable, directions: Floats, factor: float, impulse: Floats, momentum: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """p += factor Aᵀ x, with x the ``impulse`` of the rows along the directions."""
    own = scratch.matrix((0.0,), spacing)
    for r in range(rows):
        for d in range(len(spacing)):
            own[0, d] = 0.0
        for e in range(len(spacing)):
            add_scaled_row(own, 0, factor * impulse[r, e], directions[table.side[r]], e, spacing)
        for a in range(table.row[r], table.row[r + 1]):
            add_scaled_row(momentum, table.nodes[a], table.weights[a], own, 0, spacing)


@device
def divide_by_columns(rows: int, table: SideTable, given: Floats, x: Floats, dim: int) -> None:
    """x = ``given`` of the rows over L Lᵀ of their columns."""
    factor, first = table.factor, table.first
    for r in range(rows):
        pivot = factor[r, r - first[r]]
        for e in range(dim):
            x[r, e] = given[r, e]
            for q in range(first[r], r):
                x[r, e] -= factor[r, q - first[r]] * x[q, e]
            x[r, e] = x[r, e] / pivot if pivot > 0.0 else 0.0
    for r in range(rows - 1, -1, -1):
        pivot = factor[r, r - first[r]]
        for e in range(dim):
            x[r, e] = x[r, e] / pivot if pivot > 0.0 else 0.0
            for q in range(first[r], r):
                x[q, e] -= factor[r, q - first[r]] * x[r, e]


@device
def read_changes(
    rows: int, table: SideTable, directions: Floats, velocity: Floats, node_mass: Floats,
    spacing: tuple[float, ...],
) -> Float:  # fmt: skip
    """Set ``answer`` to A M⁻¹ Aᵀ x of the impulses x = ``divided``; return their product."""
    product = 0.0
    for r in range(rows):
        for a in range(table.row[r], table.row[r + 1]):
            for d in range(len(spacing)):
                table.push[table.nodes[a], d] = 0.0
    add_impulses(rows, table, directions, 1.0, table.divided, table.push, spacing)
    read_rows(rows, table, directions, velocity, node_mass, table.push, table.answer, spacing)
    for r in range(rows):
        for e in range(len(spacing)):
            product += table.divided[r, e] * table.answer[r, e]
    return product


@kernel
def meet(
    rows: int, table: SideTable, directions: Floats, velocity: Floats, passes: int, agreed: float,
    node_mass: Floats, node_momentum: Floats, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Give the ``rows`` the impulses that meet them, until the sides miss at most ``agreed`` [m/s], in at
    most so many ``passes``; return the number of passes.

    p += Aᵀ λ with A M⁻¹ Aᵀ λ = V − A v, along each prescribed direction of the side, ``directions``
    (n_sides, dim, dim), one a row. V is ``velocity`` (n_sides, dim) [m/s]; NaN leaves a component free. It is
    the least change of the momentum, in the norm of the masses, that meets all rows. So a velocity that is
    linear from the side inwards keeps its gradient, an impulse acts where a traction on the side would, and
    no frequency of the body rises: the step needs no new limit. Columns of one side share no nodes, and are
    solved at once. Where those of two sides share some, these solutions precondition conjugate residuals
    (Stiefel 1955): what sides miss never grows, and sides that contradict one another meet in between."""
    dim, missing, divided, search, change = (
        len(spacing), table.missing, table.divided, table.search, table.change
    )  # fmt: skip
    if len(table.applied) > 0:
        table.applied[:rows, :] = 0.0
    read_rows(rows, table, directions, velocity, node_mass, node_momentum, missing, spacing)
    largest, previous = 0.0, 1.0
    for r in range(rows):
        for e in range(dim):
            wanted = velocity[table.side[r], e]
            missing[r, e] = (table.target[r] * wanted if wanted == wanted else 0.0) - missing[r, e]
            largest = max(largest, table.target[r] * abs(missing[r, e]))
            search[r, e] = change[r, e] = 0.0
    divide_by_columns(rows, table, missing, divided, dim)
    for count in range(passes):
        if largest <= agreed:
            return count
        product = read_changes(rows, table, directions, velocity, node_mass, spacing)
        for r in range(rows):
            for e in range(dim):
                search[r, e] = divided[r, e] + product / previous * search[r, e]
                change[r, e] = table.answer[r, e] + product / previous * change[r, e]
        divide_by_columns(rows, table, change, table.step, dim)
        square, most = 0.0, 0.0
        for r in range(rows):
            for e in range(dim):
                square += change[r, e] * table.step[r, e]
                most = max(most, table.target[r] * abs(change[r, e]))
        if not product * most > agreed * square:  # what is left contradicts itself
            return count
        largest, length, previous = 0.0, product / square, product
        add_impulses(rows, table, directions, length, search, node_momentum, spacing)
        for r in range(rows):
            for e in range(dim):
                missing[r, e] -= length * change[r, e]
                divided[r, e] -= length * table.step[r, e]
                largest = max(largest, table.target[r] * abs(missing[r, e]))
                table.impulse[table.side[r], e] += length * search[r, e] * table.target[r]
                if len(table.applied) > 0:
                    table.applied[r, e] += length * search[r, e]
    return passes
