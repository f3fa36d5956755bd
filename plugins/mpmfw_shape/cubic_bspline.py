"""Cubic B-splines (Steffen, Kirby & Berzins 2008): gradients that are smooth as well, from points without
extent.

M. Steffen, R. M. Kirby, M. Berzins (2008): Analysis and reduction of quadrature errors in the material point
method (MPM). International Journal for Numerical Methods in Engineering 76, 922-948.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.stencil import fill_tensor_product, fits, read_window
from mpmfw.kernels.types import Float, Floats, Ints, Nodes, Table
from mpmfw_shape._tables import AtPoints, fold_at_start

#: Splines, hence nodes, along each axis whose support holds a point.
WIDTH = 4


@device
def cubic_weights(
    xi: Float, cell: Float, inverse_h: Float, d: int, base: Floats, weight: Floats, slope: Floats
) -> None:
    """The four cubic B-splines whose support holds ``xi`` [cells] along axis ``d``, and their slopes [1/m].

    With t = ξ − ``cell`` they are (1 − t)³/6, (3t³ − 6t² + 4)/6, (−3t³ + 3t² + 3t + 1)/6 and t³/6, for the
    nodes ``base[d]`` = ``cell`` − 1 and the three after it.
    """
    t = xi - cell
    base[d] = cell - 1.0
    weight[d, 0] = (1.0 - t) ** 3 / 6.0
    weight[d, 1] = ((3.0 * t - 6.0) * t * t + 4.0) / 6.0
    weight[d, 2] = (((-3.0 * t + 3.0) * t + 3.0) * t + 1.0) / 6.0
    weight[d, 3] = t**3 / 6.0
    slope[d, 0] = -0.5 * (1.0 - t) ** 2 * inverse_h
    slope[d, 1] = (1.5 * t - 2.0) * t * inverse_h
    slope[d, 2] = ((-1.5 * t + 1.0) * t + 0.5) * inverse_h
    slope[d, 3] = 0.5 * t * t * inverse_h


@device
def fold_at_end(d: int, values: Floats) -> None:
    """As :func:`mpmfw_shape._tables.fold_at_start`, for the node after the grid's last."""
    ghost = values[d, 3]
    values[d, 3] = values[d, 2] + 2.0 * ghost
    values[d, 2] = values[d, 1] - ghost
    values[d, 1] = values[d, 0]
    values[d, 0] = 0.0


@kernel
def fill_cubic(
    position: Floats, first: Ints, grid: Nodes, table: Table, spacing: tuple[float, ...], modified: bool
) -> int:
    """Cubic B-splines at points; 4**dim entries each. Return the first point outside its window, or −1.

    Where a window ends with the grid, the splines are ``modified``, or the point is reported; the core lays
    other windows anew. A gradient of length 0 is not written.
    """
    dim, inverse_h = len(spacing), 1.0 / spacing[0]
    origin, shape, base = scratch.vector(spacing), scratch.integers(spacing), scratch.vector(spacing)
    w = scratch.matrix(spacing, (0.0, 0.0, 0.0, 0.0))
    s = scratch.matrix(spacing, (0.0, 0.0, 0.0, 0.0))
    for f in range(len(first) - 1):
        read_window(grid, f, origin, shape, spacing)
        for p in range(first[f], first[f + 1]):
            for d in range(dim):
                xi = (position[p, d] - origin[d]) * inverse_h
                at_start = modified and grid.window_lower[f, d] == 0
                at_end = modified and grid.window_lower[f, d] + shape[d] == grid.nodes[d]
                cell = np.floor(xi)
                if at_end and xi == shape[d] - 1:  # on the last node: the end of the last cell
                    cell -= 1
                cubic_weights(xi, cell, inverse_h, d, base, w, s)
                if at_start and base[d] == -1.0:
                    fold_at_start(d, w, WIDTH)
                    fold_at_start(d, s, WIDTH)
                    base[d] = 0.0
                elif at_end and base[d] + WIDTH == shape[d] + 1:
                    fold_at_end(d, w)
                    fold_at_end(d, s)
                    base[d] -= 1.0
            if not fits(base, WIDTH, shape, spacing):
                return p
            fill_tensor_product(p * WIDTH**dim, WIDTH, base, w, s, shape, grid.offset[f], table, spacing)
    return -1


class CubicBSplineOptions(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    grid_end: Literal["modified", "refuse"] = Field(
        "modified",
        description=(
            "in the last cell of the grid a node of the support is missing; modified: it is read by linear "
            "extrapolation (Steffen, Kirby & Berzins 2008), refuse: the run stops, as with other functions"
        ),
    )


class CubicBSpline(AtPoints):
    """φ_ip = Π_d B³((x_p − x_i)_d / h): 16 nodes in 2D, 64 in 3D."""

    name = "cubic_bspline"
    Options = CubicBSplineOptions
    options: CubicBSplineOptions
    boundary_degree = 3
    axisymmetric = True
    functions = (fill_cubic, WIDTH)

    @property
    def choices(self) -> tuple[bool]:
        """True where splines are modified at the grid's end."""
        return (self.options.grid_end == "modified",)
