"""Quadratic B-splines (Steffen, Kirby & Berzins 2008): smooth gradients from points without extent."""

from __future__ import annotations

from mpmfw.api.types import FloatArray, Grid, IntArray, Setup, Stencil, hookimpl
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.lanes import floor
from mpmfw.kernels.products import NODES, WIDTH, fill_factors
from mpmfw.kernels.stencil import fill_tensor_product, fits, read_window
from mpmfw.kernels.types import Float, Floats, Ints, Nodes, Table
from mpmfw_shape._tables import FromProducts, fold_at_start


@device
def quadratic_weights(
    xi: Float, _l: Float, inverse_h: Float, d: int, base: Floats, weight: Floats, slope: Floats
) -> None:
    """The three quadratic B-splines whose support holds ``xi`` [cells] along axis ``d``, of one point or of
    several in lanes."""
    base[d] = floor(xi - 0.5)
    t = xi - base[d]  # 0.5 … 1.5
    weight[d, 0] = 0.5 * ((1.5 - t) * (1.5 - t))
    weight[d, 1] = 0.75 - (t - 1.0) * (t - 1.0)
    weight[d, 2] = 0.5 * ((t - 0.5) * (t - 0.5))
    slope[d, 0] = (t - 1.5) * inverse_h
    slope[d, 1] = -2.0 * (t - 1.0) * inverse_h
    slope[d, 2] = (t - 0.5) * inverse_h


@kernel
def fill_quadratic(
    position: Floats, first: Ints, grid: Nodes, table: Table, spacing: tuple[float, ...],
    at_axis: bool | None = None,
) -> int:  # fmt: skip
    """Quadratic B-splines at points; 3**dim entries each. Return the first point outside its window, or
    −1. ``at_axis``: splines are modified where the grid begins."""
    dim, inverse_h = len(spacing), 1.0 / spacing[0]
    origin, shape, base = scratch.vector(spacing), scratch.integers(spacing), scratch.vector(spacing)
    w, s = scratch.matrix(spacing, NODES), scratch.matrix(spacing, NODES)
    for f in range(len(first) - 1):
        read_window(grid, f, origin, shape, spacing)
        for p in range(first[f], first[f + 1]):
            for d in range(dim):
                quadratic_weights((position[p, d] - origin[d]) * inverse_h, 0.0, inverse_h, d, base, w, s)
            if at_axis is not None and base[0] == -1.0 and grid.window_lower[f, 0] == 0:
                fold_at_start(0, w, WIDTH)
                fold_at_start(0, s, WIDTH)
                base[0] = 0.0
            if not fits(base, WIDTH, shape, spacing):
                return p
            fill_tensor_product(p * WIDTH**dim, WIDTH, base, w, s, shape, grid.offset[f], table, spacing)
    return -1


@kernel
def fill_quadratic_factors(
    position: Floats, first: Ints, grid: Nodes, factors: Table, spacing: tuple[float, ...]
) -> int:
    """As :func:`fill_quadratic`, the factors of the products."""
    return fill_factors(quadratic_weights, position, first, None, grid, factors, spacing)


class BSpline(FromProducts):
    """φ_ip = Π_d B²((x_p − x_i)_d / h): 9 nodes in 2D, 27 in 3D."""

    name = "bspline"
    boundary_degree = 2
    spread = 0.25
    axisymmetric = True
    functions = (fill_quadratic, WIDTH)
    at_axis: bool | None = None  #: True where the grid begins at the axis

    @hookimpl
    def setup(self, setup: Setup) -> None:
        super().setup(setup)
        self.at_axis = True if setup.state.grid.axisymmetric else None

    def fill_rows(self, position: FloatArray, first: IntArray, grid: Grid, table: Stencil) -> int:
        """Fill a ``table``, or the factors that it is made of."""
        if table.factors is not None:
            return int(fill_quadratic_factors(position, first, grid, table.factors, grid.spacing))
        return int(fill_quadratic(position, first, grid, table, grid.spacing, self.at_axis))
