"""Points with domains on a grid, and the shape function under test at work there."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmfw.api.shape import ShapeFunction
from mpmfw.errors import OutsideGrid
from mpmfw.geometry.layout import Layout, layout_of_boxes
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import AnyArray, FloatArray
from mpmfw.state.history import put, take
from mpmfw.state.structs import Body, Grid, Particles, State, Stencil
from mpmfw.state.windows import fit_windows, make_grid, set_windows
from mpmfw_testing.bench import dims_of, points_at_rest, set_up
from mpmfw_testing.check import remember
from mpmfw_testing.shape.sums import entries_of
from mpmfw_testing.subject import Subject

#: h [m]; not 1, so that a factor of h cannot hide. A power of two, so that cells begin exactly where they
#: should.
CELL = 0.25
#: Position of the grid's first node [m], cut to the dimension; not 0, so that it cannot be forgotten.
ORIGIN = (-1.5, 0.75, 2.0)
_POSITIVE, _NEGATIVE, _DOMAIN = "#0072B2", "#D55E00", "#009E73"


@dataclass
class Placement:
    """Bodies of one or more points, each with its own velocity field and window; a session of a motion."""

    state: State
    layouts: tuple[Layout, ...]
    setup: Setup
    shape: ShapeFunction
    hook: Any

    @property
    def particles(self) -> Particles:
        """Return the material points."""
        return self.state.particles

    @property
    def grid(self) -> Grid:
        """Return the background grid."""
        return self.state.grid

    @property
    def dim(self) -> int:
        """Return the number of space dimensions."""
        return self.grid.dim

    def lay(self) -> None:
        """Lay the windows by the plug-in's own ``particle_reach``."""
        fit_windows(self.state, self.hook)

    def table(self) -> Stencil:
        """Lay the windows and fill the table."""
        self.lay()
        return self.fill()

    def fill(self) -> Stencil:
        """Return φ_ip and ∇φ_ip in the windows as they are."""
        stencil: Stencil = self.hook.interpolate(particles=self.particles, grid=self.grid)
        return stencil

    def surface_table(self, position: FloatArray) -> Stencil:
        """Return N_i at boundary points ``position`` (n, dim) [m] of the last body."""
        first = np.array([0] * self.grid.n_fields + [len(position)], dtype=np.int64)
        stencil: Stencil = self.hook.interpolate_surface(position=position, first=first, grid=self.grid)
        return stencil

    def deform(self, velocity_gradient: FloatArray, centre: FloatArray, steps: int = 4) -> None:
        """Move all points by v = L (x − c) for ``steps`` steps of 1 s, as the stepper does.

        ``velocity_gradient`` is L, (dim, dim) [1/s], and ``centre`` c, (dim,) [m]. The grid's velocity is v
        at every node, so that domains that ride on it are moved exactly.
        """
        p, g = self.particles, self.grid
        for _ in range(steps):
            self.table()
            g.velocity[...] = (g.position - centre) @ velocity_gradient.T
            p.position += (p.position - centre) @ velocity_gradient.T
            p.velocity_gradient[...] = velocity_gradient
            p.deformation_gradient[...] = (np.eye(self.dim) + velocity_gradient) @ p.deformation_gradient
            p.volume[...] = np.linalg.det(p.deformation_gradient) * p.initial_volume
            self.hook.update_particle_domains(particles=p, grid=g, dt=1.0)

    def advance(self) -> Iterator[tuple[str, AnyArray]]:
        """Fill the tables, then go on with a small motion; yield the tables before and after it."""
        turn = 0.02 * (np.eye(self.dim) + np.diag(np.ones(self.dim - 1), 1))
        for when in ("before", "after"):
            try:
                if when == "after":
                    self.deform(turn, self.particles.position.mean(axis=0), steps=2)
                tables = {"table": self.table()}
                if self.dim == 2:
                    tables["surface table"] = self.surface_table(self.particles.position[-1:].copy())
            except OutsideGrid as error:
                yield f"point outside {when} the motion", np.array(error.index)
                return
            for name, table in tables.items():
                for part in ("row", "nodes", "weight", "gradient"):
                    used = slice(None if part == "row" else int(table.row[-1]))
                    yield f"{part} of the {name} {when} the motion", getattr(table, part)[used]

    def save(self) -> dict[str, AnyArray]:
        """Return the history of shape function, points and grid."""
        return take({"shape": self.shape, "state": self.state})

    def load(self, saved: dict[str, AnyArray]) -> None:
        """Take it, with the windows that were saved."""
        set_windows(self.grid, saved["state/grid/window_lower"], saved["state/grid/window_shape"])
        put(saved, {"shape": self.shape, "state": self.state})

    def draw(self, axes: Any, case: Mapping[str, object]) -> None:
        """Draw the point that the case names, or the last: its domain, its nodes and their weights.

        In 3D it is seen along z, with weights summed over nodes that lie behind each other.
        """
        from mpmfw.plots.style import dress

        point, grid = int(str(case.get("point", self.particles.count - 1))), self.grid
        centre = (self.particles.position[point] - grid.lower)[:2] / grid.cell_size
        half = (self.particles.deformation_gradient[point] @ self.setup.half_edges[point])[:2, :2]
        signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        axes.fill(*(centre + signs @ half.T / grid.cell_size).T, color=_DOMAIN, alpha=0.3, label="domain")
        axes.plot(*centre, "+", color="black", markersize=7, linestyle="", label="point")
        try:
            table = self.fill()
            own = entries_of(table, point)
            nodes, weights = table.nodes[own], table.weight[own]
        except OutsideGrid:
            nodes, weights = np.zeros(0, dtype=int), np.zeros(0)
        there = (nodes >= 0) & (nodes < len(grid.position))
        numbers = np.rint((grid.position[nodes[there]] - grid.lower)[:, :2] / grid.cell_size)
        places, which = np.unique(numbers, axis=0, return_inverse=True)
        total = np.bincount(which.ravel(), weights[there], minlength=len(places))
        for colour, sign, name in ((_POSITIVE, 1.0, "weight > 0"), (_NEGATIVE, -1.0, "weight < 0")):
            felt = sign * total > 0.0
            if felt.any():
                size = 420.0 * np.minimum(np.abs(total[felt]), 1.0)
                axes.scatter(*places[felt].T, s=size, color=colour, alpha=0.7, linewidth=0, label=name)
        for node, weight in zip(places, total, strict=True):
            axes.annotate(f"{weight:.3g}", node, xytext=(3, 3), textcoords="offset points")
        dress(axes, "x [cells from the grid's first node]", "y [cells]" + ", seen along z" * (self.dim == 3))
        axes.set_aspect("equal", adjustable="datalim")
        axes.legend()


