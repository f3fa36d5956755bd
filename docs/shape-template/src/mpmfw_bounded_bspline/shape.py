"""The shape function: what mpmfw asks of it, and where the compiled kernel is called."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from mpmfw.api.shape import ShapeFunction, check_inside, empty_stencil
from mpmfw.api.types import FloatArray, Grid, IntArray, Particles, Setup, Stencil, hookimpl
from pydantic import BaseModel, ConfigDict, Field

from mpmfw_bounded_bspline.kernel import WIDTH, fill_bounded


class BoundedBSplineOptions(BaseModel):
    """What happens where the grid ends: the table ``[shape.bounded_bspline]`` of a scene."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    grid_end: Annotated[
        Literal["modified", "refuse"],
        Field(
            description=(
                "In the last half cell of the grid a node of the support is missing. 'modified' reads it by "
                "linear "
                "extrapolation; 'refuse' stops the run, as the bundled `bspline` does"
            )
        ),
    ] = "modified"


class BoundedBSpline(ShapeFunction):
    """φ_ip = Π_d B²((x_p − x_i)_d / h): 9 nodes in 2D, 27 in 3D; surfaces are mapped with the same weights.

    Inside the grid it is the bundled `bspline`. That one stops where a support leaves the grid, half a cell
    before its end; here bodies may fill the grid to the last node.

    M. Steffen, R. M. Kirby, M. Berzins (2008): Analysis and reduction of quadrature errors in the material
    point method (MPM). International Journal for Numerical Methods in Engineering 76, 922-948.
    """

    name = "bounded_bspline"
    Options = BoundedBSplineOptions
    options: BoundedBSplineOptions
    boundary_degree = 2
    # All other facts are the defaults of ShapeFunction: 2D and 3D; boundary nodes carry mass; the spread
    # Σ φ q qᵀ is h²/4 away from the grid's ends and never singular; `auto` is USL with affine FLIP.

    _surface: Stencil | None = None

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Allocate the table, once: ``interpolate`` writes into it at every step."""
        self.table = empty_stencil(setup.state.particles.count, WIDTH**setup.dim, setup.dim)

    @hookimpl
    def particle_reach(self, particles: Particles) -> FloatArray:
        """Points have no extent: the support, one and a half cells, lies in the margin that every window
        has.
        """
        return np.zeros_like(particles.position)

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """φ_ip and ∇φ_ip at x_p.

        Raises
        ------
        OutsideGrid
            A support leaves its window.
        """
        return self._fill(particles.position, particles.first, grid, self.table)

    @hookimpl
    def interpolate_surface(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        """The same basis at surface nodes, without gradients: Σ V ∇φ ≈ ∮ φ n dS needs one basis for both."""
        if self._surface is None:
            self._surface = empty_stencil(len(position), WIDTH**grid.dim, grid.dim, gradient=False)
        return self._fill(position, first, grid, self._surface)

    def _fill(self, position: FloatArray, first: IntArray, grid: Grid, table: Stencil) -> Stencil:
        modified = self.options.grid_end == "modified"
        check_inside(fill_bounded(position, first, grid, table, grid.spacing, modified))
        return table
