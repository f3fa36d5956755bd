"""Bodies of revolution: x is the radius r, y the axis, and every point a ring of the volume 2π r_p A_p.

Hoop stress pulls a ring towards the axis, and its radial velocity widens it,

    f_i −= Σ_p V_p σ_θθ T_ip e_r,    D_θθ = Σ_i T_ip v_r,    T_ip = φ_ip / r_p.

T is ∫ N_i dA / ∫ r dA wherever φ is a mean over a domain with its centroid at r_p, and N_i / r of a point.
With the gradients of such domains weighted with r, a uniform pressure is in balance (Nairn & Guilkey 2015).

J. A. Nairn, J. E. Guilkey (2015): Axisymmetric form of the generalized interpolation material point method.
International Journal for Numerical Methods in Engineering 101, 127-147."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.kernels import kernel
from mpmfw.kernels.stencil import NodeRange, entries, is_apart, own_entries
from mpmfw.kernels.types import Floats, Nodes, Points, Table
from mpmfw.plugin.checks import described
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import AnyArray, Field
from mpmfw.state.structs import Grid, Particles, State, Stencil

HOOP_STRESS = Field("hoop_stress", ("particle",), "Pa", "Cauchy stress round the axis", output=True)
HOOP_STRETCH = Field("hoop_stretch", ("particle",), "1", "stretch of the ring round the axis", output=True)


@kernel
def add_hoop_force(
    points: Points, stress: Floats, thickness: Floats, table: Table, grid: Nodes,
    own_nodes: NodeRange | None = None,
) -> None:  # fmt: skip
    """f_i −= Σ_p V_p σ_θθ φ_ip / r_p along r, with V_p times ``thickness`` (n,) [m]."""
    for p in range(len(points.volume)):
        if own_nodes is not None and is_apart(table.row, table.nodes, p, own_nodes):
            continue
        hoop = points.volume[p] * thickness[p] * stress[p, 2, 2] / points.position[p, 0]
        first, count = own_entries(table, p, own_nodes)
        for c in range(count):
            k = first + np.uint64(c)
            grid.force[table.nodes[k], 0] -= table.weight[k] * hoop


@kernel
def add_hoop_rate(points: Points, radius: Floats, table: Table, grid: Nodes, gradient: Floats) -> None:
    """Write L of the plane, and D_θθ = Σ_i φ_ip v_r,i / r_p, to ``gradient`` (n, 3, 3) [1/s]."""
    for p in range(len(radius)):
        for d in range(2):
            for e in range(2):
                gradient[p, d, e] = points.velocity_gradient[p, d, e]
        rate = 0.0
        for k in entries(table.row, p):
            rate += table.weight[k] * grid.velocity[table.nodes[k], 0]
        gradient[p, 2, 2] = rate / radius[p]


class SpacePoints(Particles):
    """The points of the plane with tensors in space, θ last; all other arrays are the same."""

    @classmethod
    def of(cls, plane: Particles) -> SpacePoints:
        """Return those of points at the start, without stress."""
        shared = {f.name: getattr(plane, f.name) for f in dataclasses.fields(plane) if f.init}
        tensors = ("deformation_gradient", "velocity_gradient", "stress")
        space = cls(**shared | {name: np.zeros((plane.count, 3, 3)) for name in tensors})
        space.deformation_gradient[:] = np.eye(3)
        return space

    def add_hoop_force(
        self, plane: Particles, phi: Stencil, grid: Grid, over_nodes: Callable[..., None]
    ) -> None:
        """Add the force of the hoop stress on the nodes."""
        over_nodes(plane, add_hoop_force, self.stress, self.thickness, phi, grid)


class Axisymmetry:
    """Keeps the points' tensors in space, and holds the axis."""

    name = "axisymmetry"
    ledger_term = ("external", "axis of symmetry")
    history = ("deformation_gradient", "velocity_gradient", "stress")

    def __init__(self, setup: Setup) -> None:
        self.state = setup.state
        self.plane, self.space = setup.state.particles, setup.state.particles.in_space
        self.materials, self.checked = setup.materials, False
        self.deformation_gradient = self.space.deformation_gradient
        self.velocity_gradient, self.stress = self.space.velocity_gradient, self.space.stress
        self.radius = np.zeros(self.plane.count)
        self.frame, self.axis = -1, np.zeros(0, dtype=np.int64)

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        """Return the effect; refuse a contact whose rows have no radius."""
        detection: Any = getattr(setup.contact, "detection", None)
        if detection is not None and not detection.has_radius:
            raise SceneError(
                f"detection '{detection.name}' has no radius of its rows, round which a force acts; expected "
                "surfaces or nodes where grid.axisymmetric = true",
                key="contact",
            )
        return Acts("x is the radius, y the axis", [cls(setup)])

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return [HOOP_STRESS, HOOP_STRETCH]

    @hookimpl
    def setup(self) -> None:
        """Let threads share the points in space as those of the plane."""
        self.space.threads = self.plane.threads
        self.advect()

    @hookimpl(tryfirst=True)
    def detect(self) -> None:
        """Note the radii that the step's table is of."""
        self.radius[:] = self.plane.position[:, 0]

    @hookimpl(trylast=True)
    def constrain_momentum(self, grid: Grid) -> None:
        """Hold the nodes on the axis, v_r = 0."""
        if self.frame != grid.frame:
            self.frame, on_grid = grid.frame, grid.offset[grid.n_fields - grid.rigid_fields]
            self.axis = np.flatnonzero(grid.on_axis(grid.position[:on_grid]))
        grid.momentum[self.axis, 0] = 0.0

    @hookimpl(trylast=True)
    def advect(self) -> None:
        """Keep surface nodes from rounding to a negative radius."""
        if (surface := self.state.surface) is not None:
            radius = surface.position[: surface.on_grid, 0]
            np.maximum(radius, 0.0, out=radius)

    @hookimpl(tryfirst=True)
    def after_velocity_gradient(self, grid: Grid, phi: Stencil) -> None:
        """L in space, before anything changes it."""
        gradient = self.velocity_gradient
        if self.plane.threads is None:
            add_hoop_rate(self.plane, self.radius, phi, grid, gradient)
        else:
            self.plane.threads.over_points(add_hoop_rate, self.plane, self.radius, phi, grid, gradient)
        if not self.checked:
            self.stress[:, 2, 2] = np.nan

    @hookimpl(trylast=True)
    def update_stress(self) -> None:
        """Copy stress, L and F in the plane; refuse a material without hoop stress."""
        if not self.checked:
            self.checked = True
            for material in self.materials.values():
                if any(np.isnan(self.stress[own, 2, 2]).any() for own in material.slices):
                    raise SceneError(
                        f"{described(material)} gives no stress round the axis; expected one for F and σ of "
                        "(n, 3, 3) where grid.axisymmetric = true, as setup.state.grid.tensor_spacing says"
                    )
        self.plane.stress[...] = self.stress[:, :2, :2]
        self.plane.deformation_gradient[...] = self.deformation_gradient[:, :2, :2]
        self.plane.velocity_gradient[...] = self.velocity_gradient[:, :2, :2]

    @hookimpl
    def diagnostics(self, state: State, points: bool) -> dict[str, AnyArray]:  # noqa: ARG002
        if not points:
            return {}
        stretch = self.deformation_gradient[:, 2, 2]
        return {"hoop_stress": self.stress[:, 2, 2].copy(), "hoop_stretch": stretch.copy()}