def boxes(position: FloatArray, edge: float) -> Layout:
    """Return square or cubic domains: centres (n, dim) and ``edge`` [cells from the first node]."""
    dim = position.shape[1]
    return layout_of_boxes(np.array(ORIGIN[:dim]) + CELL * position, np.full(position.shape, CELL * edge))


def lattice(count: int, edge: float, dim: int) -> FloatArray:
    """Return the centres of so many cells of an ``edge`` along each axis, (count^dim, dim)."""
    axis = (np.arange(count) + 0.5) * edge
    return np.stack(np.meshgrid(*[axis] * dim, indexing="ij"), axis=-1).reshape(-1, dim)


def place(subject: Subject, layouts: Sequence[Layout], cells: int, made: Any = None) -> Placement:
    """Set the shape function of a ``subject`` up for bodies of these layouts.

    ``layouts`` has one a body, as :func:`boxes` makes them; the grid has ``cells`` cells along each axis. An
    object that is ``made`` takes the place of a fresh one.
    """
    position = np.concatenate([layout.position for layout in layouts])
    volume = np.concatenate([layout.volume for layout in layouts])
    starts = np.cumsum([0, *(len(layout.volume) for layout in layouts)])
    origin = np.array(ORIGIN[: position.shape[1]])
    grid = make_grid(CELL, origin, origin + CELL * cells, len(layouts))
    bodies = tuple(
        _body(index, layout, slice(int(starts[index]), int(starts[index + 1])))
        for index, layout in enumerate(layouts)
    )
    state = State(points_at_rest(position, volume, starts), grid, bodies, ())
    shape = subject.make() if made is None else made
    setup, hook = set_up(
        shape,
        state,
        layouts=tuple(layouts),
        shape=shape.name,
        massless_boundary=shape.massless_boundary,
        transfer="aflip",
    )
    placed = Placement(state, tuple(layouts), setup, shape, hook)
    remember(draw=placed.draw)
    return placed


def _body(index: int, layout: Layout, own: slice) -> Body:
    reach = np.abs(layout.half_edges).sum(axis=2)
    lower, upper = (layout.position - reach).min(axis=0), (layout.position + reach).max(axis=0)
    return Body(
        f"body {index}", index, own, index, 1.0, 1.0, 0.5, tuple(lower.tolist()), tuple(upper.tolist()), ()
    )


#: Grids' cells along an axis, and places of the point [cells along every axis]: inside, on a face, in the
#: grid's first and last cell.
CELLS, PLACES = 16, (8.3, 8.0, 0.4, 15.6)


def openings(subject: Subject) -> Iterator[Callable[[Any], Placement]]:
    """Yield a body of forty points, and in one place after the other a point beside another body's."""
    for dim in dims_of(subject):
        many = 8.0 + np.random.default_rng(0).uniform(-2.0, 2.0, (40, dim))
        yield functools.partial(place, subject, [boxes(many, 0.5)], CELLS)
        for at in PLACES:
            bodies = [boxes(np.full((1, dim), where), 0.5) for where in (6.4, at)]
            yield functools.partial(place, subject, bodies, CELLS)
