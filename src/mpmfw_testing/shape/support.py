"""Checks of where the entries are: the window of the own velocity field, the end of the grid, the reach."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import OutsideGrid, Stencil
from mpmfw_testing.check import Violation
from mpmfw_testing.searching import hypothesis
from mpmfw_testing.shape.cases import (
    AXES,
    CELLS,
    MIDDLE,
    coordinates,
    one_point,
    points,
    require,
    search_dimensions,
    searched,
    within,
)
from mpmfw_testing.shape.picture import picture_of
from mpmfw_testing.shape.placement import Placement, boxes, place
from mpmfw_testing.shape.sums import dense, entries_of, linear_error, unity_error
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
#: A grid that has room for any of these cases, in cells.
ROOMY = 64
#: Edges of domains whose reach is asked [cells], some larger than a cell, and what an edge may be stretched
#: to.
REACHING, LONGEST = (0.5, 4.0, 0.25, 1.0), 16.0


@searched()
def own_field(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """A point's entries are nodes of its own body's velocity field. No entry is a node of another body's
    velocity field; the two bodies lie in the same place, one larger."""
    centre = MIDDLE + within(case, dim)
    many = centre + np.array([[-2.5], [0.0], [1.5]])
    edge = float(case["edge [cells]"])
    placed = place(subject, [boxes(many, edge), boxes(centre[None], edge)], CELLS)
    table = placed.table()
    for point, field in ((0, 0), (2, 0), (3, 1)):
        nodes = table.nodes[entries_of(table, point)]
        _require_own(nodes, placed, point, field)


def support_inside(subject: Subject) -> None:
    """A support lies in the point's window, or OutsideGrid is raised with the index of the point. As a point
    moves without its window being laid anew, either its table is right or ``OutsideGrid`` names it.

    Right means entries of the own field with Σ φ = 1 and Σ φ x_i = x_p to 1e-9: nodes that run over the end
    of a row or of a field are somewhere else. A point that is a number no more, or beyond the grid, must be
    named; after the windows are laid anew a point with three cells of grid on all sides must not be.
    """
    draw = hypothesis().strategies

    def trial(dim: int, case: dict[str, Any]) -> None:
        for cells in MOVES:
            placed = one_point(subject, case, dim)
            placed.table()
            motion = np.zeros(dim)
            motion[AXES.index(case["moved along"])] = cells * placed.grid.cell_size
            _move(placed, motion)
            anew = case["window"] == "laid anew" and np.isfinite(cells)
            if anew:
                placed.lay()
            try:
                _require_table_or_report(placed, anew)
            except Violation as broken:
                raise broken.with_case({"moved by [cells]": cells}) from None

    def cases(dim: int) -> dict[str, Any]:
        return {
            "window": draw.sampled_from(("as it was", "laid anew")),
            "moved along": draw.sampled_from(AXES[:dim]),
            **points(dim),
        }

    search_dimensions(subject, cases, trial, examples=8)


def surface_inside(subject: Subject) -> None:
    """The support of a surface point lies in its window, or OutsideGrid is raised with its index. As
    ``support-inside``, for points on the boundary."""
    draw = hypothesis().strategies

    def trial(dim: int, case: dict[str, Any]) -> None:
        placed = one_point(subject, {**case, "edge [cells]": 0.5}, dim)
        placed.lay()
        for cells in (0.0, *MOVES):
            position = placed.particles.position[1:].copy()
            position[0, AXES.index(case["away along"])] += cells * placed.grid.cell_size
            try:
                _require_right(placed.surface_table(position), 0, position[0], placed)
            except OutsideGrid as error:
                _require_named(error, 0, placed, 1)
            except Violation as broken:
                raise broken.with_case({"away by [cells]": cells}) from None

    def cases(dim: int) -> dict[str, Any]:
        return {"away along": draw.sampled_from("xy"), **coordinates(dim)}

    search_dimensions(subject, cases, trial, only=(2,), examples=15)


def reach(subject: Subject) -> None:
    """Windows laid by particle_reach hold the supports of stretched domains. Windows laid by
    ``particle_reach`` hold the support, for domains stretched up to 16 fold, or to 16 cells.

    The reach is finite, not negative and (n, dim). The window's margin of three cells hides a reach that is
    too small until domains are large, when a run would stop with "left the grid" in the middle of it. Domains
    that are bounded while they stretch become so large where they begin with four cells; a shape function may
    refuse these.
    """
    draw = hypothesis().strategies

    def trial(dim: int, case: dict[str, Any]) -> None:
        centre = ROOMY / 2 + within(case, dim)
        edge = float(case["edge [cells]"])
        try:
            placed = place(subject, [boxes(centre[None], edge)], ROOMY)
        except SceneError:
            if edge <= 1.0:
                raise
            return
        extent = placed.hook.particle_reach(particles=placed.particles)
        if extent.shape != (1, dim) or not np.isfinite(extent).all() or (extent < 0.0).any():
            raise Violation(f"particle_reach must be (n, dim), finite and not negative; it is {extent}")
        stretch = np.zeros((dim, dim))
        axis = AXES.index(case["stretched along"])
        stretch[axis, axis] = 1.0
        try:
            doubled = min(case["doubled"], round(np.log2(LONGEST / edge)))
            placed.deform(stretch, placed.particles.position[0].copy(), steps=doubled)
            placed.table()
        except OutsideGrid:
            raise Violation(
                "a window that was laid by particle_reach does not hold the support",
                {"particle_reach [cells]": extent / placed.grid.cell_size},
                picture_of(placed, 0),
            ) from None

    def cases(dim: int) -> dict[str, Any]:
        return {
            "doubled": draw.integers(0, 4),
            "stretched along": draw.sampled_from(AXES[:dim]),
            "edge [cells]": draw.sampled_from(REACHING),
            **coordinates(dim),
        }

    search_dimensions(subject, cases, trial)


@searched()
def independence(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """A point's table does not depend on the other points. To 1e-14, alone or among five."""
    centre = MIDDLE + within(case, dim)
    others = centre + np.array([[-1.3], [0.4], [2.1], [0.0]]) * np.linspace(1.0, 0.5, dim)
    edge = float(case["edge [cells]"])
    tables = []
    for bodies in ([centre[None]], [others[:2], np.concatenate([others[2:], centre[None]])]):
        placed = place(subject, [boxes(body, edge) for body in bodies], CELLS)
        tables.append(dense(placed.table(), placed.particles.count - 1, placed.grid))
    error = max(float(np.abs(a - b).max()) for a, b in zip(*tables, strict=True))
    last = placed.particles.count - 1
    require(error, 1e-14, "the table of a point depends on the other points", placed, last)


