"""Checks of what a table is, and of what its filling may and may not do."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.plots.style import dress
from mpmfw.state.fields import AnyArray, FloatArray
from mpmfw.state.history import NotSaved, put, take
from mpmfw.state.structs import Stencil
from mpmfw.state.windows import set_windows
from mpmfw_testing.bench import memory_kept
from mpmfw_testing.check import Picture, Violation
from mpmfw_testing.check import within as within_bound
from mpmfw_testing.generic import unchanged
from mpmfw_testing.searching import hypothesis
from mpmfw_testing.shape.cases import (
    CELLS,
    MIDDLE,
    dimensions_of,
    searched,
    within,
)
from mpmfw_testing.shape.picture import picture_of
from mpmfw_testing.shape.placement import Placement, boxes, place
from mpmfw_testing.subject import Subject

#: What a filling may add to memory [bytes]: less than a row pointer of the points that are filled.
GROWTH = 400
#: Fillings before memory is watched, while Python and NumPy fill their own caches, and while it is.
WARM, FILLINGS = 20, 40


@searched(examples=1)
def runs(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """A table is filled for the points of a body. One filling, in the plane, of the simplest case comes to
    its end.

    It is the plainest thing that a shape function does: what breaks it breaks most other checks as well.
    """
    _one_among_three(subject, dim, case).table()


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
    _require_table(table, placed.particles.count, dim, True, placed)
    falls = np.flatnonzero(np.diff(table.nodes[: table.row[-1]].astype(np.int64)) < 0) + 1
    if subject.make().rows_ascend and not np.isin(falls, table.row).all():
        raise Violation("the nodes of a row do not ascend, as rows_ascend = True says")
    if dim == 2:
        position = placed.particles.position[1:].copy()
        surface = placed.surface_table(position)
        if surface.gradient.shape != (0, dim):
            raise Violation(
                f"a surface table has no gradients: expected shape (0, {dim}), found {surface.gradient.shape}"
            )
        _require_table(surface, len(position), dim, False, placed)


@searched(examples=6)
def repeatable(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """The same points give the same table, bit by bit. Filled again, and by a fresh object."""
    placed = _one_among_three(subject, dim, case)
    first = _copied(placed.table())
    again = _copied(placed.fill())
    start = placed.particles.position.copy()
    other = _one_among_three(subject, dim, {**case, "x [cells]": 0.4})
    other.table()
    fresh = _copied(_one_among_three(subject, dim, case).table())
    for name, table in (("filled again", again), ("from a fresh object", fresh)):
        if not all(np.array_equal(a, b) for a, b in zip(first, table, strict=True)):
            raise Violation(
                f"the table differs when {name}", {"points [m]": start.tolist()}, picture_of(placed, 2)
            )


@searched(examples=3)
def saved(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """A motion that is saved in the middle and loaded goes on to the same bits. Values that are taken in the
    middle of a motion and put into a fresh object go on with the same bits.

    Taken is what its class names in ``history``, and declared arrays of points and bodies.
    """
    turn = 0.02 * (np.eye(dim) + np.diag(np.ones(dim - 1), 1))
    placed, anew = _one_among_three(subject, dim, case), _one_among_three(subject, dim, case)
    centre = placed.particles.position.mean(axis=0)
    placed.deform(turn, centre, steps=2)
    grid = placed.state.grid
    try:
        set_windows(anew.state.grid, grid.window_lower, grid.window_shape)
        put(
            take({"shape": placed.shape, "state": placed.state}),
            {"shape": anew.shape, "state": anew.state},
        )
    except NotSaved as error:
        raise Violation(str(error)) from error
    tables = []
    for each in (anew, placed):
        each.deform(turn, centre, steps=2)
        tables.append(_copied(each.table()))
    if not all(np.array_equal(a, b) for a, b in zip(*tables, strict=True)):
        raise Violation(
            "what was saved and loaded goes on otherwise: history does not name all that is kept",
            {"points [m]": placed.particles.position.tolist()},
            picture_of(placed, 2),
        )


@searched(examples=4)
def changes_nothing_else(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """Filling the table changes nothing but the table."""
    placed = _one_among_three(subject, dim, case)
    placed.lay()
    position = placed.particles.position.copy()

    def draw(axes: Any) -> None:
        picture_of(placed, 1)(axes)

    with unchanged("filling the table", placed.particles, placed.grid, picture=draw):
        placed.hook.particle_reach(particles=placed.particles)
        placed.fill()
        if dim == 2:
            placed.surface_table(position)


@searched(lambda _dim: {"points": hypothesis().strategies.just(200)}, examples=1)
def no_growth(subject: Subject, dim: int, _case: dict[str, Any]) -> None:
    """Filling the table again and again needs no more memory. A filling of 200 points adds at most 400 bytes
    to memory, on the mean of 40: a run fills a million times.

    A table of them has more than 10 kB. What is let through is Python's own small change.
    """
    rng = np.random.default_rng(0)
    many = MIDDLE + rng.uniform(-2.0, 2.0, (200, dim))
    placed = place(subject, [boxes(many, 0.5)], CELLS)
    placed.lay()
    position = placed.particles.position.copy()

    def fill() -> None:
        placed.fill()
        if dim == 2:
            placed.surface_table(position)

    held = memory_kept(fill, FILLINGS, WARM)
    grown = float(held[-1] - held[0]) / FILLINGS
    message = f"fillings of the table keep memory: bytes a filling, on the mean of {FILLINGS}"
    within_bound(grown, GROWTH, message, None, _memory_picture(held))


def _memory_picture(held: FloatArray) -> Picture:
    def picture(axes: Any) -> None:
        fillings = np.arange(len(held))
        axes.plot(fillings, 1e-3 * (held - held[0]), ".-", markersize=3, label="memory kept")
        axes.plot(fillings, 1e-3 * GROWTH * fillings, "--", color="0.5", label="bound")
        dress(axes, "fillings of the table", "memory kept [kB]")
        axes.legend()

    return picture


def dimensions(subject: Subject) -> None:
    """The plug-in declares its name and the dimensions that it works in. ``dimensions`` is a tuple of 2, 3 or
    both, and the name is one that a scene can give."""
    declared = dimensions_of(subject)
    if not declared or not set(declared) <= {2, 3} or len(set(declared)) != len(declared):
        raise Violation(f"dimensions must be (2,), (3,) or (2, 3); it is {declared}")
    name = subject.make().name
    if not isinstance(name, str) or not name.isidentifier():
        raise Violation(f"name must be an identifier, for the table [shape.NAME] of a scene; it is {name!r}")


def _one_among_three(subject: Subject, dim: int, case: dict[str, Any]) -> Placement:
    """One point of one body and two of another, the last of them where the case says."""
    centre, edge = MIDDLE + within(case, dim), float(case["edge [cells]"])
    bodies = [centre[None] - 1.4, np.stack([centre + 0.8, centre])]
    return place(subject, [boxes(body, edge) for body in bodies], CELLS)


def _copied(table: Stencil) -> tuple[AnyArray, ...]:
    """The entries that are used, copied: plug-ins fill the same table again."""
    used = int(table.row[-1])
    return (
        table.row.copy(),
        table.nodes[:used].copy(),
        table.weight[:used].copy(),
        table.gradient[:used].copy(),
    )


def _require_table(table: Stencil, count: int, dim: int, gradients: bool, placed: Placement) -> None:
    row = np.asarray(table.row)
    if row.shape != (count + 1,) or row[0] != 0 or (np.diff(row) < 0).any() or row[-1] > len(table.nodes):
        raise Violation(
            f"row must count up from 0 to at most {len(table.nodes)} entries in {count + 1} numbers; it is "
            f"{row}"
        )
    expected = {"row": np.int64, "nodes": np.int32, "weight": np.float64, "gradient": np.float64}
    for name, dtype in expected.items():
        array = getattr(table, name)
        if array.dtype != dtype or not array.flags.c_contiguous:
            raise Violation(f"{name} must be contiguous {np.dtype(dtype)}; it is {array.dtype}")
    shape = (len(table.nodes), dim) if gradients else (0, dim)
    if table.weight.shape != table.nodes.shape or table.gradient.shape != shape:
        raise Violation(
            f"weight and nodes must be as long as each other and gradient {shape}; they are "
            f"{table.weight.shape}, {table.nodes.shape} and {table.gradient.shape}"
        )
    used = int(row[-1])
    if not (np.isfinite(table.weight[:used]).all() and np.isfinite(table.gradient[:used]).all()):
        raise Violation("the table holds values that are not finite", {}, picture_of(placed, 1))


#: In the order in which they are run.
CHECKS = (runs, dimensions, structure, repeatable, saved, changes_nothing_else, no_growth)
