"""Checks of the table and of where its entries are: own window, end of the grid, reach."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.errors import OutsideGrid, SceneError
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Stencil
from mpmfw_testing.bench import dims_of
from mpmfw_testing.check import Violation, within
from mpmfw_testing.generic import unchanged
from mpmfw_testing.searching import hypothesis
from mpmfw_testing.shape.cases import (
    AXES,
    CELLS,
    MIDDLE,
    coordinates,
    one_point,
    points,
    position,
    sampled,
    searched,
)
from mpmfw_testing.shape.placement import Placement, boxes, place
from mpmfw_testing.shape.sums import entries_of, linear_error, unity_error
from mpmfw_testing.subject import Subject

#: Cells that a window is laid round the points' domains at least, so that supports up to there must be found.
MARGIN = 3
#: Motions [cells], the smallest first: through the margin, over the window's end, out of the grid, and to
#: nowhere.
MOVES = (
    *(sign * cells for cells in (1.0, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.5, 8.0, 9.0) for sign in (1.0, -1.0)),
    1e30,
    float("nan"),
)
#: A grid that has room for any of the cases of ``reach`` [cells].
ROOMY = 64
#: Edges of domains whose reach is asked [cells], some larger than a cell, and the longest that is stretched.
REACHING, LONGEST = (0.5, 4.0, 0.25, 1.0), 16.0


def dimensions(subject: Subject) -> None:
    """The plug-in declares its name and the dimensions that it works in. ``dimensions`` is a tuple of 2, 3 or
    both, and the name is one that a scene can give."""
    declared = dims_of(subject)
    if not set(declared) <= {2, 3} or len(set(declared)) != len(declared):
        raise Violation(f"dimensions must be (2,), (3,) or (2, 3); it is {declared}")
    name = subject.make().name
    if not isinstance(name, str) or not name.isidentifier():
        raise Violation(f"name must be an identifier, for the table [shape.NAME] of a scene; it is {name!r}")


@searched(examples=4)
def structure(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """The table has the layout that compiled kernels read. ``row`` counts up from 0 to at most the number of
    entries; int64, int32 and contiguous float64; all finite; the nodes of a row ascend, if ``rows_ascend``
    says so.

    Compiled kernels read the table without asking: a wrong type compiles them anew or crashes, a wrong row
    reads another point's entries.
    """
    placed = _one_among_three(subject, dim, case)
    table = placed.table()
    _require_table(table, placed.particles.count, (len(table.nodes), dim))
    falls = np.flatnonzero(np.diff(table.nodes[: table.row[-1]].astype(np.int64)) < 0) + 1
    if subject.make().rows_ascend and not np.isin(falls, table.row).all():
        raise Violation("the nodes of a row do not ascend, as rows_ascend = True says")
    if dim == 2:
        _require_table(placed.surface_table(placed.particles.position[1:].copy()), 2, (0, dim))


def _require_table(table: Stencil, count: int, gradient: tuple[int, int]) -> None:
    """Require the layout of the table of so many points, with this shape of the gradients."""
    row = np.asarray(table.row)
    if row.shape != (count + 1,) or row[0] != 0 or (np.diff(row) < 0).any() or row[-1] > len(table.nodes):
        text = f"row must count up from 0 to at most {len(table.nodes)} entries in {count + 1} numbers"
        raise Violation(f"{text}; it is {row}")
    expected = {"row": np.int64, "nodes": np.int32, "weight": np.float64, "gradient": np.float64}
    for name, dtype in expected.items():
        array = getattr(table, name)
        if array.dtype != dtype or not array.flags.c_contiguous:
            raise Violation(f"{name} must be contiguous {np.dtype(dtype)}; it is {array.dtype}")
    shapes = (table.weight.shape, table.gradient.shape)
    if shapes != (table.nodes.shape, gradient):
        text = f"weight and gradient must have the shapes {table.nodes.shape} and {gradient}"
        raise Violation(f"{text}; they have {shapes[0]} and {shapes[1]}")
    if not all(np.isfinite(array[: row[-1]]).all() for array in (table.weight, table.gradient)):
        raise Violation("the table holds values that are not finite")


@searched(examples=4)
def changes_nothing_else(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """Filling the table changes nothing but the table."""
    placed = _one_among_three(subject, dim, case)
    placed.lay()
    at = placed.particles.position.copy()
    with unchanged("filling the table", placed.particles, placed.grid):
        placed.hook.particle_reach(particles=placed.particles)
        placed.fill()
        if dim == 2:
            placed.surface_table(at)


def _one_among_three(subject: Subject, dim: int, case: dict[str, Any]) -> Placement:
    """Return one point of one body and two of another, the last of them where the case says."""
    centre, edge = position(case, dim), float(case["edge [cells]"])
    bodies = [centre[None] - 1.4, np.stack([centre + 0.8, centre])]
    return place(subject, [boxes(body, edge) for body in bodies], CELLS)


@searched(
    lambda dim: {
        "window": sampled(("as it was", "laid anew")), "moved along": sampled(AXES[:dim]), **points(dim)
    },
    examples=8,
)  # fmt: skip
def support_inside(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """A support lies in the point's window, or OutsideGrid is raised with the index of the point. As a point
    moves without its window being laid anew, either its table is right or ``OutsideGrid`` names it.

    Right means entries of the own field with Σ φ = 1 and Σ φ x_i = x_p to 1e-9. A point that is not a number
    any more, or beyond the grid, must be named; after the windows are laid anew a point with three cells of
    grid on all sides must not be.
    """
    for cells in MOVES:
        placed = one_point(subject, case, dim)
        placed.table()
        motion = np.zeros(dim)
        motion[AXES.index(case["moved along"])] = cells * placed.grid.cell_size
        # as one step does: domains that ride on the grid ride along
        placed.grid.velocity[placed.grid.field_nodes(1)] = motion
        placed.particles.position[1] += motion
        placed.hook.update_particle_domains(particles=placed.particles, grid=placed.grid, dt=1.0)
        anew = case["window"] == "laid anew" and np.isfinite(cells)
        if anew:
            placed.lay()
        at = (placed.particles.position[1] - placed.grid.lower) / placed.grid.cell_size
        moved = {"moved by [cells]": cells}
        try:
            _require_right(placed.fill(), 1, placed.particles.position[1], placed, moved)
        except OutsideGrid as error:
            _require_named(error, 1, moved)
            if anew and (at >= MARGIN).all() and (at <= CELLS - MARGIN).all():
                text = "OutsideGrid is raised for a point with three cells of grid on every side"
                raise Violation(text, moved) from None
        else:
            if not ((at >= 0.0) & (at <= CELLS)).all():
                raise Violation("no OutsideGrid is raised for a point that is outside the grid", moved)


@searched(lambda dim: {"away along": sampled("xy"), **coordinates(dim)}, only=(2,))
def surface_inside(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """The support of a surface point lies in its window, or OutsideGrid is raised with its index. As
    ``support-inside``, for points on the boundary."""
    placed = one_point(subject, {**case, "edge [cells]": 0.5}, dim)
    placed.lay()
    for cells in (0.0, *MOVES):
        at, away = placed.particles.position[1:].copy(), {"away by [cells]": cells}
        at[0, AXES.index(case["away along"])] += cells * placed.grid.cell_size
        try:
            _require_right(placed.surface_table(at), 0, at[0], placed, away)
        except OutsideGrid as error:
            _require_named(error, 0, away)


def _require_named(error: OutsideGrid, index: int, case: dict[str, Any]) -> None:
    if error.index != index:
        raise Violation(f"OutsideGrid names point {error.index}; the one that left is {index}", case)


def _require_own(nodes: Any, placed: Placement, point: int, field: int, **case: object) -> None:
    first, last = int(placed.grid.offset[field]), int(placed.grid.offset[field + 1]) - 1
    if not ((nodes >= first) & (nodes <= last)).all():
        text = f"a point of velocity field {field} has entries {nodes.min()} … {nodes.max()}"
        raise Violation(f"{text}; its field's nodes are {first} … {last}", {**case, "point": point})


def _require_right(table: Stencil, row: int, at: FloatArray, placed: Placement, case: dict[str, Any]) -> None:
    """Require entries of the last field, Σ φ = 1 and Σ φ x_i = x."""
    _require_own(table.nodes[entries_of(table, row)], placed, 1, placed.grid.n_fields - 1, **case)
    error = max(unity_error(table, row), linear_error(table, row, at, placed.grid))
    text = "no OutsideGrid is raised, and the table is wrong: Σ φ ≠ 1, or Σ φ x_i is not the point"
    within(error, 1e-9, text, case)


@searched(
    lambda dim: {
        "doubled": hypothesis().strategies.integers(0, 4), "stretched along": sampled(AXES[:dim]),
        "edge [cells]": sampled(REACHING), **coordinates(dim),
    }
)  # fmt: skip
def reach(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """Windows laid by particle_reach hold the supports of stretched domains. They are stretched up to 16
    fold, or to 16 cells.

    The reach is finite, not negative and (n, dim). The window's margin of three cells hides a reach that is
    too small until domains are large. Some begin with four cells, which a shape function may refuse.
    """
    centre, edge = ROOMY / 2 - MIDDLE + position(case, dim), float(case["edge [cells]"])
    try:
        placed = place(subject, [boxes(centre[None], edge)], ROOMY)
    except SceneError:
        if edge <= 1.0:
            raise
        return
    extent = placed.hook.particle_reach(particles=placed.particles)
    if extent.shape != (1, dim) or not np.isfinite(extent).all() or (extent < 0.0).any():
        raise Violation(f"particle_reach must be (n, dim), finite and not negative; it is {extent}")
    stretch, axis = np.zeros((dim, dim)), AXES.index(case["stretched along"])
    stretch[axis, axis] = 1.0
    try:
        doubled = min(case["doubled"], round(np.log2(LONGEST / edge)))
        placed.deform(stretch, placed.particles.position[0].copy(), steps=doubled)
        placed.table()
    except OutsideGrid:
        text = "a window that was laid by particle_reach does not hold the support"
        raise Violation(text, {"particle_reach [cells]": extent / placed.grid.cell_size}) from None


#: In the order in which they are run.
CHECKS = (support_inside, surface_inside, reach)