def _move(placed: Placement, motion: FloatArray) -> None:
    """Move point 1 by ``motion`` [m], as one step does: domains that ride on the grid ride along."""
    placed.grid.velocity[placed.grid.field_nodes(1)] = motion
    placed.particles.position[1] += motion
    placed.hook.update_particle_domains(particles=placed.particles, grid=placed.grid, dt=1.0)


def _require_table_or_report(placed: Placement, laid_anew: bool) -> None:
    position = placed.particles.position[1]
    place_of = (position - placed.grid.lower) / placed.grid.cell_size
    try:
        table = placed.fill()
    except OutsideGrid as error:
        _require_named(error, 1, placed, 1)
        if laid_anew and (place_of >= MARGIN).all() and (place_of <= CELLS - MARGIN).all():
            raise Violation(
                "OutsideGrid is raised for a point with three cells of grid on every side", picture=None
            ) from None
        return
    if not ((place_of >= 0.0) & (place_of <= CELLS)).all():
        raise Violation("no OutsideGrid is raised for a point that is outside the grid")
    _require_right(table, 1, position, placed)


def _require_named(error: OutsideGrid, index: int, placed: Placement, shown: int) -> None:
    if error.index != index:
        raise Violation(
            f"OutsideGrid names point {error.index}; the one that left is {index}",
            {},
            picture_of(placed, shown),
        )


def _require_own(nodes: Any, placed: Placement, point: int, field: int) -> None:
    first, last = int(placed.grid.offset[field]), int(placed.grid.offset[field + 1]) - 1
    if not ((nodes >= first) & (nodes <= last)).all():
        raise Violation(
            f"a point of velocity field {field} has entries {nodes.min()} … {nodes.max()}; its field's nodes "
            "are "
            f"{first} … {last}",
            {"point": point},
            picture_of(placed, point),
        )


def _require_right(table: Stencil, row: int, position: FloatArray, placed: Placement) -> None:
    """Entries of the last field, Σ φ = 1 and Σ φ x_i = x."""
    _require_own(table.nodes[entries_of(table, row)], placed, 1, placed.grid.n_fields - 1)
    error = max(unity_error(table, row), linear_error(table, row, position, placed.grid))
    message = "no OutsideGrid is raised, and the table is wrong: Σ φ ≠ 1, or Σ φ x_i is not the point"
    require(error, 1e-9, message, placed, 1)


#: In the order in which they are run.
CHECKS = (own_field, support_inside, surface_inside, reach, independence)
