"""Detection at shared grid nodes with the plane that separates the bodies' points best, by penalised logistic
regression.

Source: J. A. Nairn, C. C. Hammerquist, G. D. Smith (2020), New material point method contact algorithms for
improved accuracy, large-deformation problems, and proper null-space filtering, CMAME 362, 112859 (not at
hand), as in the public codes of NairnMPM (Nodes/MachineLearning.cpp) and Uintah (SerialMPM.cc). Points with a
weight at the node have the class −1 or 1. Gauss and Newton fit a logistic function of position, with a
penalty of 1e-7 h² on the slope, until 1 − cos of the normal's turn is below 1e-5 (NairnMPM, 15 iterations) or
1e-7 (Uintah, 50). The separation is that of the points' outermost reaches along the normal.

Assumed here. A point reaches as far as the tangent of its ellipse across the normal; in NairnMPM as the
ellipse along it, in Uintah as its corners. Each pair of bodies has planes of its own.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from mpmfw.api import ContactRows, Grid, Particles, SceneError, Setup, Stencil
from mpmfw.contact.nodes import AtNodes
from mpmfw.contact.shared_nodes import GridNodes, NodePairs, SharedNodes, collect_sides, write_row
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.facets import read_point
from mpmfw.kernels.types import Float, Floats, Points
from mpmfw_contact._regression import Clouds, fit_plane, list_points
from mpmfw_contact.impulse import Impulse


@device
def outermost(
    i: int, clouds: Clouds, points: Points, half_edges: Floats, origin: Floats, direction: Floats, sign: Float
) -> Float:
    """Return the reach of node i's points along ``sign`` times the ``direction`` from ``origin`` [m], each
    with the ellipse within its domain, |(F R)ᵀ n|."""
    dim, farthest, k = len(direction), -math.inf, clouds.head[i]
    while k >= 0:
        p, along, square = clouds.point[k], 0.0, 0.0
        for d in range(dim):
            along += sign * direction[d] * (points.position[p, d] - origin[d])
        for edge in range(dim):
            part = 0.0
            for d in range(dim):
                for e in range(dim):
                    part += direction[d] * points.deformation_gradient[p, d, e] * half_edges[p, e, edge]
            square += part * part
        farthest = max(farthest, along + math.sqrt(square))
        k = clouds.after[k]
    return farthest


@kernel
def write_regressed_rows(
    listed: int, shared: SharedNodes, pairs: NodePairs, grid: GridNodes, node: Floats, clouds: Clouds,
    points: Points, half_edges: Floats, penalty: float, tolerance: float, cut_off: float, dt: float,
    rows: Rows, spacing: tuple[float, ...], wide: tuple[float, ...],
) -> int:  # fmt: skip
    """A row for each shared node between whose points there is a plane; their number.

    ``node`` is the nodes' position (n_nodes, dim), ``half_edges`` the points' at the start, columns r_a
    (n_p, dim, dim) [m]. The gap is the distance of the points' domains across the plane, less the cut-off.
    """
    c, n, origin = 0, scratch.vector(spacing), scratch.vector(spacing)
    for f in range(listed):
        i, j, p = shared.first[f], shared.second[f], shared.pair[f]
        read_point(i, node, origin, spacing)
        of_first, count = collect_sides(f, shared, grid)
        if not fit_plane(
            shared.side,
            of_first,
            count,
            clouds,
            points.position,
            origin,
            penalty,
            tolerance,
            n,
            spacing,
            wide,
        ):
            continue
        gap = -cut_off
        gap -= outermost(i, clouds, points, half_edges, origin, n, 1.0)
        gap -= outermost(j, clouds, points, half_edges, origin, n, -1.0)
        for d in range(len(spacing)):
            n[d] = -n[d]
        write_row(c, i, j, p, gap, n, pairs, grid, dt, rows, spacing)
        c += 1
    rows.start[c] = 2 * c
    return c


@kernel
def take_reach(
    rows: Rows, begin: int, count: int, clouds: Clouds, points: Points, half_edges: Floats, node: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Take from the gaps of the rows from ``begin`` on, those of a ``node`` from a rigid surface, how far its
    points' domains reach beyond it."""
    n, origin = scratch.vector(spacing), scratch.vector(spacing)
    for c in range(begin, count):
        i = rows.dof[rows.start[c]]
        read_point(i, node, origin, spacing)
        read_point(c, rows.normal, n, spacing)
        rows.gap[c] -= outermost(i, clouds, points, half_edges, origin, n, -1.0)


class LogisticOptions(BaseModel):
    """Settings of the regression, and where bodies touch."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    slope_penalty: float = Field(
        1e-7, gt=0, description="penalty on the slope of the logistic function, with a cell as unit"
    )
    turn: float = Field(
        1e-5, gt=0, lt=1, description="1 - cos of the turn of a normal that ends the regression"
    )
    cut_off: float = Field(0.0, ge=0, description="separation in cells below which bodies touch")


class Logistic(AtNodes):
    """Normal and gap of shared nodes by logistic regression of the points' bodies against their position."""

    name = "logistic"
    Options = LogisticOptions
    options: LogisticOptions

    def configure(self, needs: frozenset[str], *, forces: bool) -> None:  # noqa: ARG002
        """Refuse laws of forces."""
        if forces:
            raise SceneError(
                "detection 'logistic' is for laws of impulses: its gap jumps as points come and go, and "
                "springs would make energy of that"
            )

    def prepare(self, setup: Setup, owner: str) -> None:
        """Take the domains of the material points, the cut-off, and the bodies of the pairs."""
        self.half_edges, self.wide = setup.half_edges, (1.0,) * (setup.dim + 1)
        self.cut_off = self.options.cut_off * setup.cell_size
        self.clouds = Clouds(**{name: np.zeros(0, dtype=np.int64) for name in Clouds.member_names})
        super().prepare(setup, owner)

    def write(self, listed: int, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> int:
        """Write rows of the shared nodes between whose points there is a plane; return their number."""
        clouds, nodes, entries = self.clouds, self.nodes_of(grid), phi.room
        if (len(clouds.head), len(clouds.after)) != (len(grid.mass), entries):
            sizes = {"head": len(grid.mass), "after": entries, "point": entries}
            clouds.set(**{name: np.zeros(size, dtype=np.int64) for name, size in sizes.items()})
        list_points(phi, nodes.shared, clouds)
        return write_regressed_rows(
            listed, self.shared, self.pairs, nodes, grid.position, clouds, particles, self.half_edges,
            self.options.slope_penalty, self.options.turn, self.cut_off, self.state.dt, rows, grid.spacing,
            self.wide,
        )  # fmt: skip

    def write_rigid(self, near: Any, grid: Grid, particles: Particles, rows: ContactRows) -> None:
        """Append rows of nodes near a rigid body; the gap is that of the points' domains."""
        begin = rows.count
        self.rigid.write(near, grid, rows, grid.position, self.cut_off, self.area_across)
        take_reach(
            rows, begin, rows.count, self.clouds, particles, self.half_edges, grid.position, grid.spacing
        )


class Nairn(Impulse):
    """Momentum exchange at grid nodes whose bodies approach, and overlap across a plane between points."""

    name = "nairn"
    Detection = Logistic
