"""Surface basis shared by linear, GIMP and CPDI: the grid's plain (bi-, tri-)linear functions at the surface
nodes."""

from __future__ import annotations

from mpmfw.api import (
    FloatArray,
    Grid,
    IntArray,
    ShapeFunction,
    Stencil,
    check_inside,
    empty_stencil,
    hookimpl,
)
from mpmfw.kernels.stencil import fill_linear


class LinearSurface(ShapeFunction):
    """Mix-in of ``interpolate_surface`` with linear functions, the trace of Σ V ∇S = ∮ N n dS for CPDI."""

    _surface: Stencil | None = None

    @hookimpl
    def interpolate_surface(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        """N_i(x_s) of the linear basis."""
        if self._surface is None:
            self._surface = empty_stencil(len(position), 2**grid.dim, grid.dim, gradient=False)
        table = self._surface
        check_inside(
            fill_linear(
                position,
                first,
                grid.lower,
                grid.window_lower,
                grid.window_shape,
                grid.offset,
                table.nodes,
                table.weight,
                table.gradient,
                grid.spacing,
            )
        )
        return table
