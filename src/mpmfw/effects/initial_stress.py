"""Initial stress of soil in its own weight: vertical and horizontal, by depth.

The points have it without deformation, F = 1; the material's history is set to match. With the weight of what
lies above a point, a layer between smooth walls is in balance from the first step on."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.errors import SceneError
from mpmfw.plugin.checks import described
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body

#: Departure from the stress asked for, over its largest, that a yield surface makes.
YIELDED = 1e-6


class InitialStress:
    """The stress of every body that names one."""

    name = "initial_stress"

    def __init__(self, bodies: list[Body]) -> None:
        self.bodies = bodies

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        bodies = [body for body in setup.state.soft_bodies if setup.scene.bodies[body.name].initial_stress]
        return Acts(", ".join(body.name for body in bodies), [cls(bodies)])

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Give the points their stress, by their materials; refuse one that cannot take it, or yields."""
        p = setup.state.particles
        wanted = {body.name: _stress(setup, body) for body in self.bodies}
        for body in self.bodies:
            material: Any = setup.material_of(body)
            if not material.set_stress(body.particles, wanted[body.name]):
                raise SceneError(
                    f"{described(material)} cannot begin with a stress at F = 1; expected a soil, such as "
                    "mohr_coulomb or drucker_prager",
                    key=f"bodies.{body.name}.initial_stress",
                )
            material.update_stress(particles=p.in_space)
        if p.in_space is not p:
            p.stress[...] = p.in_space.stress[:, :2, :2]
        for body in self.bodies:
            stress, found = wanted[body.name], p.in_space.stress[body.particles]
            axes = found.shape[1]
            excess = np.abs(found - stress[:, :axes, None] * np.eye(axes)).max()
            if excess > YIELDED * np.abs(stress).max():
                raise SceneError(
                    f"is beyond the strength of the material, by {excess:.3g} Pa; expected horizontal stress "
                    "nearer to the vertical one",
                    key=f"bodies.{body.name}.initial_stress",
                )


def _stress(setup: Setup, body: Body) -> FloatArray:
    """Return principal stresses along x, y and z, or θ, of a body's points (n, 3) [Pa]."""
    model = setup.scene.bodies[body.name]
    table: Any = model.initial_stress
    gravity = setup.scene.gravity
    pull = np.array([0.0, -1.0, 0.0][: setup.dim] if gravity is None else gravity.at(0.0))
    up = int(np.abs(pull).argmax())
    if np.count_nonzero(pull) != 1 or (gravity is None and table.k0 is not None):
        raise SceneError(
            "has no weight to follow; expected gravity along one of the axes",
            key=f"bodies.{body.name}.initial_stress",
        )
    sense = -np.sign(pull[up])
    top = max(sense * body.lower[up], sense * body.upper[up]) if table.top is None else sense * table.top
    depth = np.maximum(top - sense * setup.state.particles.position[body.particles, up], 0.0)
    if table.table is not None:
        rows = np.array(table.table).T
        vertical, horizontal = (np.interp(depth, rows[0], each) for each in rows[1:])
    else:
        density = body.density if table.density is None else table.density
        vertical = density * abs(pull[up]) * depth
        horizontal = table.k0 * vertical
    stress = np.repeat(-horizontal[:, None], 3, axis=1)
    stress[:, up] = -vertical
    return stress
