"""Points with domains on a grid, and the shape function under test at work there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmfw.api.shape import ShapeFunction
from mpmfw.geometry.layout import Layout, layout_of_boxes
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body, Grid, Particles, State, Stencil
from mpmfw.state.windows import fit_windows, make_grid
from mpmfw_testing.bench import points_at_rest, set_up
from mpmfw_testing.subject import Subject

#: h [m]; not 1, so that a factor of h cannot hide. A power of two, so that cells begin exactly where they
#: should.
CELL = 0.25
#: Position of the grid's first node [m], cut to the dimension; not 0, so that it cannot be forgotten.
ORIGIN = (-1.5, 0.75, 2.0)


@dataclass
class Placement:
    """Bodies of one or more points, each with a velocity field and a window of its own."""

    state: State
    layouts: tuple[Layout, ...]
    setup: Setup
    shape: ShapeFunction
    hook: Any

    @property
    def particles(self) -> Particles:
        """The material points."""
        return self.state.particles

    @property
    def grid(self) -> Grid:
        """The background grid."""
        return self.state.grid

    @property
    def dim(self) -> int:
        """Number of space dimensions."""
        return self.grid.dim

    def lay(self) -> None:
        """Lay the windows by the plug-in's own ``particle_reach``."""
        reach = self.hook.particle_reach(particles=self.particles)
        fit_windows(self.grid, self.particles, reach, None)

    def table(self) -> Stencil:
        """Lay the windows and fill the table."""
        self.lay()
        return self.fill()

    def fill(self) -> Stencil:
        """φ_ip and ∇φ_ip in the windows as they are."""
        stencil: Stencil = self.hook.interpolate(particles=self.particles, grid=self.grid)
        return stencil

    def surface_table(self, position: FloatArray) -> Stencil:
        """N_i at boundary points ``position`` (n, dim) [m] of the last body."""
        fields = self.grid.n_fields
        first = np.array([0] * fields + [len(position)], dtype=np.int64)
        stencil: Stencil = self.hook.interpolate_surface(position=position, first=first, grid=self.grid)
        return stencil

    def deform(self, velocity_gradient: FloatArray, centre: FloatArray, steps: int = 4) -> None:
        """Let all points take part in the motion v = L (x − c) for ``steps`` steps of 1 s, as the stepper
        does.

        ``velocity_gradient`` is L, (dim, dim) [1/s], and ``centre`` c, (dim,) [m].

        F ← (1 + L) F and V = det F V_0 at every step; the grid's velocity is v at every node, which any shape
        function with linear reproduction reads without error, so that domains that ride on it are moved
        exactly.
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

    def half_edges(self, index: int) -> FloatArray:
        """Half-edge vectors F R_0 of the domain of point ``index``, (dim, dim) [m]."""
        edges: FloatArray = self.particles.deformation_gradient[index] @ self.setup.half_edges[index]
        return edges


def boxes(position: FloatArray, edge: float) -> Layout:
    """Square or cubic domains: centres (n, dim) and ``edge`` [cells from the first node]."""
    dim = position.shape[1]
    return layout_of_boxes(np.array(ORIGIN[:dim]) + CELL * position, np.full(position.shape, CELL * edge))


def place(subject: Subject, layouts: Sequence[Layout], cells: int) -> Placement:
    """Set the shape function of a ``subject`` up for bodies of these layouts.

    ``layouts`` has one a body, as :func:`boxes` makes them; the grid has ``cells`` cells along each axis.
    """
    position = np.concatenate([layout.position for layout in layouts])
    volume = np.concatenate([layout.volume for layout in layouts])
    dim = position.shape[1]
    starts = np.cumsum([0, *(len(layout.volume) for layout in layouts)])
    origin = np.array(ORIGIN[:dim])
    grid = make_grid(CELL, origin, origin + CELL * cells, len(layouts))
    bodies = tuple(
        _body(index, layout, slice(int(starts[index]), int(starts[index + 1])))
        for index, layout in enumerate(layouts)
    )
    state = State(points_at_rest(position, volume, starts), grid, bodies, ())
    shape = subject.make()
    setup, hook = set_up(
        shape,
        state,
        layouts=tuple(layouts),
        shape=shape.name,
        massless_boundary=shape.massless_boundary,
        transfer="aflip",
    )
    return Placement(state, tuple(layouts), setup, shape, hook)


def _body(index: int, layout: Layout, own: slice) -> Body:
    reach = np.abs(layout.half_edges).sum(axis=2)
    return Body(
        name=f"body {index}",
        index=index,
        particles=own,
        field=index,
        density=1.0,
        bulk_modulus=1.0,
        shear_modulus=0.5,
        lower=tuple((layout.position - reach).min(axis=0).tolist()),
        upper=tuple((layout.position + reach).max(axis=0).tolist()),
        outlines=(),
    )
