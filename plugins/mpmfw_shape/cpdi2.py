"""CPDI2: four-cornered particle domains that tile a body without gaps (Sadeghirad, Brannon & Guilkey
2013)."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.api.types import Field, FloatArray, Grid, Particles, SceneError, Setup, hookimpl
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.stencil import CORNERS as EACH_CORNER
from mpmfw.kernels.stencil import FULL, OUTSIDE, fill_domain, read_window
from mpmfw.kernels.types import Float, Floats, Ints, Nodes, Table
from mpmfw_shape._tables import BEYOND_AXIS, PackedRows
from mpmfw_shape.cpdi import is_degenerate, make_rectangle

CORNERS = Field(
    "corners", ("particle", "corner", "axis"), "m", "corners of the domain, counter-clockwise", output=True
)


@device
def area_of(corners: Floats) -> Float:
    """Area of a quadrilateral with counter-clockwise corners (4, 2) [m^2]."""
    return 0.5 * (
        (corners[2, 0] - corners[0, 0]) * (corners[3, 1] - corners[1, 1])
        - (corners[3, 0] - corners[1, 0]) * (corners[2, 1] - corners[0, 1])
    )


@device
def corner_jacobian(corners: Floats, c: int) -> Float:
    """Jacobian at corner ``c`` of the map from the unit square [m^2]: the area of its parallelogram."""
    after, before = (c + 1) % 4, (c + 3) % 4
    return (corners[after, 0] - corners[c, 0]) * (corners[before, 1] - corners[c, 1]) - (
        corners[before, 0] - corners[c, 0]
    ) * (corners[after, 1] - corners[c, 1])


@device
def corner_share(corners: Floats, c: int, area: Float) -> Float:
    """1/V ∫ M_c dV of the corner's bilinear function M_c; 1/4 for a parallelogram.

    The Jacobian of the map from the unit square is linear along its edges; the integral of M_c over the
    domain is (4 a_c + 2 a_{c−1} + 2 a_{c+1} + a_{c+2}) / 36, a_c being the Jacobian at corner c.
    """
    total = 0.0
    for other in range(4):
        distance = (other - c + 4) % 4
        total += corner_jacobian(corners, other) * (4.0 if distance == 0 else 1.0 if distance == 2 else 2.0)
    return total / (36.0 * area)


@device
def replace_degenerate(corners: Floats, centre: Floats, start: Floats, spacing: tuple[float, ...]) -> None:
    """Replace a degenerate quadrilateral by a rectangle round ``centre`` (:func:`.cpdi.make_rectangle`).

    It is degenerate if the parallelogram of its midlines r_1, r_2 is, or if the Jacobian at a corner is below
    a quarter of its mean. ``corners`` (4, 2) are written [m]; domains then overlap or have gaps.
    """
    r = scratch.matrix(spacing, spacing)
    for d in range(len(spacing)):
        r[d, 0] = 0.25 * (corners[1, d] + corners[2, d] - corners[0, d] - corners[3, d])
        r[d, 1] = 0.25 * (corners[2, d] + corners[3, d] - corners[0, d] - corners[1, d])
    degenerate = is_degenerate(r, start, spacing)
    for c in range(4):
        degenerate = degenerate or not corner_jacobian(corners, c) > 0.25 * area_of(corners)
    if degenerate:
        make_rectangle(r, start, spacing)
        for c in range(4):
            first, second = 1.0 if c == 1 or c == 2 else -1.0, 1.0 if c > 1 else -1.0
            for d in range(len(spacing)):
                corners[c, d] = centre[d] + first * r[d, 0] + second * r[d, 1]


@kernel
def fill_cpdi2(
    first: Ints, corners: Floats, grid: Nodes, k: int, end: int, table: Table, spacing: tuple[float, ...],
    radius: Floats | None = None,
) -> int:  # fmt: skip
    """φ_i = Σ_c w_c N_i(x_c) and ∇φ_i = Σ_c g_c N_i(x_c); up to 16 entries each.

    w_c = 1/V ∫ M_c dV and g_c = 1/V ∮ M_c n dS = ½ (y_{c+1} − y_{c−1}, x_{c−1} − x_{c+1}) / V. Weighted with
    the ``radius`` r (n,) [m], g_c is ∫ r ∇M_c / ∫ r = (∮ r M_c n dS − e_r ∫ M_c dV) / (V r).
    Return the first point whose corner is outside its window, −1, or −2 if the table is too short.
    """
    inverse_h = 1.0 / spacing[0]
    origin, shape = scratch.vector(spacing), scratch.integers(spacing)
    corner, slope = scratch.matrix(EACH_CORNER, spacing), scratch.matrix(EACH_CORNER, spacing)
    share = scratch.vector(EACH_CORNER)
    for f in range(len(first) - 1):
        read_window(grid, f, origin, shape, spacing)
        for p in range(first[f], first[f + 1]):
            own = corners[p]
            area = area_of(own)
            for c in range(4):
                after, before = (c + 1) % 4, (c + 3) % 4
                slope[c, 0] = 0.5 * (own[after, 1] - own[before, 1]) / area
                slope[c, 1] = 0.5 * (own[before, 0] - own[after, 0]) / area
                share[c] = corner_share(own, c, area)
                if radius is not None:
                    low = 2.0 * own[c, 0] + own[before, 0]
                    high = 2.0 * own[c, 0] + own[after, 0]
                    scale = 1.0 / (6.0 * area * radius[p])
                    slope[c, 0] = scale * (
                        high * (own[after, 1] - own[c, 1]) + low * (own[c, 1] - own[before, 1])
                    )
                    slope[c, 0] -= share[c] / radius[p]
                    slope[c, 1] = scale * (
                        high * (own[c, 0] - own[after, 0]) + low * (own[before, 0] - own[c, 0])
                    )
                for d in range(len(spacing)):
                    corner[c, d] = (own[c, d] - origin[d]) * inverse_h
            k = fill_domain(k, end, corner, share, slope, shape, grid.offset[f], table, spacing)
            if k < 0:
                return p if k == OUTSIDE else FULL
            table.row[p + 1] = k
    return -1


@kernel
def move_corners(
    first: Ints, grid: Nodes, corners: Floats, position: Floats, half_edges: Floats, dt: float,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """x_c += Δt Σ N_i(x_c) v_i; degenerate domains are replaced. x_p = Σ_c w_c x_c of the moved domain.

    Otherwise the affine transfer, which turns about x_p, lets linear momentum drift."""
    inverse_h, velocity = 1.0 / spacing[0], grid.velocity
    origin, shape = scratch.vector(spacing), scratch.integers(spacing)
    for f in range(len(first) - 1):
        read_window(grid, f, origin, shape, spacing)
        for p in range(first[f], first[f + 1]):
            for c in range(4):
                x = (corners[p, c, 0] - origin[0]) * inverse_h
                y = (corners[p, c, 1] - origin[1]) * inverse_h
                i, j = math.floor(x), math.floor(y)
                a, b = x - i, y - j
                node = grid.offset[f] + int(i) * shape[1] + int(j)
                next_row = node + shape[1]
                for d in range(len(spacing)):
                    below = (1.0 - b) * velocity[node, d] + b * velocity[node + 1, d]
                    above = (1.0 - b) * velocity[next_row, d] + b * velocity[next_row + 1, d]
                    corners[p, c, d] += dt * ((1.0 - a) * below + a * above)
            area = area_of(corners[p])
            for d in range(len(spacing)):
                position[p, d] = 0.0
                for c in range(4):
                    position[p, d] += corner_share(corners[p], c, area) * corners[p, c, d]
            replace_degenerate(corners[p], position[p], half_edges[p], spacing)


class Cpdi2(PackedRows):
    """φ_ip from the four corners, which move with the grid velocity: up to 16 entries; 2D."""

    name = "cpdi2"
    divisible = False  # corners take velocities of the grid
    fill = fill_cpdi2
    axisymmetric = True
    dimensions = (2,)

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return [CORNERS]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Take the corners from the layout; x_p becomes Σ w_c x_c."""
        if setup.corners is None:
            raise SceneError(
                "'cpdi2' needs four-cornered domains; a body's layout has none", key="shape.method"
            )
        super().setup(setup)
        self.corners = setup.allocate(self.name, CORNERS, corner=4)
        self.corners[:] = setup.corners
        if setup.state.grid.axisymmetric:
            radius = setup.state.particles.position[:, :1]
            towards_axis = self.corners[..., 0] - radius
            beyond = np.maximum(-towards_axis.min(axis=1, keepdims=True) / (BEYOND_AXIS * radius), 1.0)
            self.corners[..., 0] = radius + towards_axis / beyond
        self.half_edges = setup.half_edges  # at the start; degenerate domains are compared with them

    @hookimpl
    def particle_reach(self, particles: Particles) -> FloatArray:
        """Largest distance of a corner from the point, along every axis."""
        reach: FloatArray = np.abs(self.corners - particles.position[:, None, :]).max(axis=1)
        return reach

    def domains(self, particles: Particles) -> tuple[FloatArray, ...]:  # noqa: ARG002
        return (self.corners,)

    @hookimpl
    def update_particle_domains(self, particles: Particles, grid: Grid, dt: float) -> None:
        """Corners ride on the grid velocity; the points follow them."""
        edges, position = self.half_edges, particles.position
        move_corners(particles.first, grid, self.corners, position, edges, dt, grid.spacing)

    @hookimpl
    def diagnostics(self) -> dict[str, FloatArray]:
        return {"corners": self.corners}
