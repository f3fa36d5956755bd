"""CPDI2: four-cornered particle domains that tile a body without gaps (Sadeghirad, Brannon & Guilkey
2013)."""

from __future__ import annotations

import numpy as np

from mpmfw.api import (
    Field,
    FloatArray,
    Grid,
    Particles,
    SceneError,
    Setup,
    Stencil,
    check_inside,
    empty_stencil,
    hookimpl,
)
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.stencil import fill_corner
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw_shape._bilinear_surface import LinearSurface

CORNERS = Field(
    "corners",
    ("particle", "corner", "axis"),
    "m",
    "corners of the domain, counter-clockwise",
    "particles",
    "f8",
    True,
)


@device
def area_of(corners: Floats) -> Float:
    """Area of a quadrilateral with counter-clockwise corners (4, 2) [m^2]."""
    return 0.5 * (
        (corners[2, 0] - corners[0, 0]) * (corners[3, 1] - corners[1, 1])
        - (corners[3, 0] - corners[1, 0]) * (corners[2, 1] - corners[0, 1])
    )


@device
def corner_share(corners: Floats, c: int, area: Float) -> Float:
    """1/V ∫ M_c dV of the corner's bilinear function M_c; 1/4 for a parallelogram.

    The Jacobian of the map from the unit square is linear along its edges; the integral of M_c over the
    domain is (4 a_c + 2 a_{c−1} + 2 a_{c+1} + a_{c+2}) / 36, a_c being the Jacobian at corner c (area of its
    parallelogram).
    """
    total = 0.0
    for other in range(4):
        after, before = (other + 1) % 4, (other + 3) % 4
        jacobian = (corners[after, 0] - corners[other, 0]) * (corners[before, 1] - corners[other, 1]) - (
            corners[before, 0] - corners[other, 0]
        ) * (corners[after, 1] - corners[other, 1])
        distance = (other - c + 4) % 4
        total += jacobian * (4.0 if distance == 0 else 1.0 if distance == 2 else 2.0)
    return total / (36.0 * area)


@kernel
def fill_cpdi2(
    corners: Floats,
    first: Ints,
    lower: Floats,
    window_lower: Ints,
    window_shape: Ints,
    offset: Ints,
    nodes: Indices,
    weight: Floats,
    gradient: Floats,
    spacing: tuple[float, ...],
) -> int:
    """φ_i = Σ_c w_c N_i(x_c) and ∇φ_i = Σ_c g_c N_i(x_c); 16 entries each.

    w_c = 1/V ∫ M_c dV and g_c = 1/V ∮ M_c n dS = ½ (y_{c+1} − y_{c−1}, x_{c−1} − x_{c+1}) / V.
    Return the first point whose corner is outside its window, or −1.
    """
    slope = scratch.vector(spacing)
    for f in range(len(first) - 1):
        for p in range(first[f], first[f + 1]):
            own = corners[p]
            area = area_of(own)
            for c in range(4):
                after, before = (c + 1) % 4, (c + 3) % 4
                slope[0] = 0.5 * (own[after, 1] - own[before, 1]) / area
                slope[1] = 0.5 * (own[before, 0] - own[after, 0]) / area
                if not fill_corner(
                    (p * 4 + c) * 4,
                    own[c],
                    corner_share(own, c, area),
                    slope,
                    lower,
                    window_lower[f],
                    window_shape[f],
                    offset[f],
                    nodes,
                    weight,
                    gradient,
                    spacing,
                ):
                    return p
    return -1


@kernel
def move_corners(
    nodes: Indices,
    weight: Floats,
    node_velocity: Floats,
    corners: Floats,
    position: Floats,
    dt: float,
    spacing: tuple[float, ...],
) -> None:
    """x_c += Δt Σ N_i(x_c) v_i, and x_p = Σ_c w_c x_c with the weights of the moved domain.

    The table holds w_c N_i: dividing by Σ_i of the corner's entries gives N_i back. Points are set to Σ S_i
    x_i, since otherwise the affine transfer, which turns about x_p, lets linear momentum drift.
    """
    for p in range(len(position)):
        for c in range(4):
            k = (p * 4 + c) * 4
            share = weight[k] + weight[k + 1] + weight[k + 2] + weight[k + 3]
            for d in range(len(spacing)):
                motion = 0.0
                for entry in range(k, k + 4):
                    motion += weight[entry] * node_velocity[nodes[entry], d]
                corners[p, c, d] += dt * motion / share
        area = area_of(corners[p])
        for d in range(len(spacing)):
            position[p, d] = 0.0
            for c in range(4):
                position[p, d] += corner_share(corners[p], c, area) * corners[p, c, d]


class Cpdi2(LinearSurface):
    """φ_ip from the four corners, which move with the grid velocity: 16 entries; 2D."""

    name = "cpdi2"
    dimensions = (2,)

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The corners."""
        return [CORNERS]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Take the corners from the layout; x_p becomes Σ w_c x_c."""
        if setup.corners is None:
            raise SceneError("shape 'cpdi2' needs four-cornered domains; a body's layout has none")
        particles = setup.state.particles
        self.corners = setup.allocate(self.name, CORNERS, corner=4)
        self.corners[:] = setup.corners
        self.table = empty_stencil(particles.count, 16, setup.dim)

    @hookimpl
    def particle_reach(self, particles: Particles) -> FloatArray:
        """Largest distance of a corner from the point, along every axis."""
        reach: FloatArray = np.abs(self.corners - particles.position[:, None, :]).max(axis=1)
        return reach

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """S_ip and ∇S_ip of the quadrilaterals."""
        table = self.table
        check_inside(
            fill_cpdi2(
                self.corners,
                particles.first,
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

    @hookimpl
    def update_particle_domains(self, particles: Particles, grid: Grid, dt: float) -> None:
        """Corners ride on the grid velocity; the points follow them."""
        move_corners(
            self.table.nodes,
            self.table.weight,
            grid.velocity,
            self.corners,
            particles.position,
            dt,
            grid.spacing,
        )

    @hookimpl
    def diagnostics(self) -> dict[str, FloatArray]:
        """The corners, for output."""
        return {"corners": self.corners}
